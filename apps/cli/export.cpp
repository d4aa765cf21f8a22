#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/results/playable_page.hpp"
#include "resilin/scene/scene.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct ExportOptions {
  std::string scene, out, engine;
  std::vector<std::string> overrides;
};

/// What simulates in the page: named, installed beside this program's other files, or built in the checkout
/// that this program was built in.
std::filesystem::path engine_file(const ExportOptions& options) {
  if (!options.engine.empty()) return options.engine;
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  const std::array<std::filesystem::path, 2> places = {
      program.parent_path().parent_path() / "share/resilin/resilin_play.wasm", RESILIN_PLAY_ENGINE};
  for (const std::filesystem::path& place : places)
    if (std::filesystem::is_regular_file(place, failure)) return place;
  throw InputError(
      "export", "the WebAssembly module resilin_play.wasm, which a build makes once", "none",
      "build it with scripts/build_wasm.sh in the checkout (a few minutes), or name it by --engine");
}

std::string read_engine(const std::filesystem::path& path) {
  std::string engine = read_file(path);
  constexpr std::string_view mark("\0asm", 4);
  if (!engine.starts_with(mark))
    throw InputError(one_line(path.string()), "a WebAssembly module", "a file that is none",
                     "scripts/build_wasm.sh builds it");
  return engine;
}

int export_page(const ExportOptions& options) {
  const std::filesystem::path out = options.out;
  if (out.extension() != ".html" && out.extension() != ".htm")
    throw InputError(one_line(options.out), "a name that ends in .html",
                     out.extension().empty() ? "none" : one_line(out.extension().string()));
  const std::string engine = read_engine(engine_file(options));
  const Scene scene = read_scene(options.scene, {.overrides = options.overrides});
  const LiveScene live(scene.description);  // what cannot be played is said here, not in the browser
  std::vector<std::string> warnings = scene.warnings;
  print_warnings(warnings);
  Offset cells = 0;
  for (const Body& body : live.world().bodies) cells += body.num_cells();
  const std::string page = playable_page(engine, scene.description, warnings);
  write_text(out, page);
  print_line(one_line(options.out) + ": " + std::to_string(cells) + " cells to play with in " +
             format_bytes(page.size()) + "; open it in a browser, no server and no network is needed");
  return done;
}

}  // namespace

void add_export(CommandLine& line, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  const Command command =
      line.command("export", "Write a scene as one page that anyone can open and pull at, offline");
  command.option("scene", options->scene, "Scene file (TOML)").required().type_name("SCENE.toml");
  command.option("out", options->out, "The page to write").required().type_name("PAGE.html");
  command.option("--set", options->overrides, "Change a value of the scene; may be given several times")
      .type_name("KEY=VALUE")
      .repeatable();
  command
      .option("--engine", options->engine,
              "The WebAssembly module that simulates in the page; default that of this installation")
      .type_name("resilin_play.wasm");
  command.footer(
      "Example:\n  resilin export examples/spot.toml spot.html\n\nThe page holds the scene, its meshes and "
      "the "
      "solver, "
      "compiled to WebAssembly: it opens from disk in\na browser of today, on a phone, too. "
      "scripts/build_wasm.sh builds the module once.");
  command.on_chosen([options, &action] { action = [options] { return export_page(*options); }; });
}

}  // namespace resilin::cli
