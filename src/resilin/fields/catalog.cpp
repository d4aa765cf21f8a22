#include "resilin/fields/catalog.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/contact_gap.hpp"
#include "resilin/fields/contact_traction.hpp"
#include "resilin/fields/quantities.hpp"
#include "resilin/fields/tensors.hpp"

namespace resilin {
namespace {

using Tensor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using TensorView = Eigen::Map<const Tensor>;

// ---- samples at quadrature points

template <class Function>
std::vector<double> tensors_of(const std::vector<Matrix<3>>& points, const Function& function) {
  std::vector<double> values(9 * points.size());
  for (std::size_t p = 0; p < points.size(); ++p) Eigen::Map<Tensor>(values.data() + 9 * p) = function(p);
  return values;
}

std::vector<double> sample_cauchy_stress(const DomainState& at) {
  const std::vector<Matrix<3>> sigma = at.cauchy_stresses();
  return tensors_of(sigma, [&](std::size_t p) -> const Matrix<3>& { return sigma[p]; });
}

/// From sigma, so that whatever an element does to the pressure is in it: P = J sigma F^-T. A law of small
/// strain has but one stress.
std::vector<double> sample_first_stress(const DomainState& at) {
  if (at.elastic().law().kind == LawKind::small_strain) return sample_cauchy_stress(at);
  const std::vector<Matrix<3>> sigma = at.cauchy_stresses(),
                               F = at.elastic().deformation_gradients(at.positions());
  return tensors_of(sigma, [&](std::size_t p) -> Matrix<3> {
    return F[p].determinant() * sigma[p] * F[p].inverse().transpose();
  });
}

/// S = F^-1 P = J F^-1 sigma F^-T
std::vector<double> sample_second_stress(const DomainState& at) {
  if (at.elastic().law().kind == LawKind::small_strain) return sample_cauchy_stress(at);
  const std::vector<Matrix<3>> sigma = at.cauchy_stresses(),
                               F = at.elastic().deformation_gradients(at.positions());
  return tensors_of(sigma, [&](std::size_t p) -> Matrix<3> {
    const Matrix<3> F_inverse = F[p].inverse();
    return F[p].determinant() * F_inverse * sigma[p] * F_inverse.transpose();
  });
}

std::vector<double> sample_green_strain(const DomainState& at) {
  const std::vector<Matrix<3>> F = at.elastic().deformation_gradients(at.positions());
  return tensors_of(F, [&](std::size_t p) { return green_strain(F[p] - Matrix<3>::Identity()); });
}

std::vector<double> sample_logarithmic_strain(const DomainState& at) {
  const std::vector<Matrix<3>> F = at.elastic().deformation_gradients(at.positions());
  return tensors_of(F, [&](std::size_t p) { return logarithmic_strain(F[p] - Matrix<3>::Identity()); });
}

std::vector<double> sample_volume_ratio(const DomainState& at) {
  return at.elastic().volume_ratios(at.positions());
}

std::vector<double> sample_energy_density(const DomainState& at) { return at.energy_densities(); }

// ---- read off a mean stress

void derive_von_mises(const double* stress, double* value) { *value = von_mises(TensorView(stress)); }

void derive_pressure(const double* stress, double* value) { *value = -TensorView(stress).trace() / 3; }

void derive_principal_stress(const double* stress, double* values) {
  std::ranges::copy(principal(TensorView(stress)).values, values);
}

template <int number>
void derive_principal_direction(const double* stress, double* values) {
  Eigen::Map<Vector3>(values, 3) = principal(TensorView(stress)).directions.col(number - 1);
}

using enum FieldInfo::Kind;

constexpr CellQuantity of_cells[] = {
    {"cauchy_stress", "Cauchy stress",
     "Cauchy stress: true stress, in the axes of the deformed configuration", "Pa", tensor,
     sample_cauchy_stress, 9, nullptr},
    {"von_mises", "von Mises stress", "von Mises stress of the Cauchy stress", "Pa", scalar,
     sample_cauchy_stress, 9, derive_von_mises},
    {"pressure", "pressure", "minus a third of the trace of the Cauchy stress", "Pa", scalar,
     sample_cauchy_stress, 9, derive_pressure},
    {"principal_stress", "principal stress", "principal Cauchy stresses, the largest first", "Pa",
     principal_values, sample_cauchy_stress, 9, derive_principal_stress},
    {"principal_direction_1", "principal direction 1", "direction of the largest principal stress", "",
     vector, sample_cauchy_stress, 9, derive_principal_direction<1>},
    {"principal_direction_2", "principal direction 2", "direction of the middle principal stress", "", vector,
     sample_cauchy_stress, 9, derive_principal_direction<2>},
    {"principal_direction_3", "principal direction 3", "direction of the smallest principal stress", "",
     vector, sample_cauchy_stress, 9, derive_principal_direction<3>},
    {"first_piola_kirchhoff_stress", "first Piola-Kirchhoff stress",
     "first Piola-Kirchhoff stress P = dPsi/dF: force per reference area", "Pa", tensor, sample_first_stress,
     9, nullptr, false},
    {"second_piola_kirchhoff_stress", "second Piola-Kirchhoff stress",
     "second Piola-Kirchhoff stress S = F^-1 P", "Pa", tensor, sample_second_stress, 9, nullptr},
    {"green_strain", "Green strain", "Green-Lagrange strain (F^T F - I) / 2", "", tensor, sample_green_strain,
     9, nullptr},
    {"logarithmic_strain", "logarithmic strain", "logarithmic (Hencky) strain ln(F F^T) / 2", "", tensor,
     sample_logarithmic_strain, 9, nullptr},
    {"volume_ratio", "volume ratio", "deformed over reference volume, J = det F", "", scalar,
     sample_volume_ratio, 1, nullptr},
    {"energy_density", "energy density", "strain energy per reference volume", "J/m^3", scalar,
     sample_energy_density, 1, nullptr},
};

constexpr NodeQuantity of_nodes[] = {
    {"displacement", "displacement", "from the reference configuration", "m", vector,
     [](const World& world, const State& state) -> VectorX { return state.positions - world.rest_positions; },
     true},
    {"velocity", "velocity", "zero in statics", "m/s", vector,
     [](const World&, const State& state) -> VectorX { return state.velocities; }, true},
    {"contact_traction", "contact traction",
     "nominal traction: contact force of bodies and colliders per reference area; zero elsewhere", "Pa",
     vector, contact_traction},
    {"contact_pressure", "contact pressure",
     "true pressure: normal contact force per deformed area, positive in compression", "Pa", scalar,
     contact_pressure},
    {"contact_gap", "contact gap",
     "distance to the nearest body or collider; the activation distance where nothing is nearer", "m", scalar,
     contact_gap},
};

/// Names of a quantity of the cells begin with where it is. Directions have no mean: either sense is meant.
std::vector<FieldInfo> all_fields() {
  using enum FieldInfo::Source;
  std::vector<FieldInfo> all;
  const auto add = [&all](const auto& q, std::string_view prefix, FieldInfo::Source source,
                          bool is_symmetric) {
    FieldInfo field{.name = std::string(prefix) + std::string(q.name),
                    .label = std::string(q.label) + std::string(label_suffix(source)),
                    .text = std::string(q.text),
                    .unit = std::string(q.unit),
                    .kind = q.kind,
                    .source = source,
                    .is_symmetric = is_symmetric};
    if (source != averages || !field.is_direction()) all.push_back(std::move(field));
  };
  for (const NodeQuantity& q : of_nodes) add(q, "", vertices, true);
  for (const auto& [prefix, source] : {std::pair(std::string_view(), cells),
                                       std::pair(averaged_prefix, averages), std::pair(nodal_prefix, fit)})
    for (const CellQuantity& q : of_cells) add(q, prefix, source, q.is_symmetric);
  return all;
}

}  // namespace

std::string_view label_suffix(FieldInfo::Source source) {
  switch (source) {
    case FieldInfo::Source::vertices:
      return "";
    case FieldInfo::Source::cells:
      return ", by cell";
    case FieldInfo::Source::averages:
      return ", averaged";
    case FieldInfo::Source::fit:
      return ", smooth";
  }
  return "";
}

std::span<const CellQuantity> cell_quantities() { return of_cells; }
std::span<const NodeQuantity> node_quantities() { return of_nodes; }

const std::vector<FieldInfo>& fields() {
  static const std::vector<FieldInfo> all = all_fields();
  return all;
}

std::vector<std::string> field_names() {
  std::vector<std::string> names;
  for (const FieldInfo& field : fields()) names.push_back(field.name);
  return names;
}

const FieldInfo& require_field(std::string_view name, const std::string& place) {
  for (const FieldInfo& field : fields())
    if (field.name == name) return field;
  refuse_word(place, name, field_names());
}

}  // namespace resilin
