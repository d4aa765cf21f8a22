#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "resilin/core/shared_indices.hpp"
#include "resilin/element/element.hpp"
#include "resilin/material/law.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// Placement of a body's mesh in the world: scaled, then rotated, then translated.
class Placement {
 public:
  explicit Placement(const BodyDescription& body);
  Vector3 operator()(const Vector3& X) const {
    return center_ + rotation_ * (scale_ * X - center_) + translation_;
  }

 private:
  double scale_;
  Matrix<3> rotation_;
  Vector3 center_, translation_;
};

/// Input of the choice of an element.
struct ElementCase {
  CellKind cells;  ///< cells of the mesh
  const LawInfo& law;
  double poissons_ratio;  ///< Poisson's ratio of the small-strain solid; the largest of all cells
};

/// An element and why it was chosen.
struct ChosenElement {
  const ElementInfo* element;
  std::string reason;  ///< "nu = 0.49 is above 0.45, where displacement elements lock"
};

/// Element of "auto", the same for statics, dynamics and live scenes: a mixed element (constant pressure per
/// cell) for nearly incompressible solids, else P2; Q1 on quadrilaterals and hexahedra.
ChosenElement choose_element(const ElementCase& c);

/// Why this element is a bad choice, with the cure; empty when it is not.
std::string locking_text(const ElementInfo& element, const ElementCase& c);

/// A body's mesh as its element needs it.
struct BodyMesh {
  const ElementInfo* element;
  std::string reason;  ///< why the element was chosen; empty when the user chose it
  /// Cells with all nodes of the element and positive volumes; the vertices of the given mesh come first.
  Mesh mesh;
  std::vector<std::array<Index, 2>> ends;  ///< ends of the edge in whose middle each further node stands

  const CellBlock& cells() const { return *mesh.find_solid(element->dim); }
};

/// The cells that a body is made of. Throws InputError when there are none, or several kinds.
const CellBlock& solid_cells(const BodyDescription& body, int dim);

/// Throws InputError for an element that does not fit the cells, flat cells and cells that are turned inside
/// out somewhere; inverted ones are turned around with a warning.
BodyMesh make_body_mesh(const BodyDescription& body, int dim, const ElementCase& c,
                        std::vector<std::string>& warnings);

/// The nodes of a body's cells in the world: the list of its mesh in the description, where that is the same.
/// @param shared  the description that the world keeps; may be null
SharedIndices cells_in_world(const BodyMesh& mesh, Index first_node,
                             const std::shared_ptr<const Description>& shared, std::size_t body);

}  // namespace resilin
