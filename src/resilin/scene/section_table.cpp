#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

Keys<SectionDescription> section_plane_keys() {
  using S = SectionDescription;
  return {
      key<S>({"axis", "letter", "", "required", "\"x\", \"y\" or \"z\": the plane's normal."},
             [](const SceneNode& node, S& section) {
               const bool is_3d = node.context->dimension == 3;
               const std::string letter = read_choice(node, is_3d ? std::vector<std::string>{"x", "y", "z"}
                                                                  : std::vector<std::string>{"x", "y"});
               section.axis = letter[0] - 'x';
             }),
      key<S>({"at", "number", "m", "required", "Coordinate of the plane in the reference configuration."},
             [](const SceneNode& node, S& section) { section.at = read_number(node); }),
  };
}

}  // namespace

Keys<SectionDescription> section_keys() {
  using S = SectionDescription;
  return {
      text_key("name", &S::name, "section[0] ...", "Name in the report."),
      text_key("body", &S::body, "the only body", "Name of the cut body."),
      key<S>({"plane", "{ axis, at }", "m", "required",
              "Cells whose centroid has a smaller coordinate than `at` are below it."},
             [](const SceneNode& node, S& section) { read_table(node, section_plane_keys(), section); }),
  };
}

void read_section(const SceneNode& node, SectionDescription& section) {
  section.place = node.place();
  section.name = node.path;
  read_table(node, section_keys(), section);
}

}  // namespace resilin
