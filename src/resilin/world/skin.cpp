#include "resilin/world/skin.hpp"

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/world.hpp"

namespace resilin {
namespace {

constexpr double worth_a_warning = 0.05;  // distance worth a warning, relative to the body's extent
constexpr double wrong = 1;

double extent_of(const Body& body, const VectorX& X, int dim) {
  Box box;
  for (const Index node : body.cells) {
    Vector3 place = Vector3::Zero();
    place.head(dim) = X.segment(Eigen::Index{node} * dim, dim);
    box.add(place);
  }
  return (box.max - box.min).maxCoeff();
}

void check_distance(const SkinDescription& skin, const Body& body, const Embedding& embedding, double extent,
                    std::vector<std::string>& warnings) {
  const Embedding::Outside& outside = embedding.outside();
  if (!(outside.distance > worth_a_warning * extent)) return;
  const std::string fact = "vertex " + std::to_string(outside.point + 1) + " of " + skin.surface_name +
                           " stands " + format_short(outside.distance) +
                           " m off the nearest cell of a body of " + format_short(extent) + " m";
  if (outside.distance > wrong * extent) {
    throw InputError(skin.place,
                     fact +
                         "; the skin is scaled, rotated and translated with the mesh: give both in "
                         "one unit and at one place");
  }
  warnings.push_back(
      skin.place + ": " + fact + ", and " + std::to_string(outside.count) + " of " +
      std::to_string(embedding.num_points()) +
      " vertices are outside the cells, where the embedding is less accurate: let the cells of " + body.name +
      " enclose it");
}

}  // namespace

std::shared_ptr<const Skin> make_skin(const BodyDescription& description, const Body& body,
                                      const VectorX& rest_positions, int dim,
                                      std::vector<std::string>& warnings) {
  if (!description.skin) return nullptr;
  const SkinDescription& skin = *description.skin;
  Mesh surface = skin.surface;
  const CellBlock* facets = surface.find_block(CellKind::triangle);
  if (facets == nullptr && dim == 2) facets = surface.find_block(CellKind::line);
  if (facets == nullptr || facets->num_cells() == 0) {
    throw InputError(
        skin.place,
        dim == 2 ? "triangles or lines in " + skin.surface_name : "triangles in " + skin.surface_name, "none",
        "a skin is a surface, such as an OBJ file");
  }
  surface.blocks = {CellBlock(*facets)};
  surface.groups.clear();
  surface.cell_fields.clear();
  remove_unused_nodes(surface);
  const Placement placement(description);
  for (Vector3& X : surface.vertices) {
    X = placement(X);
    if (dim == 2) X.z() = 0;
  }
  const auto size = static_cast<Eigen::Index>(3 * surface.vertices.size());
  Skin made{.name = skin.surface_name,
            .facets = surface.blocks[0],
            .rest_positions = Eigen::Map<const VectorX>(surface.vertices.front().data(), size),
            .embedding = Embedding(require_element(body.element, dim, skin.place), body.cells, rest_positions,
                                   surface.vertices, skin.is_smooth)};
  if (!description.rigid)
    check_distance(skin, body, made.embedding, extent_of(body, rest_positions, dim), warnings);
  return std::make_shared<const Skin>(std::move(made));
}

}  // namespace resilin
