#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "offered_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/thread_count.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/catalog.hpp"
#include "terminal.hpp"
#include "viewer/browser.hpp"
#include "viewer/scene_source.hpp"
#include "viewer/served_live_scene.hpp"
#include "viewer/served_page.hpp"

namespace resilin::cli {
namespace {

struct ViewOptions {
  std::string shown;  ///< scene or folder
  std::vector<std::string> overrides;
  int port = 0;
  std::string address_file;  ///< empty: each start has an address of its own
  int threads = 0;
  bool has_no_browser = false;
};

viewer::ServerOptions server_options(const ViewOptions& options) {
  viewer::ServerOptions server;
  server.port = static_cast<std::uint16_t>(options.port);
  if (options.address_file.empty() || !std::filesystem::exists(options.address_file)) return server;
  // "http://127.0.0.1:PORT/?token=TOKEN", as an earlier start has written it.
  const std::string text = read_file(options.address_file);
  const std::regex form(R"(http://127\.0\.0\.1:(\d{1,5})/\?token=([0-9a-f]{32})\s*)");
  std::smatch found;
  if (!std::regex_match(text, found, form) || std::stoi(found[1]) > 65535)
    throw InputError(one_line(options.address_file), "an address that an earlier start has written",
                     "something else", "remove the file, and the next start writes one");
  if (options.port == 0) server.port = static_cast<std::uint16_t>(std::stoi(found[1]));
  server.token = found[2];
  return server;
}

/// Keeps the address for the next start, where only this user can read it.
void keep_address(const viewer::PageServer& server, const std::string& file) {
  if (file.empty() || std::filesystem::exists(file)) return;
  if (!viewer::write_private_file(file, server.address() + "\n"))
    throw FileError(one_line(file), "cannot be written");
}

/// Says where the page is, and waits for Ctrl-C.
int serve(const viewer::PageServer& server, const ViewOptions& options) {
  keep_address(server, options.address_file);
  catch_interrupts();
  print_line("Listening on " + server.address());
  print_line("Open this address in a browser on this machine; Ctrl-C ends.");
  if (!flush_output()) return wrong_input;  // main says why
  std::optional<viewer::OpenedBrowser> browser;
  if (!options.has_no_browser) browser.emplace(server.address());
  wait_for_interrupt();
  return done;
}

int view_results(const ViewOptions& options) {
  if (!options.overrides.empty()) {
    throw InputError("--set", "a scene to change", "the folder of results " + options.shown);
  }
  const viewer::PageServer server(server_options(options), viewer::recorded_resources(options.shown),
                                  nullptr);
  return serve(server, options);
}

/// Whether the name is that of a mesh, which a scene could name.
bool is_mesh(const std::filesystem::path& path) {
  const std::string extension = MeshSource{.name = path.string(), .bytes = {}, .companion = {}}.extension();
  return std::ranges::any_of(mesh_formats(), [&](const MeshFormat& format) {
    return std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
}

int view_scene(const ViewOptions& options) {
  if (options.threads > 0) set_num_threads(options.threads);
  const bool is_bare_mesh = is_mesh(options.shown);
  const viewer::SceneSource source = is_bare_mesh ? viewer::mesh_file(options.shown, options.overrides)
                                                  : viewer::scene_file(options.shown, options.overrides);
  std::unique_ptr<viewer::ServedLiveScene> scene = viewer::served_scene(source);
  if (is_bare_mesh)
    print_line(one_line(options.shown) +
               " is a mesh without a scene: it is shown soft (Young's modulus 100 kPa), weightless and free; "
               "click on faces (key 4) to fix it, and save it as a scene on the page");
  print_warnings(scene->warnings());
  Offset cells = 0;
  for (const Body& body : scene->world().bodies) cells += body.num_cells();
  const std::string title = scene->world().title;
  print_line(one_line(title.empty() ? options.shown : title) + ": " + std::to_string(cells) +
             (cells == 1 ? " cell, " : " cells, ") + std::to_string(scene->num_vertices()) +
             " vertices drawn, " + std::to_string(num_threads()) +
             (num_threads() == 1 ? " thread" : " threads"));
  const viewer::OpenFile open = [](const std::string& name, std::string bytes) {
    return viewer::served_scene(
        viewer::sent_mesh({viewer::harmless_name(name), std::move(bytes)}, std::filesystem::current_path()));
  };
  const viewer::LiveServer live(std::move(scene), server_options(options), open);
  return serve(live.server(), options);
}

int view(const ViewOptions& options) {
  return std::filesystem::is_directory(options.shown) ? view_results(options) : view_scene(options);
}

}  // namespace

void add_view(CommandLine& line, Action& action) {
  auto options = std::make_shared<ViewOptions>();
  const Command command =
      line.command("view", "Interactive viewer in the browser: a live scene, or the results of a run");
  command
      .option("shown", options->shown,
              "Scene file (TOML), a mesh, a surface (STL, PLY, OBJ, VTP, glTF), or folder of a run with "
              "formats = "
              "[\"html\"]")
      .required()
      .type_name("SCENE.toml|MESH|DIR")
      .is_file_or_folder(scene_and_mesh_extensions());
  command.option("--port", options->port, "Port on 127.0.0.1; default 0, any free one").between(0, 65535);
  command
      .option("--address-file", options->address_file,
              "Keep the address in this file: after a restart open pages find the program again")
      .type_name("FILE");
  command.option("--set", options->overrides, "Change a value of the scene; repeatable")
      .type_name("KEY=VALUE")
      .repeatable()
      .offers(scene_settings);
  command.option("--threads", options->threads, "Number of threads; default RESILIN_THREADS or all cores")
      .between(1, max_threads);
  command.flag("--no-browser", options->has_no_browser, "Print the address and open nothing");
  command.footer(
      "Examples:\n  resilin view examples/heap.toml\n  resilin view out/spot --port 8000 --no-browser\n\nThe "
      "page is "
      "for this machine alone. Its address holds a token that is new at every start: whoever\nhas it "
      "can play "
      "with the scene. Through ssh: ssh -L 8000:127.0.0.1:8000 HOST, then the address on your own "
      "machine.\nCtrl-C "
      "ends.");
  command.on_chosen([options, &action] { action = [options] { return view(*options); }; });
}

}  // namespace resilin::cli
