#include "resilin/contact/contact_search.hpp"

#include <algorithm>
#include <span>

#include "resilin/mesh/box_tree.hpp"

namespace resilin {
namespace {

/// Share of the distance that vertices may leave the boxes of a search by.
constexpr double share_of_slack = 0.5;

std::span<const double> numbers(const VectorX& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

}  // namespace

double ContactSearch::slack() const { return share_of_slack * distance_; }

const SurfaceCandidates& ContactSearch::none() {
  static const SurfaceCandidates nothing;
  return nothing;
}

bool ContactSearch::covers(const VectorX& places) const {
  const int dim = parts().dim;
  if (ways_.empty()) return parts().num_vertices() == 0;
  const double* y = places.data();
  const double margin = slack();
  for (const MovingPoint& way : ways_)
    for (int k = 0; k < dim; ++k, ++y) {
      const double end = way.x[k] + way.p[k];
      if (!(*y >= std::min(way.x[k], end) - margin && *y <= std::max(way.x[k], end) + margin)) return false;
    }
  return true;
}

/// Whether boxes around the ways of two bodies that meet are near each other.
bool ContactSearch::may_meet() const {
  const BodyMeetings& meetings = trees_->meetings();
  std::vector<Box> boxes(static_cast<std::size_t>(meetings.num_bodies()));
  for (std::size_t v = 0; v < ways_.size(); ++v) {
    const Vector3 from(ways_[v].x[0], ways_[v].x[1], ways_[v].x[2]);
    Box& box = boxes[static_cast<std::size_t>(parts().bodies[v])];
    box.add(from);
    box.add(from + Vector3(ways_[v].p[0], ways_[v].p[1], ways_[v].p[2]));
  }
  const Vector3 margin = Vector3::Constant(distance_ + 2 * slack());
  for (Index a = 0; a < meetings.num_bodies(); ++a) {
    if (meetings.meet(a, a)) return true;
    const Box& box = boxes[static_cast<std::size_t>(a)];
    const Box wide{box.min - margin, box.max + margin};
    for (Index b = 0; b < a; ++b)
      if (meetings.meet(a, b) && wide.meets(boxes[static_cast<std::size_t>(b)])) return true;
  }
  return false;
}

bool ContactSearch::cover(const VectorX& from, const VectorX& to) {
  if (covers(from) && (&from == &to || covers(to))) return false;
  ways_ = moving_points(parts().dim, numbers(from), numbers(to - from));
  has_any_ = may_meet();
  if (!has_any_) return true;
  if (!own_trees_) own_trees_ = *trees_;
  own_trees_->find(ways_, distance_ + 2 * slack());
  return true;
}

}  // namespace resilin
