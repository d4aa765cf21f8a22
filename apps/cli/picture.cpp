#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "resilin/core/text.hpp"
#include "resilin/picture/camera.hpp"
#include "resilin/picture/color_map.hpp"
#include "resilin/results/result_picture.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct PictureCommand {
  std::string folder, out;
  int frame = -1;
  std::vector<int> size;
  std::vector<double> range;
  bool edges = false, no_edges = false;
  PictureOptions picture;
};

int draw(const PictureCommand& command) {
  PictureOptions options = command.picture;
  if (!command.size.empty()) {
    options.width = command.size[0];
    options.height = command.size[1];
  }
  if (!command.range.empty()) options.range = {command.range[0], command.range[1]};
  if (command.edges) options.edges = "on";
  if (command.no_edges) options.edges = "off";
  const Image image = draw_result(command.folder, command.frame, options);
  write_png(command.out, image);
  print_line(command.out + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
             " pixels");
  return done;
}

}  // namespace

void add_picture(CLI::App& app, Action& action) {
  auto options = std::make_shared<PictureCommand>();
  CLI::App* command =
      app.add_subcommand("picture", "Draw a result, coloured by a field, on a machine without a display");
  PictureOptions& picture = options->picture;
  command->add_option("dir", options->folder, "Folder of a run, or a .vtu file")
      ->required()
      ->type_name("DIR");
  command->add_option("--out", options->out, "PNG file that is written")->required()->type_name("FILE.png");
  command
      ->add_option("--field", picture.field,
                   "Field of the frames, with a component where it has several: von_mises, displacement.z, "
                   "cauchy_stress.xy; default von_mises, else displacement")
      ->type_name("NAME[.COMPONENT]");
  command->add_option("--frame", options->frame, "Number of the frame; default -1, the last")->type_name("N");
  command->add_option("--size", options->size, "Width and height in pixels; default 1200 900")
      ->expected(2)
      ->type_name("W H");
  command
      ->add_option(
          "--view", picture.view,
          join(view_names()) + ", or a direction from the body to the eye such as 1,-2,1; default iso")
      ->type_name("VIEW");
  command->add_option("--up", picture.up, "Axis that points up: x, y or z; default z")->type_name("AXIS");
  command
      ->add_option("--range", options->range, "Values at the ends of the colours; default those of the field")
      ->expected(2)
      ->type_name("MIN MAX");
  command->add_option("--map", picture.map, "Colours: auto, " + join(color_map_names()) + "; default auto")
      ->type_name("MAP");
  command->add_option("--scale", picture.scale, "Factor on displacements; default 1")->type_name("S");
  CLI::Option* edges =
      command->add_flag("--edges", options->edges, "Edges of cells; default where there is room");
  command->add_flag("--no-edges", options->no_edges, "No edges")->excludes(edges);
  command->add_flag("--rest", picture.shows_rest, "Outline of the rest shape");
  command->add_flag("--dark", picture.is_dark, "Dark background");
  command->footer(
      "Example:\n  resilin picture out/beam --field von_mises --out stress.png\n\nThe fields that frames "
      "hold are those "
      "of `output.fields` in the scene.");
  command->callback([options, &action] { action = [options] { return draw(*options); }; });
}

}  // namespace resilin::cli
