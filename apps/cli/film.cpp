#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "ffmpeg.hpp"
#include "interrupt.hpp"
#include "picture_options.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/catalog.hpp"
#include "resilin/picture/animation.hpp"
#include "resilin/results/result_film.hpp"
#include "subprocess.hpp"
#include "temporary_place.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr double encoding_seconds = 3600;

struct FilmCommand {
  std::string folder, out;
  std::vector<int> size;
  std::vector<double> range;
  double frames_per_second = 0;
  LeftOut left_out;
  FilmOptions film;
};

enum class Kind { animated_png, sequence, by_ffmpeg };

Kind kind_of(const std::filesystem::path& out) {
  const std::string extension = out.extension().string();
  if (extension == ".png" || extension == ".apng") return Kind::animated_png;
  if (extension.empty()) return Kind::sequence;
  if (std::ranges::find(encodings, extension, &Encoding::extension) != encodings.end())
    return Kind::by_ffmpeg;
  throw InputError(
      one_line(out.string()),
      "a name that ends in .png or .apng (an animated PNG), .gif, .webp, .mp4 or .webm, or a folder for "
      "single pictures",
      one_line(extension));
}

/// Options of ffmpeg besides the pictures.
std::vector<std::string> encoding(const std::string& extension) {
  const std::string even = "pad=ceil(iw/2)*2:ceil(ih/2)*2";
  if (extension == ".gif")
    return {"-filter_complex",
            "split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=sierra2_4a", "-loop", "0"};
  const std::string encoder(std::ranges::find(encodings, extension, &Encoding::extension)->encoder);
  if (extension == ".webp") return {"-c:v", encoder, "-lossless", "0", "-q:v", "85", "-loop", "0"};
  if (extension == ".webm") return {"-c:v", encoder, "-crf", "24", "-b:v", "0", "-pix_fmt", "yuv420p"};
  return {"-c:v",     encoder,   "-crf", "18", "-preset",   "slow",
          "-pix_fmt", "yuv420p", "-vf",  even, "-movflags", "+faststart"};
}

std::string picture_name(std::size_t number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%05zu.png", number);
  return text.data();
}

void say_progress(const char* what, std::size_t done, std::size_t all) {
  if (is_interrupted()) throw Interrupted();
  if (all > 20 && done > 0 && done % std::max<std::size_t>(1, all / 10) == 0)
    print_line(std::string(what) + " " + std::to_string(100 * done / all) + " %");
}

void draw_into(const FilmPlan& plan, const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < plan.shots.size(); ++i) {
    say_progress("Drawn", i, plan.shots.size());
    write_png(folder / picture_name(i), draw_shot(plan, i));
  }
}

void draw_animated_png(const FilmPlan& plan, const std::filesystem::path& out) {
  ApngWriter writer(out, static_cast<int>(plan.shots.size()), plan.frames_per_second);
  for (std::size_t i = 0; i < plan.shots.size(); ++i) {
    say_progress("Drawn", i, plan.shots.size());
    writer.add(draw_shot(plan, i));
  }
  writer.finish();
}

std::filesystem::path required_ffmpeg(const std::filesystem::path& out) {
  if (const auto program = find_program("ffmpeg")) return *program;
  std::filesystem::path animated = out;
  animated.replace_extension(".png");
  throw InputError(one_line(out.string()), "the program ffmpeg on PATH, which encodes it", "none",
                   "install it (" + std::string(how_to_install_ffmpeg) + "), or write " +
                       one_line(animated.string()) + ", an animated PNG, which needs no other program");
}

void encode(const FilmPlan& plan, const std::filesystem::path& out) {
  const std::filesystem::path program = required_ffmpeg(out);
  const TemporaryPlace place("resilin-film");
  draw_into(plan, place.path());
  std::vector<std::string> arguments = {
      "-y", "-loglevel", "error", "-framerate", format_number(plan.frames_per_second), "-i", "%05d.png"};
  const std::string extension = out.extension().string();
  const std::vector<std::string> more = encoding(extension);
  arguments.insert(arguments.end(), more.begin(), more.end());
  const std::string made = "film" + extension;
  arguments.push_back(made);
  const Subprocess run = run_subprocess(program, arguments, place.path(), encoding_seconds);
  if (run.end == Subprocess::End::interrupted) throw Interrupted();
  if (run.end != Subprocess::End::exited || run.exit_code != 0)
    throw FileError(out.string(), "cannot be made: ffmpeg: " + run.log_end);
  std::error_code error;
  std::filesystem::copy_file(place.path() / made, out, std::filesystem::copy_options::overwrite_existing,
                             error);
  if (error) throw FileError(out.string(), "cannot be written: " + error.message());
}

