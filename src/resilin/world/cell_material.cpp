#include "resilin/world/cell_material.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/material_axes.hpp"
#include "resilin/material/plane_stress.hpp"
#include "resilin/material/rest_tangents.hpp"

namespace resilin {

Eigen::Matrix3d rotation_matrix(const std::optional<Rotation>& rotation) {
  if (!rotation) return Eigen::Matrix3d::Identity();
  const double angle = rotation->degrees * std::numbers::pi / 180;
  return Eigen::AngleAxisd(angle, rotation->axis.normalized()).toRotationMatrix();
}

std::vector<double> constants_of_cells(const LawInfo& law, const MaterialDescription& material,
                                       Index num_cells) {
  if (material.cell_constants.empty()) return resolve_constants(law, material.constants, material.place);
  for (const auto& [name, values] : material.cell_constants) {
    if (values.size() == static_cast<std::size_t>(num_cells)) continue;
    throw InputError(material.place + "." + name,
                     "a value for each of " + std::to_string(num_cells) + " cells",
                     std::to_string(values.size()) + " values");
  }
  std::map<std::string, Column> columns;
  for (const auto& [name, value] : material.constants) columns[name] = {&value, 0};
  for (const auto& [name, values] : material.cell_constants) columns[name] = {values.data(), 1};
  return resolve_constants(law, columns, static_cast<std::size_t>(num_cells), material.place,
                           [](std::size_t cell) { return ", cell " + std::to_string(cell); });
}

FibreDirections fibres_of_cells(const LawInfo& law, const MaterialDescription& material,
                                const std::optional<Rotation>& rotation, Index num_cells) {
  const std::string place = material.place + ".fibres";
  const auto& families = material.fibres;
  const auto max_families = static_cast<std::size_t>(law.max_fibres);
  if (max_families == 0 && !families.empty())
    throw InputError(place, "nothing: " + std::string(law.name) + " has no fibres",
                     std::to_string(families.size()) + " families",
                     "leave them out or choose holzapfel_gasser_ogden");
  if (max_families > 0 && (families.empty() || families.size() > max_families))
    throw InputError(place, "1 to " + std::to_string(max_families) + " families of directions",
                     families.empty() ? "none" : std::to_string(families.size()),
                     "for example fibres = [[1, 0, 0]]");
  const Eigen::Matrix3d turn = rotation_matrix(rotation);
  const auto count = static_cast<std::size_t>(num_cells);
  // A part of a sum may have fewer families than it could: the others are empty.
  const auto is_absent = [&law](const std::vector<Vector3>& directions) {
    return is_sum(law) && directions.empty();
  };
  const bool is_uniform = std::ranges::all_of(
      families, [&](const auto& directions) { return directions.size() == 1 || is_absent(directions); });
  FibreDirections fibres{{}, families.size()};
  for (std::size_t cell = 0; cell < (is_uniform ? 1 : count); ++cell) {
    for (const auto& directions : families) {
      if (is_absent(directions)) {
        fibres.directions.emplace_back(Vector3::Zero());
        continue;
      }
      if (directions.size() != 1 && directions.size() != count)
        throw InputError(place, "one direction, or one for each of " + std::to_string(count) + " cells",
                         std::to_string(directions.size()));
      const Vector3& direction = directions[directions.size() == 1 ? 0 : cell];
      const double length = direction.norm();
      if (!(length > 0 && std::isfinite(length)))
        throw InputError(place + ", cell " + std::to_string(cell), "a direction other than zero",
                         "length " + format_number(length));
      if (is_plane_stress(law) && std::abs((turn * direction)[2]) > 1e-12 * length)
        throw InputError(place + ", cell " + std::to_string(cell),
                         "a direction in the plane, in plane stress", "one that leaves it",
                         "leave its third component zero or take plane strain");
      fibres.directions.push_back(turn * direction / length);
    }
    if (has_parallel_axes(law, std::span(fibres.directions).last(families.size())))
      throw InputError(place + ", cell " + std::to_string(cell), axes_expected, "parallel ones", axes_cure);
  }
  return fibres;
}

double largest_poissons_ratio(const LawInfo& law, const std::vector<double>& constants) {
  if (is_plane_stress(law)) return 0;  // the thickness gives way to any pressure: nothing locks
  double largest = -1;
  for_each_rest_tangent(law, constants, [&largest](std::size_t, const double* A) {
    const double lambda = A[4], mu = A[9 + 1];  // dP_00/dF_11, dP_01/dF_01
    largest = std::max(largest, Hooke{mu, lambda}.poissons_ratio());
  });
  return largest;
}

}  // namespace resilin
