#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

struct Body;

/// What one side of a body exerts on the other through a plane cut.
struct SectionForce {
  std::string name;
  Vector3 force = Vector3::Zero();   ///< of the side beyond the plane on the side below it [N]
  Vector3 moment = Vector3::Zero();  ///< about `center` [N m]
  Vector3 center = Vector3::Zero();  ///< of the cut's area, deformed [m]
};

/// A cut through a body between the cells whose centroids lie below a plane of the rest shape and the others.
///
/// At a node of the cut, let g be the nodal force that the lower cells need, dE_lower/dx, and h that of the
/// upper cells. The upper side exerts g, but for the part of the load on the node that belongs to the lower
/// cells: a share s of g + h, s being their share of the volume of the cells at the node. So
///
///   force = sum over the cut's nodes of (1 - s) g - s h,
///
/// which balances the lower side exactly: its weight, the loads and reactions on its nodes (and inertia),
/// with what acts on the nodes of the cut shared in the same way.
class Section {
 public:
  /// @param rest_positions  of the world, dim per node [m]
  /// @throws InputError     when the plane leaves all cells on one side
  Section(const SectionDescription& description, const Body& body, int dim, const VectorX& rest_positions);

  const std::string& name() const { return name_; }
  SectionForce measure(const VectorX& x) const;

 private:
  struct Node {
    Index node;    ///< of the world
    double share;  ///< s
  };
  /// The corners of a side between a lower and an upper cell.
  struct Facet {
    CellKind kind;
    std::array<Index, 4> corners;
  };
  Vector3 center(const VectorX& x) const;

  std::string name_;
  int dim_;
  std::shared_ptr<const ElasticEnergy> lower_, upper_;  ///< the cells at the cut
  std::vector<Node> nodes_;
  std::vector<Facet> facets_;
};

}  // namespace resilin
