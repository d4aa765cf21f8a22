#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "picture_options.hpp"
#include "resilin/fields/catalog.hpp"
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
  LeftOut left_out;
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
  command.left_out.apply(options);
  const Image image = draw_result(command.folder, command.frame, options);
  write_png(command.out, image);
  print_line(command.out + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) +
             " pixels" + (image.legend.empty() ? "" : "; " + image.legend));
  return done;
}

}  // namespace

void add_picture(CommandLine& line, Action& action) {
  auto options = std::make_shared<PictureCommand>();
  const Command command = line.command("picture", "Render a result, coloured by a field; needs no display");
  PictureOptions& picture = options->picture;
  command.option("dir", options->folder, "Folder of a run, or a .vtu file")
      .required()
      .type_name("DIR")
      .is_file_or_folder({"vtu"});
  command.option("--out", options->out, "Output PNG file").required().type_name("FILE.png").is_file({"png"});
  command
      .option("--field", picture.field,
              "Field of the frames, with a component where it has several: von_mises, displacement.z, "
              "cauchy_stress.xy; averaged_ or nodal_ before a cell field gives vertex values; "
              "default nodal_von_mises, as on the page; none: one colour per body")
      .type_name("NAME[.COMPONENT]")
      .offers(field_names)
      .group("Display");
  command.option("--frame", options->frame, "Number of the frame; default -1, the last")
      .type_name("N")
      .group("Display");
  command.option("--size", options->size, "Width and height in pixels; default 1200 900")
      .values(2, 2)
      .type_name("W H")
      .group("Picture");
  add_view_options(command, picture, ": the direction that shows most of the body and its motion");
  command.option("--range", options->range, "Limits of the colour range; default: those of the field")
      .values(2, 2)
      .type_name("MIN MAX")
      .group("Colours");
  add_color_options(command, picture);
  const Option edges =
      command.flag("--edges", options->edges, "Draw cell edges; default: if the cells are large enough")
          .group("Display");
  command.flag("--no-edges", options->no_edges, "No edges").excludes(edges).group("Display");
  add_surroundings(command, picture, options->left_out);
  command
      .flag("--transparent", picture.is_transparent,
            "Transparent background, for bright pages; with --dark for dark ones")
      .group("Colours");
  command.footer(
      "Example:\n  resilin picture out/beam --field von_mises --out stress.png\n\nThe fields that frames "
      "hold are those "
      "of `output.fields` in the scene.");
  command.on_chosen([options, &action] { action = [options] { return draw(*options); }; });
}

}  // namespace resilin::cli
