#include "resilin/world/description_image.hpp"

#include <algorithm>

#include "resilin/core/archive.hpp"
#include "resilin/world/description_members.hpp"

namespace resilin {
namespace {

constexpr std::string_view scene_mark = "resilin scene 4\n";  // another number for other members

}  // namespace

std::string serialize(const Description& description) {
  ArchiveWriter writer;
  writer(description);
  return sealed(scene_mark, writer.take());
}

Description deserialize_description(std::string_view image, const std::string& place) {
  constexpr const char* cure = "run the scene again";
  ArchiveReader reader(unsealed(image, scene_mark, place, cure), place, cure);
  Description description;
  reader(description);
  reader.end();
  const bool are_bodies_sound = std::ranges::all_of(description.bodies, [](const BodyDescription& body) {
    return body.mesh.is_whole() && (!body.skin || body.skin->surface.is_whole());
  });
  const bool are_colliders_sound =
      std::ranges::all_of(description.colliders,
                          [](const ColliderDescription& collider) { return collider.shape.mesh.is_whole(); });
  if (!are_bodies_sound || !are_colliders_sound) reader.fail();
  return description;
}

}  // namespace resilin
