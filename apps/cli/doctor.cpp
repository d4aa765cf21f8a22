#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "command.hpp"
#include "ffmpeg.hpp"
#include "interrupt.hpp"
#include "mesher.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/run.hpp"
#include "resilin/scene/scene.hpp"
#include "run_together.hpp"
#include "subprocess.hpp"
#include "temporary_place.hpp"
#include "terminal.hpp"
#include "viewer/browser.hpp"

namespace resilin::cli {
namespace {

constexpr double look_seconds = 60;  ///< how long another program may take to say what it is

/// Result of one check. Without `cure` all is well.
struct Finding {
  std::string name, found, cure;
  bool is_needed = false;  ///< nothing works without it
};

bool is_well(const Finding& finding) { return finding.cure.empty(); }

// ---- what everything needs

/// A bar of unit section, drawn to twice its length: with nu = 0 its sides stay, and P = E/2 (2 - 1/2).
constexpr const char* bar_scene = R"(
[simulation]
kind = "static"
[[body]]
mesh = { box = { size = [2, 1, 1], cells = [2, 1, 1] } }
element = "P2"
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0 }
[[fix]]
where = { group = "x_min" }
[[fix]]
name = "pull"
where = { group = "x_max" }
displacement = [2, 0, 0]
)";

Finding look_at_core() {
  constexpr double force = 7.5e5;  // [N]
  constexpr double tolerance = 1e-6;
  Simulation simulation(read_scene_from_text(bar_scene, "bar", {}).description);
  const RunOutcome outcome = run_to_end(simulation, {});
  const auto& reactions = simulation.frame().reactions;
  const auto pull = std::ranges::find(reactions, "pull", [](const auto& reaction) { return reaction.first; });
  const double error = pull == reactions.end() ? HUGE_VAL : std::abs(pull->second.x() / force - 1);
  Finding finding = {.name = "computing",
                     .found = "a bar stretched to twice its length has the force of the closed form, to " +
                              format_short(error),
                     .cure = "",
                     .is_needed = true};
  if (outcome.status == RunStatus::done && error < tolerance) return finding;
  finding.found = "a bar stretched to twice its length differs from the closed form by " +
                  format_short(error) + ", " + outcome.reason;
  finding.cure =
      "RESILIN_ISA=baseline tells whether the processor's instructions are at fault; otherwise rebuild";
  return finding;
}

Finding look_at_instruction_set() {
  return {.name = "instruction set",
          .found = std::string(name(preferred_instruction_set())) + ", of " +
                   join(names(available_instruction_sets())),
          .cure = "",
          .is_needed = true};
}

Finding look_at_memory() {
  constexpr double least = 1e9;  // [bytes]; some 20,000 quadratic tetrahedra
  const MemoryRoom room = memory_room();
  Finding finding = {
      .name = "memory", .found = std::isinf(room.bytes) ? "no limit" : words(room), .cure = ""};
  if (room.bytes < least)
    finding.cure = "enough for small scenes only: end other programs, or raise the limit";
  return finding;
}

Finding look_at_folder() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::current_path(error);
  Finding finding = {
      .name = "results", .found = "can be written into " + one_line(folder.string()), .cure = ""};
  if (!error && access(folder.c_str(), W_OK) == 0) return finding;
  finding.found = one_line(folder.string()) + " cannot be written into";
  finding.cure = "change to another folder, or use --out";
  return finding;
}

// ---- what single commands need

/// The first word of a command is a program on PATH, or a path.
bool is_program(const std::string& command) {
  const std::string program = command.substr(0, command.find(' '));
  if (program.find('/') != program.npos) return access(program.c_str(), X_OK) == 0;
  return find_program(program).has_value();
}

Finding look_at_browser() {
  const std::string command = viewer::browser_command();
  Finding finding = {.name = "browser", .found = "view opens its page by " + one_line(command), .cure = ""};
  if (!viewer::has_display()) {
    finding.found = "view opens no page: there is no display (DISPLAY, WAYLAND_DISPLAY)";
    finding.cure =
        "open the address that it prints; from another machine with ssh -L PORT:127.0.0.1:PORT and view "
        "--port PORT. picture and film need no display";
  } else if (!is_program(command)) {
    finding.found = "view opens no page: " + one_line(command) + " is not there";
    finding.cure = "apt-get install xdg-utils chromium, or set BROWSER, or open the address that it prints";
  }
  return finding;
}

