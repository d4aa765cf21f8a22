#include "resilin/results/collider_file.hpp"

#include "resilin/results/frame_file.hpp"
#include "resilin/world/shown_colliders.hpp"

namespace resilin {
namespace {

constexpr const char* folder_name = "colliders";

std::string name_of(std::size_t number) { return std::string(folder_name) + "/" + numbered_vtu(number); }

}  // namespace

bool has_colliders(const World& world) { return !world.colliders.empty() || !world.mesh_colliders.empty(); }

std::string collider_file_name(const World& world, std::size_t frame) {
  return name_of(any_collider_moves(world) ? frame : 0);
}

VtuContent collider_content(const World& world, const State& state) {
  ColliderFacets facets = collider_facets(world, conditions_of(state));
  VtuContent content;
  content.file.mesh = std::move(facets.mesh);
  content.cell_data.push_back({.name = "collider", .components = 1, .values = std::move(facets.numbers)});
  content.time = shown_time(world, state);
  return content;
}

std::filesystem::path saved_collider_file(const std::filesystem::path& frame_file) {
  const std::filesystem::path frames = std::filesystem::absolute(frame_file).parent_path();
  if (frames.filename() != "frames") return {};
  const std::filesystem::path folder = frames.parent_path() / folder_name;
  for (const std::filesystem::path& file : {folder / frame_file.filename(), folder / numbered_vtu(0)})
    if (std::filesystem::is_regular_file(file)) return file;
  return {};
}

Mesh saved_colliders(const std::filesystem::path& frame_file) {
  const std::filesystem::path file = saved_collider_file(frame_file);
  return file.empty() ? Mesh() : read_vtu(file).file.mesh;
}

void remove_collider_files(const std::filesystem::path& folder, std::size_t end) {
  std::error_code error;
  while (std::filesystem::remove(folder / name_of(end), error)) ++end;
}

}  // namespace resilin
