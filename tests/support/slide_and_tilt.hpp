#pragma once

#include <Eigen/Geometry>
#include <array>
#include <utility>
#include <vector>

#include "resilin/contact/surface_contact.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin::testing {

/// Two tetrahedra, an edge of one across an edge of the other at a distance. The way slides the upper edge
/// along itself and tilts it about its middle: to first order the distance stays as it is, at the end it
/// would be below zero.
struct SlideAndTilt {
  std::vector<ContactBody> bodies;
  VectorX positions = VectorX::Zero(24);
  VectorX way = VectorX::Zero(24);

  SlideAndTilt(const Eigen::Quaterniond& turn, double distance, double tilt) {
    const std::array<Vector3, 8> places = {
        Vector3(-1, 0, 0), {1, 0, 0},        {0, -0.5, -1},           {0, 0.5, -1},
        {0, -1, distance}, {0, 1, distance}, {-0.5, 0, 1 + distance}, {0.5, 0, 1 + distance}};
    for (Index v = 0; v < 8; ++v) {
      const Vector3& x = places[static_cast<std::size_t>(v)];
      positions.segment<3>(3 * v) = turn * x;
      if (v >= 4) way.segment<3>(3 * v) = turn * Vector3(0, 0.5, tilt * x.y());
    }
    for (const Index first : {0, 4}) {
      CellBlock facets = boundary(*make_box({1, 1, 1}, {1, 1, 1}).find_solid(3)).facets;
      facets.nodes.clear();
      for (const std::array<Index, 3>& face : {std::array<Index, 3>{0, 1, 2}, std::array<Index, 3>{0, 3, 1},
                                               std::array<Index, 3>{1, 3, 2}, std::array<Index, 3>{2, 3, 0}})
        for (const Index corner : face) facets.nodes.push_back(first + corner);
      bodies.push_back({std::move(facets), 1e5});
    }
  }
};

}  // namespace resilin::testing