/// All that a program writes; none when it fails.
std::optional<std::string> output_of(const std::filesystem::path& program,
                                     const std::vector<std::string>& arguments,
                                     const std::filesystem::path& folder) {
  const Subprocess run = run_subprocess(program, arguments, folder, look_seconds);
  if (run.end == Subprocess::End::interrupted) throw Interrupted();
  if (run.end != Subprocess::End::exited || run.exit_code != 0) return std::nullopt;
  std::ifstream file(folder / "log.txt");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool has_word(const std::string& text, std::string_view word) {
  std::istringstream words(text);
  for (std::string one; words >> one;)
    if (one == word) return true;
  return false;
}

Finding look_at_ffmpeg(const std::filesystem::path& folder) {
  Finding finding = {.name = "ffmpeg", .found = "", .cure = ""};
  std::vector<std::string> able, unable;
  const auto program = find_program("ffmpeg");
  const std::string place = program ? one_line(program->string()) : "";
  const auto listed = program ? output_of(*program, {"-hide_banner", "-encoders"}, folder) : std::nullopt;
  for (const auto& [extension, encoder] : encodings)
    (listed && has_word(*listed, encoder) ? able : unable).emplace_back(extension);
  if (unable.empty()) {
    finding.found = "film writes " + join(able) + " by " + place;
    return finding;
  }
  finding.found = "film cannot write " + join(unable) + ": " +
                  (!program  ? "there is no ffmpeg"
                   : !listed ? place + " does not run"
                             : place + " has no encoder for that");
  finding.cure = std::string(how_to_install_ffmpeg) + "; animated PNG and single pictures need none";
  return finding;
}

Finding look_at_mesher(const Mesher& mesher, const std::filesystem::path& folder) {
  const auto program = mesher.find(folder);
  if (is_interrupted()) throw Interrupted();
  if (program)
    return {
        .name = mesher.name, .found = "mesh --mesher " + mesher.name + " fills surfaces by it", .cure = ""};
  return {.name = mesher.name,
          .found = "mesh --mesher " + mesher.name + " cannot fill surfaces by it",
          .cure = mesher.how_to_install + "; the built-in meshers fill surfaces without it"};
}

Finding look_at_petsc() {
  Finding finding = {.name = "PETSc", .found = distribution_text(), .cure = ""};
  const std::vector<std::string> solvers = linear_solver_names();
  const bool has_petsc = std::ranges::any_of(
      solvers, [](const std::string& solver) { return solver.find("petsc") != solver.npos; });
  if (!has_petsc) {
    finding.found = "one scene runs on one MPI process only: this build has no PETSc";
    finding.cure =
        "apt-get install libpetsc-real-dev openmpi-bin pkg-config, and cmake --preset petsc (docs/scale.md)";
  } else if (!find_program("mpirun")) {
    finding.found = "one scene runs on one MPI process only: there is no mpirun";
    finding.cure = "apt-get install openmpi-bin";
  }
  return finding;
}

/// The clone that this program was built in.
std::optional<std::filesystem::path> clone_of_this_program() {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (; folder.has_relative_path(); folder = folder.parent_path())
    if (std::filesystem::is_regular_file(folder / "scripts/build_site.sh", error)) return folder;
  return std::nullopt;
}

/// Tool that a part of the site needs.
struct SitePart {
  const char *part, *tool, *how_to_get;
};

constexpr std::array<SitePart, 3> site_parts = {
    {{"pages", "build/site/venv/bin/python", "scripts/build_site.sh fetches Sphinx"},
     {"what notebooks print", "build/python/venv/bin/python", "./test python fetches what runs them"},
     {"scenes to play with", "build/wasm/apps/play/resilin_play.wasm", "scripts/build_wasm.sh"}}};

Finding look_at_site(const std::filesystem::path& clone) {
  std::vector<std::string> lacks, cures;
  std::error_code error;
  for (const auto& [part, tool, how_to_get] : site_parts)
    if (!std::filesystem::exists(clone / tool, error)) {
      lacks.emplace_back(part);
      cures.emplace_back(how_to_get);
    }
  if (!find_program("ffmpeg")) {
    lacks.emplace_back("films");
    cures.emplace_back(how_to_install_ffmpeg);
  }
  if (lacks.empty()) return {.name = "site", .found = "scripts/build_site.sh makes all of it", .cure = ""};
  return {
      .name = "site", .found = "scripts/build_site.sh lacks what makes " + join(lacks), .cure = join(cures)};
}

// ---- Python

/// A package that parts of ours work with.
struct PythonPackage {
  const char *name, *use, *how_to_install;
};

constexpr std::array<PythonPackage, 9> python_packages = {{
    {"torch", "tensors and autograd", "pip install 'resilin[torch]'"},
    {"jax", "differentiable simulations in JAX", "pip install 'resilin[jax]'"},
    {"matplotlib", "plots of curves and fits", "pip install 'resilin[plot]'"},
    {"pandas", "Result.to_dataframe", "pip install 'resilin[pandas]'"},
    {"pyvista", "Result.to_pyvista", "pip install 'resilin[pyvista]'"},
    {"meshio", "Result.to_meshio, Mesh.from_meshio", "pip install 'resilin[meshio]'"},
    {"anywidget", "view() in notebooks", "pip install 'resilin[notebook]'"},
    {"pyarrow", "tables of sweeps as Parquet", "pip install 'resilin[parquet]'"},
    {"distributed", "sweeps on a Dask cluster", "pip install 'resilin[sweep]'"},
}};

/// Prints which of the packages named are there, without loading them, then the version of ours, which is
/// loaded.
constexpr const char* python_script = R"(import importlib.util, sys
for name in sys.argv[1:]:
    if importlib.util.find_spec(name):
        print("package", name)
import resilin
print("version", resilin.__version__)
)";

