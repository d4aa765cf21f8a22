#include "resilin/results/saved_run.hpp"

#include <algorithm>
#include <optional>
#include <ostream>
#include <string_view>

#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/world/description_image.hpp"

namespace resilin {
namespace {

std::filesystem::path scene_file(const std::filesystem::path& folder) { return folder / "scene.bin"; }

bool has_same_cells(const Mesh& a, const Mesh& b) {
  return a.vertices.size() == b.vertices.size() &&
         std::ranges::equal(a.blocks, b.blocks, [](const CellBlock& left, const CellBlock& right) {
           return left.kind == right.kind && left.nodes == right.nodes;
         });
}

/// dim numbers for each node of a world, the first points of the frame, of the three that it has.
std::optional<VectorX> nodal_vector(const VtuContent& frame, std::string_view name, const World& world) {
  const auto found = std::ranges::find(frame.point_data, name, &VtuValues::name);
  if (found == frame.point_data.end() || found->components != 3) return std::nullopt;
  const int dim = world.dimension;
  VectorX vector(world.rest_positions.size());
  for (Eigen::Index i = 0; i < vector.size(); ++i)
    vector[i] = found->values[static_cast<std::size_t>(i / dim * 3 + i % dim)];
  return vector;
}

}  // namespace

std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "frames", error))
    if (entry.path().extension() == ".vtu") files.push_back(entry.path());
  std::ranges::sort(files, [](const auto& a, const auto& b) {
    const std::string left = a.filename().string(), right = b.filename().string();
    return left.size() != right.size() ? left.size() < right.size() : left < right;  // 9999 before 10000
  });
  return files;
}

void save_scene(const std::filesystem::path& folder, const World& world) {
  std::error_code ignored;
  if (!world.made_from) {
    std::filesystem::remove(scene_file(folder), ignored);
    return;
  }
  const std::string image = serialize(*world.made_from);
  write_atomically(scene_file(folder), [&image](std::ostream& stream) { stream << image; });
}

std::shared_ptr<const World> saved_world(const std::filesystem::path& folder) {
  const std::filesystem::path file = scene_file(folder);
  if (!std::filesystem::is_regular_file(file)) return nullptr;
  return std::make_shared<const World>(deserialize_description(read_file(file), file.string()));
}

std::shared_ptr<const World> saved_world_of_frame(const std::filesystem::path& file) {
  const std::filesystem::path frames = std::filesystem::absolute(file).parent_path();
  return frames.filename() == "frames" ? saved_world(frames.parent_path()) : nullptr;
}

State state_of_frame(const World& world, const VtuContent& frame, const std::filesystem::path& file) {
  State state;
  state.positions = world.rest_positions;
  state.velocities = VectorX::Zero(state.positions.size());
  if (!has_same_cells(frame.file.mesh, frame_content(world, state, {}).file.mesh))
    throw InputError(file.string(), "a frame of the scene in scene.bin", "one with other cells",
                     "run the scene again");
  const std::optional<VectorX> displacements = nodal_vector(frame, "displacement", world);
  if (displacements && !world.origin.isZero(0)) {
    state.positions += *displacements;
  } else {
    for (Index node = 0; node < world.num_nodes(); ++node)
      state.positions.segment(Eigen::Index{node} * world.dimension, world.dimension) =
          (frame.file.mesh.vertices[static_cast<std::size_t>(node)] - world.origin).head(world.dimension);
  }
  if (const std::optional<VectorX> velocities = nodal_vector(frame, "velocity", world))
    state.velocities = *velocities;
  state.history = frame_history(world, frame);
  set_shown_time(frame.time.value_or(0), world, state);
  if (const auto delay = frame.numbers.find(delay_name); delay != frame.numbers.end())
    state.collider_delay = delay->second;
  return state;
}

}  // namespace resilin
