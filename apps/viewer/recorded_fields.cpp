#include "recorded_fields.hpp"

#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/results/frame_fields.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/view/header.hpp"

namespace resilin::viewer {

/// A run whose frames can be computed with.
struct RecordedFields::Run {
  Run(std::shared_ptr<const World> saved, std::vector<std::filesystem::path> frames)
      : world(std::move(saved)), fields(*world, std::move(frames)) {}

  std::shared_ptr<const World> world;
  FrameFields fields;
};

RecordedFields::RecordedFields(std::filesystem::path folder) : folder_(std::move(folder)) {}

RecordedFields::~RecordedFields() = default;

RecordedFields::Run* RecordedFields::run() {
  if (run_) return run_.get();
  std::vector<std::filesystem::path> frames = frame_files(folder_);
  if (frames.empty()) return nullptr;
  std::shared_ptr<const World> world = saved_world(folder_);
  if (world) run_ = std::make_unique<Run>(std::move(world), std::move(frames));
  return run_.get();
}

std::string RecordedFields::list() {
  const Run* known = run();
  return known == nullptr ? "[]" : encode_fields(vertex_fields(known->world->dimension), *known->world);
}

std::string RecordedFields::values(std::string_view name, const std::function<bool()>& is_wanted) {
  Run* known = run();
  if (known == nullptr)
    throw InputError(folder_.string(), "scene.bin and frames of the run", "a folder without",
                     "run the scene again with \"vtu\" in output.formats");
  const std::vector<ScalarField> field = {require_vertex_field(name, known->world->dimension, "field")};
  return known->fields.values(field, is_wanted).front();
}

}  // namespace resilin::viewer