int film(const FilmCommand& command) {
  FilmOptions options = command.film;
  options.picture.width = 800;
  options.picture.height = 600;
  if (!command.size.empty()) {
    options.picture.width = command.size[0];
    options.picture.height = command.size[1];
  }
  if (!command.range.empty()) options.picture.range = {command.range[0], command.range[1]};
  if (command.frames_per_second != 0) options.frames_per_second = command.frames_per_second;
  command.left_out.apply(options.picture);
  const std::filesystem::path out = command.out;
  const Kind kind = kind_of(out);
  if (kind == Kind::by_ffmpeg) required_ffmpeg(out);  // before any work is done
  catch_interrupts();
  const FilmPlan plan = plan_film(command.folder, options, [](std::size_t done, std::size_t all) {
    say_progress("Looked through", done, all);
  });
  if (kind == Kind::sequence) {
    std::error_code error;
    std::filesystem::create_directories(out, error);
    if (error) throw FileError(out.string(), "cannot be made: " + error.message());
    draw_into(plan, out);
  } else if (kind == Kind::animated_png) {
    draw_animated_png(plan, out);
  } else {
    encode(plan, out);
  }
  print_line(command.out + ": " + std::to_string(plan.shots.size()) + " pictures of " +
             std::to_string(options.picture.width) + " x " + std::to_string(options.picture.height) +
             " pixels, " + format_short(plan.frames_per_second) + " a second");
  return done;
}

std::vector<std::string> film_extensions() {
  std::vector<std::string> extensions = {"png", "apng"};
  for (const Encoding& encoding : encodings) extensions.emplace_back(encoding.extension.substr(1));
  return extensions;
}

}  // namespace

void add_film(CommandLine& line, Action& action) {
  auto options = std::make_shared<FilmCommand>();
  const Command command = line.command("film", "Render a film of a run; needs no display");
  PictureOptions& picture = options->film.picture;
  command.option("dir", options->folder, "Folder of a run").required().type_name("DIR").is_folder();
  command
      .option("--out", options->out,
              "Output film: .png or .apng (animated PNG), .gif, .webp, .mp4, .webm (by ffmpeg), or "
              "a folder "
              "for single pictures")
      .required()
      .type_name("FILE")
      .is_file(film_extensions());
  command.option("--field", picture.field, "As for resilin picture")
      .type_name("NAME[.COMPONENT]")
      .offers(field_names)
      .group("Display");
  command.option("--size", options->size, "Width and height in pixels; default 800 600")
      .values(2, 2)
      .type_name("W H")
      .group("Picture");
  command.option("--every", options->film.every, "Take each n-th frame; default 1")
      .type_name("N")
      .group("Time");
  command
      .option("--fps", options->frames_per_second,
              "Frames per second; default: real time, 10 in statics, 30 for modes")
      .type_name("N")
      .group("Time");
  command.option("--speed", options->film.speed, "Playback speed, simulated over shown time; default 1")
      .type_name("X")
      .group("Time");
  command
      .option("--mode", options->film.mode,
              "Mode shape to animate; default: the first that is no rigid-body mode")
      .type_name("N")
      .group("Time");
  command.option("--turn", options->film.turn, "Angle of the camera orbit in degrees; default 0")
      .type_name("DEGREES")
      .group("View");
  add_view_options(command, picture);
  command
      .option("--range", options->range,
              "Limits of the colour range; default: all frames, without short peaks more than twice as large "
              "as the rest")
      .values(2, 2)
      .type_name("MIN MAX")
      .group("Colours");
  add_color_options(command, picture);
  add_surroundings(command, picture, options->left_out);
  command.footer(
      "Examples:\n  resilin film out/spot --out cow.png\n  resilin film out/heap --out heap.mp4 --size 1280 "
      "720 "
      "--speed 0.5\n  resilin film out/free_bar --mode 7 --out tone.gif\n\nAll pictures share one camera and "
      "one colour range.");
  command.on_chosen([options, &action] { action = [options] { return film(*options); }; });
}

}  // namespace resilin::cli
