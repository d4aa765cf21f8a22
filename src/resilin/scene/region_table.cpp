#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

/// A region and the mesh of its body, which lists by cell of its material need.
struct RegionOfMesh {
  RegionDescription& region;
  const Mesh& mesh;
};

Keys<RegionOfMesh> region_keys() {
  using R = RegionOfMesh;
  return {
      key<R>({"name", "text", "", "its number, from 1",
              "Parameters, the report and `--set` refer to it: "
              "`body.BODY.region.NAME.material.youngs_modulus`."},
             [](const SceneNode& node, R& r) { r.region.name = read_text(node); }),
      key<R>({"where", "[where](#where)", "", "required",
              "Cells whose centroid it holds; a `group` means its cells, `vertices` the cells that have no "
              "others. A cell belongs to the first region that contains it."},
             [](const SceneNode& node, R& r) { read_where(node, r.region.where); }),
      key<R>({"material", "[material](#material)", "", "required unless rigid",
              "What these cells are made of; lists by cell have an entry for each cell of the body."},
             [](const SceneNode& node, R& r) { read_material(node, r.mesh, r.region.material); }),
      key<R>({"rigid", "true, false or [rigid](#rigid)", "", "false",
              "These cells keep their shape; in place of material. Joints and springs call them BODY.REGION "
              "([rigid regions](rigid.md#rigid-regions))."},
             [](const SceneNode& node, R& r) { read_rigid(node, r.region.rigid); }),
  };
}

}  // namespace

void read_regions(const SceneNode& node, const Mesh& mesh, std::vector<RegionDescription>& regions) {
  if (!node.value->is_array()) node.fail("a list of tables, each headed [[body.region]]");
  for (std::size_t i = 0; i < node.value->array().size(); ++i) {
    const SceneNode element = node.element(i);
    RegionDescription& region = regions.emplace_back();
    region.place = element.place();
    region.name = std::to_string(i + 1);
    RegionOfMesh target{region, mesh};
    read_table(element, region_keys(), target);
    if (!region.rigid && !element.has("material"))
      element.fail_with(
          "the key \"material\" is missing; give material = a table (docs/scene.md#material), or "
          "rigid = { density = 7800 }");
    if (region.rigid && element.has("material"))
      element.child("material")
          .fail_with("is for deformable cells; rigid ones have rigid = { density = 7800 }");
  }
}

TableDoc region_doc() {
  return document(
      "[[body.region]]",
      "Cells of the [[body]] above it that are of another material, or rigid; they share its vertices "
      "([materials.md](materials.md#several-materials-in-a-body)). Cells in no region are of the "
      "body's own material.",
      region_keys());
}

}  // namespace resilin
