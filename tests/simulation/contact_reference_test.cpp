// Contact against codes that are not ours (tests/reference).

#include <gtest/gtest.h>

#include "reference_case.hpp"

namespace resilin::testing {
namespace {

/// The mirror image in y = `at`, turned right side out again.
Mesh mirrored(Mesh mesh, double at) {
  for (Vector3& vertex : mesh.vertices) vertex.y() = 2 * at - vertex.y();
  for (CellBlock& block : mesh.blocks) {
    if (block.kind != CellKind::triangle) continue;
    for (Index cell = 0; cell < block.num_cells(); ++cell)
      std::swap(block.nodes[static_cast<std::size_t>(3 * cell + 1)],
                block.nodes[static_cast<std::size_t>(3 * cell + 2)]);
  }
  return mesh;
}

void press_down(Description& scene, const std::string& body, double way) {
  FixDescription symmetry = fix("symmetry of " + body, plane(0, 0));
  symmetry.body = body;
  symmetry.components = {true, false, false};
  FixDescription top = fix("top of " + body, group("top"));
  top.body = body;
  top.displacement = {0, -way, 0};
  scene.fixes.push_back(symmetry);
  scene.fixes.push_back(top);
}

/// A half disc of radius 1 on a rigid line, or on its mirror image.
Description pressed_disc(const nlohmann::json& reference, double depth, double distance, bool is_on_itself) {
  const ReferenceLaw law = reference_law_from_young("nh_log", 1, 0.3);
  Description scene = one_body(2, reference_mesh(reference["geometry_file"]), law);
  scene.load_steps = 4;
  scene.newton.tolerance = 1e-9;  // vertices upon vertices: forces have kinks there
  scene.bodies[0].name = "disc";
  press_down(scene, "disc", depth);
  if (is_on_itself) {
    scene.bodies.push_back(scene.bodies[0]);
    scene.bodies[1].name = "image";
    scene.bodies[1].mesh = mirrored(scene.bodies[0].mesh, -0.25 * distance);
    press_down(scene, "image", -depth);
    scene.contact.activation_distance = distance;
    scene.contact.stiffness = 0.1;  // as the line's
  } else {
    ColliderDescription line;
    line.name = "line";
    line.shape.normal = {0, 1, 0};
    line.shape.point = {0, -0.5 * distance, 0};
    line.activation_distance = distance;
    scene.colliders.push_back(line);
  }
  return scene;
}

double force_on(const Simulation& simulation, const std::string& name) {
  for (const auto& [support, force] : simulation.frame().reactions)
    if (support == name) return force.y();
  ADD_FAILURE() << name;
  return 0;
}

/// The hard limit of both is that of a body on a frictionless line; the error falls with the distance.
TEST(ContactReference, ADiscOnALineAndOnItsImage) {
  nlohmann::json reference = read_reference("contact_disc_plane_2d");
  reference["geometry_file"] = "meshes/quarter_disc.msh";
  for (const auto& [distance, tolerance] : {std::pair{1e-3, 4e-3}, {1e-4, 4e-4}, {1e-5, 4e-5}})
    for (const auto& row : reference["values"]["BackNG"])
      for (const bool is_on_itself : {false, true}) {
        const double depth = row["delta"], expected = row["force"];
        Simulation simulation(pressed_disc(reference, depth, distance, is_on_itself));
        run_to_end(simulation);
        const double force = -force_on(simulation, "top of disc");
        if (is_on_itself) {
          EXPECT_NEAR(force_on(simulation, "top of image"), force, 1e-9 * force) << depth;
        }
        if (depth >= 0.05) {
          EXPECT_NEAR(force, expected, tolerance * expected) << distance << " " << depth;
        }
      }
}

}  // namespace
}  // namespace resilin::testing
