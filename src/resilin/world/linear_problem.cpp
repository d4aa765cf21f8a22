#include "resilin/world/linear_problem.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// The most negative real eigenvalue, or 0.
double most_negative_eigenvalue(const Matrix<3>& H) {
  double least = 0;
  for (const std::complex<double>& value : H.eigenvalues()) {
    // A double eigenvalue splits into a pair of complex ones by the square root of round-off.
    if (std::abs(value.imag()) <= 1e-7 * std::abs(value)) least = std::min(least, value.real());
  }
  return least;
}

}  // namespace

bool is_linear(const World& world) {
  const auto is_quadratic = [](const auto& term) { return term->properties().is_quadratic; };
  return !world.is_dynamic && std::ranges::all_of(world.terms, is_quadratic);
}

std::optional<Inversion> first_inversion(const World& world, const VectorX& positions, double load) {
  const auto turns = [](const Support& support) { return support.rotate.has_value(); };
  if (!(load > 0) || std::ranges::any_of(world.supports, turns)) return std::nullopt;
  std::optional<Inversion> first;
  double least = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const ElasticEnergy& elastic = *world.bodies[b].elastic;
    const std::vector<Matrix<3>> F = elastic.deformation_gradients(positions);
    for (std::size_t k = 0; k < F.size(); ++k) {
      const Matrix<3> H = F[k] - Matrix<3>::Identity();
      if (!(H.norm() > -least)) continue;  // no eigenvalue is larger than the norm
      const double eigenvalue = most_negative_eigenvalue(H);
      if (!(eigenvalue < least)) continue;
      least = eigenvalue;
      first = Inversion{.load = -load / eigenvalue,
                        .body = static_cast<int>(b),
                        .cell = static_cast<Index>(k) / elastic.num_points()};
    }
  }
  return first;
}

std::string describe(const World& world, const Inversion& inversion) {
  return "cell " + std::to_string(inversion.cell) + " of \"" +
         world.bodies[static_cast<std::size_t>(inversion.body)].name +
         "\" is turned inside out beyond load factor " + format_short(inversion.load);
}

}  // namespace resilin
