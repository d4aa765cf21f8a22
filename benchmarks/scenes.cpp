#include "scenes.hpp"

#include <cmath>
#include <cstdlib>

#include "resilin/core/error.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/generators.hpp"

namespace resilin::bench {
namespace {

FixDescription clamp(const std::string& name, int axis, double at, double tolerance) {
  FixDescription fix;
  fix.name = name;
  fix.where.kind = Where::Kind::plane;
  fix.where.axis = axis;
  fix.where.at = at;
  fix.where.tolerance = tolerance;
  return fix;
}

ProbeDescription probe(const std::string& name, const Vector3& at) {
  ProbeDescription description;
  description.name = name;
  description.at = at;
  return description;
}

}  // namespace

Description bar(int n, bool is_dynamic, const std::string& element) {
  Description scene;
  scene.title = "bar";
  scene.is_dynamic = is_dynamic;
  scene.time_step = 0.01;
  scene.end_time = 0.5;
  scene.newton.tolerance = 1e-8;
  BodyDescription body;
  body.name = "bar";
  body.mesh = make_box({4, 1, 1}, {4 * n, n, n});
  body.element = element;
  body.material.law = "neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", element == "P1" ? 0.4 : 0.49}};
  body.material.density = 1000;
  body.mass = MassKind::consistent;
  scene.bodies.push_back(std::move(body));
  scene.fixes.push_back(clamp("wall", 0, 0, 1e-9));
  LoadDescription load;
  load.kind = "body_force";
  load.value = {0, 0, is_dynamic ? -9810.0 : -3000.0};
  scene.loads.push_back(load);
  scene.probes.push_back(probe("tip", {4, 0, 0}));
  return scene;
}

Description cube(int n) {
  Description scene;
  scene.title = "cube";
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.end_time = 1;
  scene.gravity = {0, 0, -9.81};
  scene.newton.tolerance = 1e-6;
  BodyDescription body;
  body.name = "cube";
  body.element = "P1";
  body.mesh = make_box({0.4, 0.4, 0.4}, {n, n, n}, Vector3::Zero(), TetPattern::five);
  body.material.law = "stable_neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.4}};
  body.material.density = 1000;
  scene.bodies.push_back(std::move(body));
  scene.fixes.push_back(clamp("wall", 0, 0, 1e-9));
  return scene;
}

Description dropped_cube(int n) {
  Description scene = cube(n);
  scene.title = "dropped cube";
  scene.fixes.clear();
  scene.bodies[0].translate = {0, 0, 0.05};
  ColliderDescription ground;
  ground.name = "ground";
  ground.kind = "half_space";
  ground.shape.normal = {0, 0, 1};
  scene.colliders.push_back(ground);
  return scene;
}

Description two_cubes(int n, bool is_aligned) {
  Description scene = dropped_cube(n);
  scene.title = "two cubes";
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[0].name = "lower";
  scene.bodies[0].translate = {0, 0, 0.002};
  scene.bodies[1].name = "upper";
  scene.bodies[1].translate = {is_aligned ? 0 : 0.05, is_aligned ? 0 : 0.03, 0.452};
  return scene;
}

Description with_friction(double coefficient, Description scene) {
  scene.contact.friction = coefficient;
  for (ColliderDescription& collider : scene.colliders) collider.friction = coefficient;
  return scene;
}

Description seed001(const std::filesystem::path& mesh) {
  Description scene;
  scene.title = "seed 001";
  scene.is_dynamic = true;
  scene.time_step = 0.01;
  scene.end_time = 2;
  scene.newton.tolerance = 1e-4;
  BodyDescription body;
  body.name = "armadillo";
  body.element = "P1";
  body.mesh = read_solid_mesh(mesh, 3).mesh;
  body.material.law = "stable_neo_hookean";
  body.material.constants = {{"youngs_modulus", 6e5}, {"poissons_ratio", 0.3}};
  body.material.density = 0.1;
  body.mass = MassKind::consistent;
  Vector3 low = body.mesh.vertices.front();
  Vector3 top = low;
  for (const Vector3& X : body.mesh.vertices) {
    if (X.y() < low.y()) low = X;
    if (X.y() > top.y()) top = X;
  }
  scene.bodies.push_back(std::move(body));
  scene.fixes.push_back(clamp("feet", 1, low.y(), 0.1));
  LoadDescription drag;
  drag.kind = "spring";
  drag.name = "mouse";
  drag.where.kind = Where::Kind::sphere;
  drag.where.center = top;
  drag.where.radius = 0.01;
  drag.stiffness = 1e5;
  drag.velocity = {0.3, 0, 0.1};
  drag.until = 1;
  scene.loads.push_back(drag);
  scene.probes.push_back(probe("ear", top));
  return scene;
}

}  // namespace resilin::bench
