#pragma once

#include <string>
#include <vector>

#include "resilin/view/shown_surface.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Something of a scene that a page draws at vertices: what is held, pulled or watched.
struct ShownMark {
  enum class Kind { support, load, probe };
  Kind kind = Kind::support;
  std::string name;
  std::vector<Index> vertices;      ///< vertices of the shown surface
  std::vector<Vector3> directions;  ///< directions of a load: its force at each vertex over the greatest one
  /// How strong a load is over its strongest, at times or load factors between which it is straight; empty:
  /// it does not change.
  struct Course {
    bool is_over_load = false;  ///< else over time [s]
    std::vector<double> at, factors;
  };
  Course course{};
  double greatest = 0;  ///< greatest force [N]; at load factor 1, or when it is greatest in time
};

/// The supports, loads (but for gravity) and probes of a world. Of many vertices some hundred are taken
/// evenly.
std::vector<ShownMark> shown_marks(const World& world, const ShownSurface& surface);

/// At most `most` of the numbers, evenly.
std::vector<Index> thinned(const std::vector<Index>& all, std::size_t most);

/// The vertices of something that is held at which it is drawn.
std::vector<Index> shown_support(const std::vector<Index>& vertices);

}  // namespace resilin
