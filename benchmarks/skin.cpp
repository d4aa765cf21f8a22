#include "skin.hpp"

#include <algorithm>
#include <filesystem>

#include "clock.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/view/frame_codec.hpp"
#include "resilin/view/surface_fields.hpp"
#include "scenes.hpp"

namespace resilin::bench {
namespace {

template <class Action>
double median_milliseconds(int num_calls, const Action& action) {
  return 1e3 * median_wall_seconds(num_calls, action);
}

/// The boundary of a cube of n^3 cubes, pushed out to a ball that the unit cube contains.
Mesh make_ball(int n) {
  Mesh ball = extract_surface(make_box({2, 2, 2}, {n, n, n}, {-1, -1, -1})).mesh;
  for (Vector3& X : ball.vertices) X = (Vector3::Constant(0.5) + 0.45 * X.normalized()).eval();
  return ball;
}

Description body_with_skin(Mesh mesh, Mesh surface) {
  Description scene;
  scene.is_dynamic = true;
  BodyDescription body;
  body.element = "P1";
  body.mesh = std::move(mesh);
  body.skin = SkinDescription{.surface = std::move(surface), .surface_name = "skin"};
  scene.bodies.push_back(std::move(body));
  return scene;
}

/// Bent and stretched a little, so that nothing is zero.
State deformed(const World& world) {
  State state;
  state.positions = world.rest_positions;
  state.velocities = VectorX::Zero(state.positions.size());
  for (Index node = 0; node < world.num_nodes(); ++node) {
    auto x = state.positions.segment<3>(Eigen::Index{3} * node);
    x += 0.1 * Vector3(x.y() * x.z(), x.x() * x.x(), -x.x() * x.y());
  }
  return state;
}

SkinTiming measure(const std::string& name, Mesh mesh, Mesh surface) {
  constexpr int frames = 200, builds = 5;
  const World world(body_with_skin(std::move(mesh), std::move(surface)));
  const Body& body = world.bodies[0];
  const Skin& skin = *body.skin;
  const ElementInfo& element = body.domains.element();
  std::vector<Vector3> points;
  for (Eigen::Index i = 0; i < skin.rest_positions.size(); i += 3)
    points.emplace_back(skin.rest_positions.segment<3>(i));

  SkinTiming timing{.name = name, .cells = body.num_cells(), .vertices = skin.num_vertices()};
  timing.outside_percent = 100.0 * skin.embedding.outside().count / skin.num_vertices();
  timing.build_ms = median_milliseconds(
      builds, [&] { const Embedding again(element, body.cells, world.rest_positions, points); });
  const Embedding smooth(element, body.cells, world.rest_positions, points, true);
  const State state = deformed(world);
  std::vector<float> places(3 * points.size());
  timing.smooth_apply_ms = median_milliseconds(frames, [&] { smooth.apply(state.positions, places); });
  timing.apply_ms = median_milliseconds(frames, [&] { skin.embedding.apply(state.positions, places); });

  const ShownSurface surface_shown(world);
  SurfaceFields fields(world, surface_shown);
  const auto count = static_cast<std::size_t>(surface_shown.num_vertices());
  std::vector<float> positions(3 * count), normals(3 * count), field(count);
  surface_shown.positions(state.positions, positions);
  timing.normals_ms = median_milliseconds(frames, [&] { surface_shown.normals(positions, normals); });
  timing.field_ms =
      median_milliseconds(frames / 4, [&] { fields.evaluate(world, state, "averaged_von_mises", field); });
  std::string bytes;
  timing.encode_ms = median_milliseconds(
      frames, [&] { encode_frame({.positions = positions, .normals = normals, .field = field}, bytes); });
  return timing;
}

}  // namespace

std::vector<SkinTiming> measure_skins(int n) {
  constexpr int ball_cells = 66;  // along an edge: 26,138 vertices
  std::vector<SkinTiming> timings = {measure(
      "ball", make_box({1, 1, 1}, {n, n, n}, Vector3::Zero(), TetPattern::five), make_ball(ball_cells))};
  const std::filesystem::path cells = shared_mesh("armadillo_coarse.node"),
                              surface = shared_mesh("armadillo_skin.obj");
  if (std::filesystem::exists(cells) && std::filesystem::exists(surface))
    timings.push_back(measure("armadillo", read_solid_mesh(cells, 3).mesh, read_mesh(surface).mesh));
  return timings;
}

}  // namespace resilin::bench
