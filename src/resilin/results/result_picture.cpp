#include "resilin/results/result_picture.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/fields/scalar_field.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/picture/picture_field.hpp"
#include "resilin/results/collider_file.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/moment.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/results/skinned_frame.hpp"
#include "resilin/view/header.hpp"
#include "resilin/world/rigid_shape.hpp"
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

/// Title and unit of the colour bar: those that the page has, too.
void describe_field(PictureOptions& options) {
  for (const ScalarField& known : scalar_fields(3)) {
    if (known.name != options.field) continue;
    if (options.label.empty()) options.label = known.label;
    if (options.unit.empty()) options.unit = known.field->unit;
  }
}

bool holds(const VtuContent& content, const std::string& field) {
  if (field == no_field) return true;
  const std::vector<std::string> names = picture_field_names(content);
  return std::ranges::find(names, field) != names.end() ||
         std::ranges::find(names, base_name(field)) != names.end();
}

constexpr const char* usual_field = "nodal_von_mises";

bool has_skins(const World& world) {
  return world.dimension == 3 && std::ranges::any_of(world.bodies, is_shown_by_skin);
}

bool has_stress(const World& world) {
  return std::ranges::any_of(world.bodies, [](const Body& body) { return body.rigid == nullptr; });
}

/// The range of what is drawn, over all points that cells use.
std::optional<std::array<double, 2>> extremes_of(const VtuContent& frame, const PictureField& field) {
  std::optional<std::array<double, 2>> range;
  for (const CellBlock& block : frame.file.mesh.blocks)
    for (const Index node : block.nodes) {
      const double value = field.values[static_cast<std::size_t>(node)];
      if (!std::isfinite(value)) continue;
      if (!range) range = {value, value};
      range = {std::min((*range)[0], value), std::max((*range)[1], value)};
    }
  return range;
}

/// A frame of a known world: gravity says what is up, and skins are drawn for what is known at the nodes.
Image draw_frame(const World& world, const State& state, const VtuContent& frame, const Mesh& colliders,
                 PictureOptions options) {
  describe_field(options);
  if (options.caption.empty()) options.caption = words_of_moment(world, state);
  for (const FieldInfo& known : fields())
    if (known.name == base_name(options.field)) options.smallest_range = 1e-9 * field_scale(known, world);
  if (world.gravity.norm() > 0) options.vertical = -world.gravity.normalized();
  if (options.field == no_field) {
    options.has_skins = has_skins(world);
    return draw_picture(options.has_skins ? with_skins(world, state, frame) : frame, options, colliders);
  }
  const PictureField field = pick_field(frame, options.field, "field");
  if (!has_skins(world) || !field.is_on_points) return draw_picture(frame, options, colliders);
  options.extremes = extremes_of(frame, field);
  options.has_skins = true;
  return draw_picture(with_skins(world, state, frame), options, colliders);
}

Image draw_state(const World& world, const State& state, const Mesh& colliders, PictureOptions options) {
  // The size of a vibration is arbitrary, and so are its stresses.
  if (options.field.empty()) options.field = world.modes || !has_stress(world) ? displacement : usual_field;
  std::vector<std::string> names = {displacement};
  if (options.field != no_field && base_name(options.field) != names[0])
    names.push_back(base_name(options.field));
  require_field(names.back(), "field");
  const VtuContent frame = frame_content(world, state, FieldEvaluator(world).evaluate(state, names));
  return draw_frame(world, state, frame, colliders, std::move(options));
}

/// "Mode 7: 523 Hz" for a frame of vibrations; else nothing.
std::string caption_of(const std::filesystem::path& frame) {
  const std::filesystem::path report =
      std::filesystem::absolute(frame).parent_path().parent_path() / report_name;
  if (!std::filesystem::is_regular_file(report)) return {};
  const Json json = Json::parse(read_file(report), nullptr, /*allow_exceptions=*/false);
  std::size_t number = 0;
  const std::string name = frame.stem().string();
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || !json.is_object()) return {};
  const auto frames = json.find("frames");
  if (frames == json.end() || !frames->is_array() || number >= frames->size()) return {};
  const auto mode = (*frames)[number].find("mode");
  if (mode == (*frames)[number].end() || !mode->is_object()) return {};
  const int which = mode->value("number", 0);
  const std::string words = mode->value("rigid", false) ? "moves as a rigid body"
                                                        : format_short(mode->value("frequency", 0.0)) + " Hz";
  return "Mode " + std::to_string(which) + ": " + words;
}

/// World and state of a frame. What cannot be used is refused, unless the frame can be drawn as it is.
struct Known {
  std::shared_ptr<const World> world;
  State state;
};
Known known_of(const std::filesystem::path& file, const VtuContent& content, bool is_needed) {
  try {
    Known known{saved_world_of_frame(file), {}};
    if (known.world) known.state = state_of_frame(*known.world, content, file);
    return known;
  } catch (const InputError&) {
    if (is_needed) throw;
    return {};
  }
}

}  // namespace

Image draw_result(const std::filesystem::path& place, int frame, PictureOptions options) {
  const std::filesystem::path file = frame_file(place, frame);
  const VtuContent content = read_vtu(file);
  if (options.caption.empty()) options.caption = caption_of(file);
  const bool needs_rest_shape = options.shows_rest || options.scale != 1;
  const bool holds_all = !options.field.empty() && holds(content, options.field) &&
                         (!needs_rest_shape || holds(content, displacement));
  const Known known = known_of(file, content, /*is_needed=*/!holds_all);
  if (known.world) {
    const Mesh colliders = saved_colliders(file);
    return holds_all ? draw_frame(*known.world, known.state, content, colliders, std::move(options))
                     : draw_state(*known.world, known.state, colliders, std::move(options));
  }
  if (options.field.empty()) {
    for (const char* usual : {usual_field, "averaged_von_mises", "von_mises", displacement})
      if (options.field.empty() && holds(content, usual)) options.field = usual;
  }
  describe_field(options);
  return draw_picture(content, options, saved_colliders(file));
}

Image draw_state(const World& world, const State& state, PictureOptions options) {
  return draw_state(world, state, collider_facets(world, conditions_of(state)).mesh, std::move(options));
}

}  // namespace resilin
