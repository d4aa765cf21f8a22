#include "resilin/world/scene_part_image.hpp"

#include "resilin/core/archive.hpp"
#include "resilin/world/description_members.hpp"

namespace resilin {

RESILIN_MEMBERS(SelectionPart, nodes, facets)
RESILIN_MEMBERS(ContactPart, nodes, stiffness)
RESILIN_MEMBERS(BodyPart, cells, mass, has_own_cells)
RESILIN_MEMBERS(ScenePart, description, origin, fingerprint, bodies, fixes, loads, colliders, probes, numbers,
                ranked_numbers, owners, copies_begin, copies, num_ranked)

std::string serialize(const ScenePart& part) {
  ArchiveWriter writer;
  writer(part);
  return writer.take();
}

ScenePart deserialize_scene_part(std::string_view bytes) {
  ArchiveReader reader(bytes, "a part of the scene");
  ScenePart part;
  reader(part);
  reader.end();
  return part;
}

}  // namespace resilin
