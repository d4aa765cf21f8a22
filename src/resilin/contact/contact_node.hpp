#pragma once

#include <initializer_list>
#include <vector>

#include "resilin/contact/carried_points.hpp"
#include "resilin/mesh/depth.hpp"

namespace resilin {

/// A node of a surface that may touch something.
struct ContactNode {
  Index node;
  double stiffness;  ///< kappa A: barrier stiffness [Pa] times its share of the rest area [m^2]
};

/// Points of surfaces that may touch something: nodes, and such as nodes carry.
struct ContactPoints {
  CarriedPoints places;
  std::vector<double> stiffness;  ///< stiffness of each, likewise
  std::vector<Index> numbers;  ///< numbers of each: its node, or its vertex of the surface that nodes carry

  ContactPoints() = default;
  ContactPoints(const std::vector<ContactNode>& nodes) {
    for (const ContactNode& node : nodes) add(node);
  }
  ContactPoints(std::initializer_list<ContactNode> nodes) : ContactPoints(std::vector(nodes)) {}
  Index size() const { return places.num_points(); }
  void add(const ContactNode& node) {
    places.add_node(node.node);
    stiffness.push_back(node.stiffness);
    numbers.push_back(node.node);
  }
};

/// The nodes of a surface, ascending, with their shares of the rest area.
///
/// Each facet is shared in proportion to the integral of N_a^2 (diagonal scaling; Hinton, Rock & Zienkiewicz
/// 1976), which is positive for every node; the integral of N_a itself vanishes at the corners of a quadratic
/// triangle, which nothing would keep out then. For flat linear facets and lines the two are the same.
/// Of facets that look in different directions a node has as much as one of them sees of all: on a sharp
/// edge, the share of one face, since what it rests on meets but one.
/// In axisymmetric solids linear lines are shared by the integral of N_a 2 pi r, as a pressure is; lines on
/// the axis have no area.
/// @param stiffness  kappa [Pa]
std::vector<ContactNode> contact_nodes(int dim, const CellBlock& facets, const VectorX& rest_positions,
                                       double stiffness, const Depth& depth = {});

}  // namespace resilin
