#include "heap.hpp"

#include <algorithm>

#include "clock.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/view/shown_surface.hpp"

namespace resilin::bench {
namespace {

constexpr double simulated_seconds = 3;
constexpr double frame_seconds = 1.0 / 60;

double share(std::vector<double> sorted, double part) {
  std::ranges::sort(sorted);
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

std::vector<Measurement> measure_heap() {
  LiveScene scene(read_scene("examples/heap.toml").description);
  const World& world = scene.world();
  const ShownSurface surface(world);
  std::vector<float> positions(3 * static_cast<std::size_t>(surface.num_vertices())),
      normals(positions.size());
  std::vector<double> wall, residuals;
  double newton = 0, linear = 0, assembly = 0, solve = 0, inverted = 0;
  const auto num_steps = static_cast<int>(simulated_seconds / scene.controls().time_step);
  for (int i = 0; i < num_steps; ++i) {
    const double begin = wall_seconds();
    const LiveReport& report = scene.step();
    surface.positions(scene.state().positions, positions);
    surface.normals(positions, normals);
    wall.push_back(1e3 * (wall_seconds() - begin));
    residuals.push_back(report.relative_residual);
    newton += report.newton_iterations;
    linear += report.linear_iterations;
    assembly += report.assembly_ms;
    solve += report.solve_ms;
    inverted += report.inverted_cells > 0 ? 1 : 0;
  }
  const auto in_time = std::ranges::count_if(wall, [](double ms) { return ms <= 1e3 * frame_seconds; });
  Index cells = 0;
  for (const Body& body : world.bodies) cells += body.num_cells();
  const SurfaceContact::Timing& contact = world.contact->timing();
  return {{"cells", cells},
          {"drawn vertices", surface.num_vertices()},
          {"median ms", share(wall, 0.5)},
          {"95 % of steps, ms", share(wall, 0.95)},
          {"largest ms", share(wall, 1)},
          {"share of steps in the time of a frame", static_cast<double>(in_time) / num_steps},
          {"Newton iterations", newton / num_steps},
          {"linear iterations", linear / num_steps},
          {"assembly, mean ms", assembly / num_steps},
          {"solve, mean ms", solve / num_steps},
          {"search for pairs, mean ms", 1e3 * contact.search / num_steps},
          {"largest steps, mean ms", 1e3 * contact.detection / num_steps},
          {"barrier, mean ms", 1e3 * contact.barrier / num_steps},
          {"residual, share of the load", share(residuals, 0.5)},
          {"95 % of residuals", share(residuals, 0.95)},
          {"steps with inverted cells", inverted}};
}

}  // namespace resilin::bench
