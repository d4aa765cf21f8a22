#include "resilin/world/linear_problem.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// The most negative real eigenvalue, or 0: the least root of p(s) = s^3 - a s^2 + b s - c by Newton's method
/// from the side where it never passes a root on its way.
double most_negative_eigenvalue(const Matrix<3>& H) {
  const double size = H.norm(), a = H.trace(), b = 0.5 * (a * a - (H * H).trace()), c = H.determinant();
  const auto p = [=](double s) { return ((s - a) * s + b) * s - c; };
  const auto slope = [=](double s) { return (3 * s - 2 * a) * s + b; };
  const double discriminant = a * a - 3 * b, hump = (a - std::sqrt(std::max(discriminant, 0.0))) / 3;
  const double negligible = 1e-14 * size * size * size;
  if (std::abs(p(hump)) <= negligible) return std::min(hump, 0.0);  // a double root
  const double inwards = p(hump) < 0 ? -1 : 1;                      // one real root is left, beyond the hump
  double s = -inwards * size;
  for (int i = 0; i < 100; ++i) {
    const double next = s - p(s) / slope(s);
    if (!((next - s) * inwards > 0)) break;  // round-off has the last word
    s = next;
  }
  return std::min(s, 0.0);
}

}  // namespace

bool is_linear(const World& world) {
  const auto is_quadratic = [](const auto& term) { return term->properties().is_quadratic; };
  return !world.is_dynamic && std::ranges::all_of(world.terms, is_quadratic);
}

std::optional<Inversion> first_inversion(const World& world, const VectorX& positions, double load) {
  const auto turns = [](const Support& support) { return support.rotate.has_value(); };
  if (!(load > 0) || world.path_time > 0 || std::ranges::any_of(world.supports, turns)) return std::nullopt;
  std::optional<Inversion> first;
  double least = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Domains& elastic = world.bodies[b].domains;
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
  if (world.share.is_whole()) return first;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double load_of_all = world.share.smallest(first ? first->load : infinity);
  if (!(load_of_all < infinity)) return std::nullopt;
  const bool is_here = first && first->load == load_of_all;
  const double body = world.share.smallest(is_here ? first->body : infinity);
  const bool is_cell_here = is_here && first->body == body;
  const double cell = world.share.smallest(
      is_cell_here ? world.cell_number(static_cast<std::size_t>(first->body), first->cell) : infinity);
  return Inversion{.load = load_of_all, .body = static_cast<int>(body), .cell = static_cast<Index>(cell)};
}

std::string describe(const World& world, const Inversion& inversion) {
  return "cell " + std::to_string(inversion.cell) + " of \"" +
         world.bodies[static_cast<std::size_t>(inversion.body)].name + "\" is inverted beyond load factor " +
         format_short(inversion.load);
}

}  // namespace resilin
