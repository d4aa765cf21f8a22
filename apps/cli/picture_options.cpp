#include "picture_options.hpp"

#include <vector>

#include "offered_words.hpp"
#include "resilin/core/text.hpp"
#include "resilin/picture/camera.hpp"
#include "resilin/picture/color_map.hpp"

namespace resilin::cli {

void add_view_options(const Command& command, PictureOptions& picture, const std::string& about_auto) {
  command
      .option("--view", picture.view,
              "auto, " + join(view_names()) +
                  ", or a direction from the body to the eye such as 1,-2,1; default auto" + about_auto)
      .type_name("VIEW")
      .offers(view_words)
      .group("View");
  command.option("--up", picture.up, "Axis that points up: x, y or z; default auto: against gravity, else z")
      .type_name("AXIS")
      .offers([] { return std::vector<std::string>{"auto", "x", "y", "z"}; })
      .group("View");
}

void add_color_options(const Command& command, PictureOptions& picture) {
  command.option("--map", picture.map, "Colours: auto, " + join(color_map_names()) + "; default auto")
      .type_name("MAP")
      .offers(color_map_words)
      .group("Colours");
  command.option("--scale", picture.scale, "Factor on displacements; default 1")
      .type_name("S")
      .group("Display");
}

void add_surroundings(const Command& command, PictureOptions& picture, LeftOut& left_out) {
  command.flag("--rest", picture.shows_rest, "Outline of the reference configuration").group("Display");
  command.flag("--no-colliders", left_out.no_colliders, "No colliders").group("Display");
  command.flag("--no-bar", left_out.no_bar, "No colour bar").group("Picture");
  command.flag("--no-caption", left_out.no_caption, "No time, load factor or mode in the corner")
      .group("Picture");
  command.flag("--dark", picture.is_dark, "Dark background").group("Colours");
}

void LeftOut::apply(PictureOptions& picture) const {
  picture.shows_colliders = !no_colliders;
  picture.shows_bar = !no_bar;
  picture.shows_caption = !no_caption;
}

}  // namespace resilin::cli
