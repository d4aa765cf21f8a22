#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

struct Body;
class World;

/// Force and moment of one side of a body on the other through a plane cut.
struct SectionForce {
  std::string name;
  Vector3 force = Vector3::Zero();   ///< force of the side beyond the plane on the side below it [N]
  Vector3 moment = Vector3::Zero();  ///< about `center` [N m]
  Vector3 center = Vector3::Zero();  ///< center of the cut's area, deformed [m]
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
  /// The body that it cuts.
  const Body& body(const World& world) const;
  SectionForce measure(const VectorX& x) const;

  /// Slopes of a number by what a force depends on. What is empty is not asked for.
  struct Slopes {
    VectorX positions{}, rest_positions{};  ///< positions and rest positions of the world
    std::vector<VectorX> constants{};       ///< constants of each domain, as the parameter of its energy
  };
  /// Adds those of by . force, as long as no cell changes sides.
  void add_slopes(const Vector3& by, const VectorX& x, Slopes& slopes) const;
  /// Likewise those of by . moment.
  void add_moment_slopes(const Vector3& by, const VectorX& x, Slopes& slopes) const;

 private:
  struct Node {
    Index node;     ///< node of the world
    double share;   ///< s
    double volume;  ///< volume of the cells at the node, at rest [m^3]
  };
  /// The cells at the cut on one side that are of one domain.
  struct Cells {
    bool is_lower = false;
    std::size_t domain = 0;
    bool is_uniform = false;   ///< one set of constants for the whole domain
    std::vector<Index> cells;  ///< cells of the domain
    std::vector<Index> nodes;  ///< nodes of these, in the world
    std::shared_ptr<const ElasticEnergy> energy;
  };
  void add_cells(const Body& body, const std::vector<Index>& cells, bool is_lower,
                 const VectorX& rest_positions);
  void add_volume_slopes(const Cells& side, const std::vector<double>& by_node, VectorX& slopes) const;
  /// The corners of a side between a lower and an upper cell.
  struct Facet {
    CellKind kind;
    std::array<Index, 4> corners;
  };
  Vector3 center(const VectorX& x) const;
  void add_center_slopes(const Vector3& by, const VectorX& x, VectorX& slopes) const;
  std::vector<Vector3> node_forces(const VectorX& x) const;
  /// Slopes of the sum over the cut's nodes of by[i] . force_i, by[i] held.
  void add_force_slopes(const std::vector<Vector3>& by, const VectorX& x, Slopes& slopes) const;

  std::string name_;
  int dim_;
  std::vector<Cells> cells_;
  std::vector<Node> nodes_;
  std::vector<Facet> facets_;
};

}  // namespace resilin
