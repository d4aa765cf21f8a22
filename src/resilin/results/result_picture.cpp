#include "resilin/results/result_picture.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/picture/picture_field.hpp"
#include "resilin/results/frame_file.hpp"

namespace resilin {
namespace {

/// Files of the frames in their order.
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

}  // namespace

Image draw_result(const std::filesystem::path& place, int frame, PictureOptions options) {
  const std::filesystem::path file = frame_file(place, frame);
  const VtuContent content = read_vtu(file);
  if (options.field.empty()) {
    const std::vector<std::string> names = picture_field_names(content);
    for (const char* name : {"displacement", "von_mises"})
      if (std::ranges::find(names, name) != names.end()) options.field = name;
  }
  describe_field(options);
  return draw_picture(content, options);
}

Image draw_state(const World& world, const State& state, PictureOptions options) {
  if (options.field.empty()) options.field = "von_mises";
  std::vector<std::string> names = {"displacement"};
  if (base_name(options.field) != names[0]) names.push_back(base_name(options.field));
  require_field(names.back(), "field");
  describe_field(options);
  return draw_picture(frame_content(world, state, FieldEvaluator(world).evaluate(state, names)), options);
}

}  // namespace resilin