std::vector<Finding> look_at_python(const std::filesystem::path& folder) {
  Finding finding = {
      .name = "Python", .found = "", .cure = "pip install . in the clone, or scripts/build_wheel.sh"};
  const auto python = find_program("python3");
  if (!python) {
    finding.found = "import resilin is not possible: there is no python3";
    finding.cure = "apt-get install python3 python3-venv, then in an environment " + finding.cure;
    return {finding};
  }
  std::vector<std::string> arguments = {"-c", python_script};
  for (const PythonPackage& package : python_packages) arguments.emplace_back(package.name);
  const Subprocess run = run_subprocess(*python, arguments, folder, look_seconds);
  if (run.end == Subprocess::End::interrupted) throw Interrupted();
  const std::string ours = "version " + std::string(version());
  if (run.end != Subprocess::End::exited || run.exit_code != 0) {
    finding.found = one_line(python->string()) + " cannot import resilin: " + one_line(run.log_end);
    return {finding};
  }
  if (run.log_end != ours) {
    finding.found = one_line(python->string()) + " imports resilin of another " + one_line(run.log_end) +
                    "; this program is " + ours;
    return {finding};
  }
  finding.found = one_line(python->string()) + " imports resilin";
  finding.cure = "";
  std::vector<Finding> findings = {finding};
  std::ifstream log(folder / "log.txt");
  std::vector<std::string> lines;
  for (std::string line; std::getline(log, line);) lines.push_back(line);
  for (const PythonPackage& package : python_packages) {
    const bool is_there = std::ranges::find(lines, std::string("package ") + package.name) != lines.end();
    findings.push_back({.name = package.name,
                        .found = std::string(is_there ? "is there: " : "is not there: ") + package.use,
                        .cure = is_there ? "" : package.how_to_install});
  }
  return findings;
}

// ---- the report

std::vector<Finding> look_at_everything() {
  const TemporaryPlace place("resilin-doctor");
  std::vector<Finding> findings = {
      look_at_core(),
      look_at_instruction_set(),
      {.name = "threads",
       .found = std::to_string(num_threads()) + "; RESILIN_THREADS and --threads change that",
       .cure = ""},
      look_at_memory(),
      look_at_folder(),
      look_at_browser(),
      look_at_ffmpeg(place.path())};
  for (const Mesher& mesher : meshers()) findings.push_back(look_at_mesher(mesher, place.path()));
  findings.push_back(look_at_petsc());
  if (const auto clone = clone_of_this_program()) findings.push_back(look_at_site(*clone));
  for (Finding& finding : look_at_python(place.path())) findings.push_back(std::move(finding));
  return findings;
}

void print_findings(const std::vector<Finding>& findings) {
  std::vector<std::vector<std::string>> rows;
  for (const Finding& finding : findings)
    rows.push_back({is_well(finding) ? "ok" : "--", finding.name,
                    finding.found + (is_well(finding) ? "" : ". Cure: " + finding.cure)});
  print_text(format_table(rows));
}

std::string verdict(const std::vector<Finding>& findings) {
  const auto count = std::ranges::count_if(findings, [](const Finding& f) { return !is_well(f); });
  if (count == 0) return "Nothing is missing.";
  return "Resilin works; lines with -- name missing features and how to get them.";
}

int doctor(bool as_json) {
  catch_interrupts();
  const std::vector<Finding> findings = look_at_everything();
  const auto broken = std::ranges::find_if(
      findings, [](const Finding& finding) { return finding.is_needed && !is_well(finding); });
  if (as_json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Finding& finding : findings)
      list.push_back({{"name", finding.name},
                      {"ok", is_well(finding)},
                      {"needed", finding.is_needed},
                      {"found", finding.found},
                      {"cure", finding.cure}});
    print_line(list.dump(1));
  } else {
    print_findings(findings);
  }
  if (broken != findings.end()) {
    print_error(broken->name + ": " + broken->found + "; " + broken->cure);
    return wrong_input;
  }
  if (!as_json) print_line("\n" + verdict(findings));
  return done;
}

}  // namespace

void add_doctor(CommandLine& line, Action& action) {
  auto as_json = std::make_shared<bool>(false);
  const Command command =
      line.command("doctor", "Check the installation: what works, what is missing and how to get it");
  command.flag("--json", *as_json, "Print JSON");
  command.footer(
      "Example:\n  resilin doctor\n\nExit codes: 0 scenes can be simulated, whatever else is missing; 1 they "
      "cannot.");
  command.on_chosen([as_json, &action] { action = [as_json] { return doctor(*as_json); }; });
}

}  // namespace resilin::cli
