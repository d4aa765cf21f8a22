#include "live.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "clock.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/view/shown_surface.hpp"

namespace resilin::bench {
namespace {

constexpr int steps_per_phase = 60;  ///< steps per phase of pulling, and again of swinging back

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double percentile_95(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() * 95 / 100];
}

/// The free vertex farthest from all fixed ones; without such, from the middle.
Index farthest_node(const World& world) {
  const auto place = [&world](Index node) {
    return node_position(world.dimension, node, world.rest_positions);
  };
  std::vector<Index> fixed;
  Vector3 middle = Vector3::Zero();
  for (Index node = 0; node < world.num_nodes(); ++node) {
    middle += place(node) / world.num_nodes();
    if (world.is_fixed[static_cast<std::size_t>(node * world.dimension)] != 0) fixed.push_back(node);
  }
  Index farthest = 0;
  double largest = -1;
  for (Index node = 0; node < world.num_nodes(); ++node) {
    double nearest = fixed.empty() ? (place(node) - middle).norm() : std::numeric_limits<double>::infinity();
    for (const Index other : fixed) nearest = std::min(nearest, (place(node) - place(other)).norm());
    if (nearest <= largest) continue;
    largest = nearest;
    farthest = node;
  }
  return farthest;
}

/// Where the hand is in step i of the first phase: once around a circle of a fifth of the extent.
Vector3 hand(const World& world, const Vector3& start, int i) {
  const double angle = 2 * std::numbers::pi * i / steps_per_phase;
  const double radius = 0.2 * world.largest_extent();
  Vector3 offset = radius * Vector3(std::sin(angle), 0.5 * std::sin(angle), 1 - std::cos(angle));
  if (world.dimension == 2) offset.z() = 0;
  return start + offset;
}

}  // namespace

LiveTiming measure_live(const LiveCase& live_case) {
  LiveScene scene(live_case.description), exact(live_case.description);
  LiveControls controls = scene.controls();
  controls.tolerance = live_case.tolerance;
  controls.newton_limit = live_case.newton_limit;
  scene.set_controls(controls);
  controls.newton_limit = 0;
  controls.tolerance = 1e-9;
  exact.set_controls(controls);
  const World& world = scene.world();
  const Index node = farthest_node(world);
  const Vector3 start = node_position(world.dimension, node, world.rest_positions);

  // Each step includes the data that the page draws: positions and normals of the surface, skins included.
  const ShownSurface surface(world);
  std::vector<float> positions(3 * static_cast<std::size_t>(surface.num_vertices())),
      normals(positions.size());

  LiveTiming timing;
  timing.vertices = world.num_nodes();
  timing.drawn = surface.num_vertices();
  for (const Body& body : world.bodies) timing.cells += body.num_cells();
  std::vector<double> wall, drawing, residuals, errors;
  const MaterialPoint place{.nodes = {node}, .weights = {1}};
  scene.grab(place, start);
  exact.grab(place, start);
  for (int i = 0; i < 2 * steps_per_phase; ++i) {
    if (i < steps_per_phase) {
      scene.drag(hand(world, start, i));
      exact.drag(hand(world, start, i));
    } else if (i == steps_per_phase) {
      scene.release();
      exact.release();
    }
    exact.place(scene.state().positions, scene.state().velocities);
    exact.step({.seconds = 60});
    const double cpu = cpu_seconds(), begin = wall_seconds();
    const LiveReport& report = scene.step({.seconds = 60});
    const double stepped = wall_seconds();
    surface.positions(scene.state().positions, positions);
    surface.normals(positions, normals);
    wall.push_back(1e3 * (wall_seconds() - begin));
    drawing.push_back(1e3 * (wall_seconds() - stepped));
    timing.cpu_ms += 1e3 * (cpu_seconds() - cpu) / (2 * steps_per_phase);
    timing.newton += static_cast<double>(report.newton_iterations) / (2 * steps_per_phase);
    timing.linear += static_cast<double>(report.linear_iterations) / (2 * steps_per_phase);
    timing.inverted += report.inverted_cells > 0 ? 1 : 0;
    residuals.push_back(report.relative_residual);
    const VectorX& solved = exact.state().positions;
    const double moved = (solved - world.rest_positions).norm();
    if (moved > 0) errors.push_back((scene.state().positions - solved).norm() / moved);
  }
  timing.median_ms = median(wall);
  timing.drawing_ms = median(drawing);
  timing.p95_ms = percentile_95(wall);
  timing.largest_ms = std::ranges::max(wall);
  timing.residual = median(residuals);
  timing.worst_residual = std::ranges::max(residuals);
  timing.error = median(errors);
  timing.worst_error = std::ranges::max(errors);
  return timing;
}

namespace {

/// A cube of 0.4 m on a held face, soft enough to sway.
Description live_cube(int n) {
  Description scene = cube(n);
  scene.newton = {};
  return scene;
}

Description live_spot(const std::filesystem::path& mesh) {
  Description scene;
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.gravity = {0, -9.81, 0};
  BodyDescription body;
  body.element = "P1";
  body.mesh = read_solid_mesh(mesh, 3).mesh;
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.4}};
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector3& X : body.mesh.vertices) lowest = std::min(lowest, X.y());
  scene.bodies.push_back(std::move(body));
  FixDescription feet;
  feet.where.kind = Where::Kind::plane;
  feet.where.axis = 1;
  feet.where.at = lowest;
  feet.where.tolerance = 0.05;
  scene.fixes.push_back(feet);
  return scene;
}

}  // namespace

std::vector<LiveCase> live_cases() {
  std::vector<LiveCase> cases;
  if (const std::filesystem::path armadillo = shared_mesh("armadillo_coarse.node"); exists(armadillo)) {
    Description scene = seed001(armadillo);
    scene.loads.clear();
    SkinDescription skin;
    skin.surface = read_mesh(shared_mesh("armadillo_skin.obj")).mesh;
    scene.bodies.front().skin = skin;
    cases.push_back({.name = "armadillo with skin, 627 cells, solved", .description = std::move(scene)});
  }
  const auto add = [&cases](const std::string& name, const Description& scene) {
    cases.push_back({.name = name + ", solved", .description = scene});
    cases.push_back({.name = name + ", to 1 %", .description = scene, .tolerance = 1e-2});
    cases.push_back({.name = name + ", one iteration", .description = scene, .newton_limit = 1});
  };
  add("cube, 5,000 cells", live_cube(10));
  add("cube, 20,480 cells", live_cube(16));
  if (const std::filesystem::path spot = "data/spot_coarse.msh"; exists(spot))
    add("Spot, coarse", live_spot(spot));
  return cases;
}

std::vector<Measurement> measure_view() {
  std::vector<Measurement> measurements;
  for (const LiveCase& live_case : live_cases()) {
    const LiveTiming t = measure_live(live_case);
    const auto add = [&](const std::string& what, double value) {
      measurements.emplace_back(live_case.name + ": " + what, value);
    };
    add("cells", t.cells);
    add("drawn vertices", t.drawn);
    add("median ms", t.median_ms);
    add("of it positions and normals of the surface, ms", t.drawing_ms);
    add("95 % of steps, ms", t.p95_ms);
    add("mean processor ms", t.cpu_ms);
    add("Newton iterations", t.newton);
    add("linear iterations", t.linear);
    add("residual, share of the load", t.residual);
    add("largest residual", t.worst_residual);
    add("distance to the solved step, share of the displacement", t.error);
    add("largest distance", t.worst_error);
    add("steps with inverted cells", t.inverted);
  }
  return measurements;
}

}  // namespace resilin::bench
