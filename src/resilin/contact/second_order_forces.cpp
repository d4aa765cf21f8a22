#include "resilin/contact/second_order_forces.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "resilin/collision/collision_time.hpp"
#include "resilin/contact/pair_barrier.hpp"

namespace resilin {
namespace {

/// Share of its distance that a pair keeps at the end at least: more than the largest step leaves.
constexpr double least_share = 0.3;

/// The terms whose ways are cut short, and when.
struct CutTerm {
  const ContactTerm* term;
  double time;
};

std::vector<CutTerm> cut_terms(PairKind kind, const TermSet& set, std::span<const MovingPoint> ways) {
  std::vector<const ContactTerm*> terms;
  std::vector<Candidate> pairs;
  std::vector<Index> first, second;
  for (const ContactTerm& term : set.terms) {
    if (term.kind != kind || !(term.stiffness > 0)) continue;
    const auto number = static_cast<Index>(terms.size());
    terms.push_back(&term);
    pairs.push_back({number, number});
    const std::span<const Index> vertices = term.used_vertices();
    first.insert(first.end(), vertices.begin(), vertices.begin() + num_first(kind));
    second.insert(second.end(), vertices.begin() + num_first(kind), vertices.end());
  }
  std::vector<double> times(terms.size());
  collision_times({kind, pairs, first, second}, ways, times);
  std::vector<CutTerm> cut;
  for (std::size_t i = 0; i < terms.size(); ++i)
    if (times[i] < 1) cut.push_back({terms[i], times[i]});
  return cut;
}

template <int dim>
using Corners = std::array<Vector<dim>, most_pair_vertices>;

/// w . v along n: how fast the parts move apart.
template <int dim>
double change_of_distance(const PairDistance<dim>& pair, std::span<const Vector<dim>> ways) {
  Vector<dim> gap = Vector<dim>::Zero();
  for (std::size_t i = 0; i < ways.size(); ++i) gap += pair.weights[i] * ways[i];
  return gap.dot(pair.normal);
}

/// Adds k e grad d of one term.
template <int dim>
void add_force(const CutTerm& cut, const VectorX& places, const VectorX& displacements, VectorX& forces) {
  const ContactTerm& term = *cut.term;
  const std::span<const Index> vertices = term.used_vertices();
  Corners<dim> corners{}, ways{}, there{};
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    corners[i] = places.segment<dim>(Eigen::Index{vertices[i]} * dim);
    ways[i] = displacements.segment<dim>(Eigen::Index{vertices[i]} * dim);
    there[i] = corners[i] + cut.time * ways[i];
  }
  const auto used = [&](const Corners<dim>& all) {
    return std::span<const Vector<dim>>(all).first(vertices.size());
  };
  const ClampedLogBarrier barrier = term.barrier();
  const PairBarrier<dim> pair(barrier, term.kind, used(corners), term.stiffness, term.mollifier());
  if (!pair.is_active()) return;
  const double distance = pair.distance().distance;
  const PairDistance<dim> meeting = pair_distance<dim>(term.kind, used(there));
  const double wanted =
      std::max(distance + change_of_distance<dim>(pair.distance(), used(ways)), least_share * distance);
  const double end = meeting.distance + (1 - cut.time) * change_of_distance<dim>(meeting, used(ways));
  if (!(end < wanted)) return;
  const double curvature = pair.normal_force() * barrier.curvature(distance) / -barrier.slope(distance);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    forces.segment<dim>(Eigen::Index{vertices[i]} * dim) +=
        curvature * (wanted - end) * meeting.weights[i] * meeting.normal;
}

template <int dim>
VectorX forces_in(const TermSet& set, const VectorX& places, const VectorX& displacements) {
  const auto numbers = [](const VectorX& values) {
    return std::span(values.data(), static_cast<std::size_t>(values.size()));
  };
  const std::vector<MovingPoint> ways = moving_points(dim, numbers(places), numbers(displacements));
  VectorX forces;
  const auto add_kind = [&](PairKind kind) {
    for (const CutTerm& cut : cut_terms(kind, set, ways)) {
      if (forces.size() == 0) forces.setZero(places.size());
      add_force<dim>(cut, places, displacements, forces);
    }
  };
  if constexpr (dim == 2) {
    add_kind(PairKind::point_edge);
  } else {
    add_kind(PairKind::point_triangle);
    add_kind(PairKind::edge_edge);
  }
  return forces;
}

}  // namespace

VectorX second_order_forces(const TermSet& set, const VectorX& places, const VectorX& displacements) {
  return set.surface.parts.dim == 3 ? forces_in<3>(set, places, displacements)
                                    : forces_in<2>(set, places, displacements);
}

}  // namespace resilin
