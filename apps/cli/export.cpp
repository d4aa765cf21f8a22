#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/live/played_otherwise.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/playable_page.hpp"
#include "resilin/results/taking_up.hpp"
#include "resilin/scene/scene.hpp"
#include "subprocess.hpp"
#include "temporary_place.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct ExportOptions {
  std::string shown, out, engine;  ///< `shown`: scene or folder
  std::vector<std::string> overrides;
};

/// Builds the module in the checkout that this program was built in; false where there is none, or it fails.
bool build_engine(const std::filesystem::path& engine) {
  constexpr int levels = 5;  // build/wasm/apps/play/resilin_play.wasm
  constexpr double longest = 4 * 3600;
  std::filesystem::path root = engine;
  for (int level = 0; level < levels; ++level) root = root.parent_path();
  const std::filesystem::path script = root / "scripts/build_wasm.sh";
  const std::optional<std::filesystem::path> shell = find_program("bash");
  std::error_code failure;
  if (!shell || !engine.is_absolute() || !std::filesystem::is_regular_file(script, failure)) return false;
  const TemporaryPlace place("resilin-export");
  print_line("The WebAssembly module is built, once; this takes some minutes ...");
  flush_output();
  const Subprocess built = run_subprocess(*shell, {script.string()}, place.path(), longest);
  if (built.end == Subprocess::End::interrupted) throw Interrupted();
  if (built.end == Subprocess::End::exited && built.exit_code == 0)
    return std::filesystem::is_regular_file(engine, failure);
  throw InputError("export", "a build of the WebAssembly module that succeeds", one_line(built.log_end),
                   "run " + one_line(script.string()) + " to see why, or name a module by --engine");
}

/// Path of the WebAssembly solver: named, installed beside this program's other files, or built in the
/// checkout that this program was built in.
std::filesystem::path engine_file(const ExportOptions& options) {
  if (!options.engine.empty()) return options.engine;
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  const std::array<std::filesystem::path, 2> places = {
      program.parent_path().parent_path() / "share/resilin/resilin_play.wasm", RESILIN_PLAY_ENGINE};
  for (const std::filesystem::path& place : places)
    if (std::filesystem::is_regular_file(place, failure)) return place;
  if (build_engine(places[1])) return places[1];
  throw InputError(
      "export", "the WebAssembly module resilin_play.wasm, which a build makes once", "none",
      "build it with scripts/build_wasm.sh in the checkout (a few minutes), or name it by --engine");
}

std::string read_engine(const std::filesystem::path& path) {
  std::string engine = read_file(path);
  constexpr std::string_view mark("\0asm", 4);
  const bool is_module = engine.starts_with(mark);
  constexpr std::string_view newest_call = "resilin_start";
  if (!is_module || engine.find(newest_call) == std::string::npos)
    throw InputError(one_line(path.string()), "the WebAssembly module of Resilin " + std::string(version()),
                     is_module ? "another one" : "a file of another kind", "scripts/build_wasm.sh builds it");
  return engine;
}

std::string cells_of(const World& world) {
  Offset cells = 0;
  for (const Body& body : world.bodies) cells += body.num_cells();
  return std::to_string(cells) + (cells == 1 ? " cell" : " cells") + " to play with";
}

void write_page(const ExportOptions& options, const std::string& page, const std::string& what) {
  write_text(options.out, page);
  print_line(one_line(options.out) + ": " + what + " in " + format_bytes(page.size()) +
             "; open it in a browser, no server and no network is needed");
}

void export_scene(const ExportOptions& options, const std::string& engine) {
  const Scene scene = read_scene(options.shown, {.overrides = options.overrides});
  const LiveScene live(scene.description);  // reports here, not in the browser, if the scene cannot be played
  print_warnings(scene.warnings);
  write_page(options, playable_page(engine, scene.description, scene.warnings), cells_of(live.world()));
}

/// A recording that is taken up by hand.
void export_results(const ExportOptions& options, const std::string& engine) {
  if (!options.overrides.empty())
    throw InputError("--set", "a scene to change", "the folder of results " + one_line(options.shown));
  const std::filesystem::path folder = options.shown;
  const std::shared_ptr<const World> world = world_to_take_up(folder);
  const LiveScene live(*world->made_from, state_to_take_up(folder, *world, 0));
  const std::vector<std::string> notes = played_otherwise(*world->made_from);
  const std::string page = recorded_page_to_take_up(engine, folder, *world, notes);
  for (const std::string& note : notes) print_line("interactive continuation: " + note);
  write_page(options, page, "a recording, and " + cells_of(*world) + " from each of its frames");
}

int export_page(const ExportOptions& options) {
  const std::filesystem::path out = options.out;
  if (out.extension() != ".html" && out.extension() != ".htm")
    throw InputError(one_line(options.out), "a name that ends in .html",
                     out.extension().empty() ? "none" : one_line(out.extension().string()));
  const std::string engine = read_engine(engine_file(options));
  if (std::filesystem::is_directory(options.shown))
    export_results(options, engine);
  else
    export_scene(options, engine);
  return done;
}

}  // namespace

void add_export(CommandLine& line, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  const Command command =
      line.command("export", "Write a scene or a run as one self-contained interactive page");
  command
      .option("shown", options->shown,
              "Scene file (TOML), or folder of a run with formats = [\"vtu\", \"html\"]")
      .required()
      .type_name("SCENE.toml|DIR")
      .is_file_or_folder({"toml"});
  command.option("out", options->out, "The page to write").required().type_name("PAGE.html");
  command.option("--set", options->overrides, "Change a value of the scene; repeatable")
      .type_name("KEY=VALUE")
      .repeatable();
  command
      .option("--engine", options->engine,
              "The WebAssembly module that simulates in the page; default that of this installation")
      .type_name("resilin_play.wasm");
  command.footer(
      "Examples:\n  resilin export examples/spot.toml spot.html\n  resilin export out/spot spot.html\n\n"
      "The page holds the scene, its meshes and the solver, compiled to WebAssembly: it opens from disk in\n"
      "a current browser, also on a phone. The page of a run plays its frames, like result.html, and "
      "continues\n"
      "interactively from any of them. scripts/build_wasm.sh builds the module once.");
  command.on_chosen([options, &action] { action = [options] { return export_page(*options); }; });
}

}  // namespace resilin::cli
