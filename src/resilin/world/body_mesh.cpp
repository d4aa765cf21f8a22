#include "resilin/world/body_mesh.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/material/plane_stress.hpp"
#include "resilin/mesh/check.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/world/cell_material.hpp"

namespace resilin {
namespace {

/// Poisson's ratio above which volume locking costs per cents; read off a tangent, whose rounding is not
/// meant.
constexpr double locking_ratio = 0.45 + 1e-9;

bool has_simplices(CellKind kind) { return num_corners(kind) == dimension(kind) + 1; }

std::string mesh_place(const BodyDescription& body) {
  return body.mesh_name.empty() ? body.place + ".mesh" : body.mesh_name;
}

const ElementInfo& without_pressure(const ElementInfo& element) {
  return *find_element(element.dim, is_simplex(element.shape), element.degree, false);
}

/// Element that does not lock on these cells: mixed where the law allows it, else of degree 2 where
/// there is such an element. Null where there is none.
const ElementInfo* without_locking(const ElementCase& c) {
  const int dim = dimension(c.cells);
  const bool simplices = has_simplices(c.cells);
  const int degree = simplices ? 2 : 1;
  if (c.law.has_volume_energy) return find_element(dim, simplices, degree, true);
  return simplices ? find_element(dim, simplices, degree, false) : nullptr;
}

/// The element that the user named, which must fit the cells.
const ElementInfo& named_element(const BodyDescription& body, int dim, const ElementCase& c) {
  const std::string place = body.place + ".element";
  const ElementInfo& element = require_element(body.element, dim, place);
  if (is_simplex(element.shape) != has_simplices(c.cells)) {
    std::vector<std::string> fitting;
    for (const ElementInfo* other : elements())
      if (other->dim == dim && is_simplex(other->shape) == has_simplices(c.cells))
        fitting.emplace_back(other->name);
    throw InputError(place, join(fitting) + " or auto for " + std::string(name(c.cells)),
                     "\"" + body.element + "\"");
  }
  if (element.has_mean_volume && is_plane_stress(c.law))
    throw InputError(place, "a displacement element, since plane stress has no volumetric locking",
                     "\"" + body.element + "\"", "use " + std::string(without_pressure(element).name));
  if (element.has_mean_volume && !c.law.has_volume_energy) {
    throw InputError(
        place,
        "a displacement element: the volumetric energy of " + std::string(c.law.name) + " is not separate",
        "\"" + body.element + "\"",
        "use " + std::string(without_pressure(element).name) + " or another law (docs/laws.md)");
  }
  return element;
}

/// Turns inverted cells around and refuses those that cannot be computed with.
void orient(Mesh& mesh, const BodyDescription& body, int dim, std::vector<std::string>& warnings) {
  const std::string place = mesh_place(body);
  const CellBlock& block = *mesh.find_solid(dim);
  const CellSigns signs = cell_signs(mesh, block);
  for (const auto* bad : {&signs.not_finite, &signs.flat}) {
    if (!bad->empty()) {
      throw InputError(place + ": cell " + std::to_string(bad->front()), "a cell with a volume",
                       bad == &signs.flat ? "volume zero" : "a coordinate that is not finite");
    }
  }
  if (!signs.folded.empty()) {
    throw InputError(place + ": cell " + std::to_string(signs.folded.front().cell),
                     fold_text(mesh, block, signs.folded.front(), {}));
  }
  if (signs.inverted.empty()) return;
  warnings.push_back(place + ": " + std::to_string(signs.inverted.size()) +
                     " inverted cells were reoriented, the first is cell " +
                     std::to_string(signs.inverted.front()));
  reorient(mesh, block.kind);
}

/// Throws OutOfMemory where a body of so many cells does not fit into the world. Besides the geometry of its
/// cells it needs about so much for each pair of their nodes, measured on boxes with linear and quadratic
/// simplices: cells and nodes, pattern, places in the matrix, masses, and what finds them.
void foresee_body(const ElementInfo& element, const QuadratureRule& rule, Index num_cells) {
  const double bytes_per_pair = element.dim == 3 ? 24 : 46;
  const double n = element.num_nodes, dim = element.dim;
  const double of_points = static_cast<double>(rule.points.size()) * (dim * dim + 1) * sizeof(double);
  const double bytes = num_cells * (n * (n + 1) / 2 * bytes_per_pair + of_points);
  if (!fits(bytes))
    foresee_memory(
        bytes, "a body of " + std::to_string(num_cells) + " cells of " + std::string(element.name),
        what_would_fit(num_cells, bytes, "cells") + " before any is solved: take fewer, or raise the limit");
}

}  // namespace

Placement::Placement(const BodyDescription& body)
    : scale_(body.scale),
      rotation_(rotation_matrix(body.rotate)),
      center_(body.rotate ? body.rotate->center : Vector3(Vector3::Zero())),
      translation_(body.translate) {}

ChosenElement choose_element(const ElementCase& c) {
  const int dim = dimension(c.cells);
  const bool simplices = has_simplices(c.cells);
  const auto plain = [&](int degree, const std::string& reason) -> ChosenElement {
    return {find_element(dim, simplices, degree, false), reason};
  };
  const bool is_nearly_incompressible = c.poissons_ratio > locking_ratio;
  const std::string above =
      "nu = " + format_short(c.poissons_ratio) + " is above " + format_short(locking_ratio);
  if (is_nearly_incompressible && c.law.has_volume_energy)
    return {without_locking(c), above + ", where displacement elements lock"};
  if (!simplices) return plain(1, "the mesh has " + std::string(name(c.cells)));
  if (is_nearly_incompressible)
    return plain(2, above + ", and the volumetric energy of " + std::string(c.law.name) + " is not separate");
  if (is_second_order(c.cells)) return plain(2, "the mesh is of second order");
  return plain(2, "quadratic elements cost least for the same error, and linear ones lock where they bend");
}

std::string locking_text(const ElementInfo& element, const ElementCase& c) {
  if (element.has_mean_volume || element.degree > 1 || !(c.poissons_ratio > locking_ratio)) return "";
  const ElementInfo* cure = without_locking(c);
  return std::string(element.name) + " is too stiff for nu = " + format_short(c.poissons_ratio) +
         " (volume locking)" + (cure == nullptr ? "" : "; use element = \"" + std::string(cure->name) + "\"");
}

const CellBlock& solid_cells(const BodyDescription& body, int dim) {
  std::vector<std::string> found, solid;
  for (const CellBlock& block : body.mesh.blocks) {
    if (block.num_cells() == 0) continue;
    found.emplace_back(name(block.kind));
    if (dimension(block.kind) == dim) solid.push_back(found.back());
  }
  const CellBlock* cells = body.mesh.find_solid(dim);
  if (cells == nullptr) {
    throw InputError(mesh_place(body), std::string(dim == 3 ? "no tetrahedra" : "no triangles") + " (found " +
                                           (found.empty() ? "no cells" : join(found)) + ")");
  }
  if (solid.size() > 1) {
    throw InputError(mesh_place(body), "cells of one kind in a body", join(solid, " and "),
                     "split the others or make them a body of their own");
  }
  return *cells;
}

BodyMesh make_body_mesh(const BodyDescription& body, int dim, const ElementCase& c,
                        std::vector<std::string>& warnings) {
  if (has_axisymmetric_name(body.element)) {
    BodyDescription plane = body;
    plane.element = plane_name(body.element);
    BodyMesh ring = make_body_mesh(plane, dim, c, warnings);
    ring.element = &axisymmetric_element(*ring.element);
    return ring;
  }
  BodyMesh made;
  if (body.element == "auto") {
    const ChosenElement chosen = choose_element(c);
    made.element = chosen.element;
    made.reason = chosen.reason;
  } else {
    made.element = &named_element(body, dim, c);
  }
  if (const std::string text = locking_text(*made.element, c); !text.empty())
    warnings.push_back(body.place + ".element: " + text);
  const QuadratureRule& rule = made.element->quadrature(body.quadrature, body.place + ".quadrature");
  foresee_body(*made.element, rule, solid_cells(body, dim).num_cells());
  made.mesh = body.mesh;
  if (made.element->degree == 1) to_first_order(made.mesh);
  orient(made.mesh, body, dim, warnings);
  if (made.element->degree == 2) {
    SecondOrderMesh finer = second_order(made.mesh);
    made.mesh = std::move(finer.mesh);
    made.ends = std::move(finer.ends);
  }
  return made;
}

SharedIndices cells_in_world(const BodyMesh& mesh, Index first_node,
                             const std::shared_ptr<const Description>& shared, std::size_t body) {
  std::vector<Index> nodes = mesh.cells().nodes;
  for (Index& node : nodes) node += first_node;
  if (shared == nullptr) return nodes;
  const std::vector<Index>& given = solid_cells(shared->bodies[body], mesh.element->dim).nodes;
  return nodes == given ? SharedIndices(shared, given) : SharedIndices(std::move(nodes));
}

}  // namespace resilin
