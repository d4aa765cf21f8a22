#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "resilin/view/shown_surface.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// A joint, spring or cable as a page draws it: lines between points, and dots at some of them.
struct ShownConnector {
  /// A weighted sum of vertices of the shown surface; without vertices a place on the ground.
  struct Point {
    std::vector<Index> vertices{};
    std::vector<double> weights{};    ///< as many; their sum is 1
    Vector3 place = Vector3::Zero();  ///< [m]
  };
  std::string kind;  ///< as in the scene: "hinge", "spring", "cable"
  std::string name;
  std::vector<Point> points{};
  std::vector<std::array<std::size_t, 2>> lines{};  ///< numbers of points
  std::vector<std::size_t> dots{};                  ///< numbers of points
};

/// Joints, springs and cables of a world. Points of rigid bodies move with them exactly. Points of deformable
/// bodies whose vertices the surface does not have are left out.
std::vector<ShownConnector> shown_connectors(const World& world, const ShownSurface& surface);

}  // namespace resilin
