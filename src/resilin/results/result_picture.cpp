#include "resilin/results/result_picture.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/picture/picture_field.hpp"
#include "resilin/results/collider_file.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/world/shown_colliders.hpp"

namespace resilin {
namespace {

constexpr const char* displacement = "displacement";

std::filesystem::path frame_file(const std::filesystem::path& place, int frame) {
  if (std::filesystem::is_regular_file(place)) return place;
  if (!std::filesystem::is_directory(place))
    throw InputError(place.string(), "the folder of a run, or a .vtu file", "nothing there");
  const std::vector<std::filesystem::path> files = frame_files(place);
  if (files.empty())
    throw InputError(place.string(), "frames of a run (frames/0000.vtu ...)", "none",
                     "`resilin run SCENE.toml --out DIR` makes them; `output.formats` must have \"vtu\"");
  const int count = static_cast<int>(files.size());
  const int number = frame < 0 ? count + frame : frame;
  if (number < 0 || number >= count)
    throw InputError("frame", "0 to " + std::to_string(count - 1) + ", or -1 for the last",
                     std::to_string(frame));
  return files[static_cast<std::size_t>(number)];
}

/// The name before a component that a field has.
std::string base_name(const std::string& field) { return field.substr(0, field.rfind('.')); }

/// Title and unit of the colour bar.
void describe_field(PictureOptions& options) {
  for (const FieldInfo& field : fields()) {
    if (field.name != base_name(options.field)) continue;
    if (options.label.empty()) options.label = field.label;
    if (options.unit.empty()) options.unit = field.unit;
  }
}

bool holds(const VtuContent& content, const std::string& field) {
  const std::vector<std::string> names = picture_field_names(content);
  return std::ranges::find(names, field) != names.end() ||
         std::ranges::find(names, base_name(field)) != names.end();
}

Image draw_state(const World& world, const State& state, const Mesh& colliders, PictureOptions options) {
  if (options.field.empty()) options.field = "von_mises";
  std::vector<std::string> names = {displacement};
  if (base_name(options.field) != names[0]) names.push_back(base_name(options.field));
  require_field(names.back(), "field");
  describe_field(options);
  return draw_picture(frame_content(world, state, FieldEvaluator(world).evaluate(state, names)), options,
                      colliders);
}

}  // namespace

Image draw_result(const std::filesystem::path& place, int frame, PictureOptions options) {
  const std::filesystem::path file = frame_file(place, frame);
  const VtuContent content = read_vtu(file);
  if (options.field.empty() && holds(content, "von_mises")) options.field = "von_mises";
  const bool needs_rest_shape = options.shows_rest || options.scale != 1;
  const bool holds_all = !options.field.empty() && holds(content, options.field) &&
                         (!needs_rest_shape || holds(content, displacement));
  if (!holds_all) {
    if (const std::shared_ptr<const World> world = saved_world_of_frame(file))
      return draw_state(*world, state_of_frame(*world, content, file), saved_colliders(file),
                        std::move(options));
  }
  if (options.field.empty() && holds(content, displacement)) options.field = displacement;
  describe_field(options);
  return draw_picture(content, options, saved_colliders(file));
}

Image draw_state(const World& world, const State& state, PictureOptions options) {
  return draw_state(world, state, collider_facets(world, conditions_of(state)).mesh, std::move(options));
}

}  // namespace resilin
