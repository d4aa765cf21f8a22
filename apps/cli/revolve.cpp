#include <memory>
#include <string>

#include "command.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/results/revolved.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct RevolveCommand {
  std::string folder;
  Revolution revolution;
};

int revolve(const RevolveCommand& command) {
  const double angle = command.revolution.angle;
  if (!(angle > 0 && angle <= 360))
    throw InputError("--angle", "an angle above 0 and at most 360 degrees", format_short(angle));
  const std::size_t frames = write_revolved(command.folder, command.revolution);
  print_line(one_line(command.folder) + "/revolved.pvd: " + std::to_string(frames) +
             (frames == 1 ? " frame" : " frames") + " for ParaView");
  return done;
}

}  // namespace

void add_revolve(CommandLine& line, Action& action) {
  auto options = std::make_shared<RevolveCommand>();
  const Command command =
      line.command("revolve", "Write the frames of an axisymmetric run as revolved bodies (VTU)");
  command.option("dir", options->folder, "Folder of an axisymmetric run with \"vtu\" among output.formats")
      .required()
      .type_name("DIR")
      .is_folder();
  command.option("--angle", options->revolution.angle, "Angle of the turn in degrees, at most 360")
      .type_name("DEGREES")
      .shows_default();
  constexpr int least = 3, most = 3600;
  command.option("--sectors", options->revolution.sectors, "Number of cells around the turn")
      .type_name("N")
      .between(least, most)
      .shows_default();
  command.footer(
      "Example:\n  resilin revolve out/o_ring --angle 180\n\n"
      "The files are DIR/revolved.pvd and, with colliders, DIR/revolved_colliders.pvd.\n"
      "Vectors and tensors turn with the section. The axis of the body is the y axis.");
  command.on_chosen([options, &action] { action = [options] { return revolve(*options); }; });
}

}  // namespace resilin::cli
