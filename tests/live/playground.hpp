#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "resilin/element/element.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/mesh/generators.hpp"

/// Scenes to play with, and a hand that plays by chance but always the same way.
namespace resilin::testing {

/// The behaviour of a scene must not hang on how busy the machine is.
constexpr StepBudget unhurried{.seconds = std::numeric_limits<double>::infinity()};

/// A block cut into cells of an element, `n` along each of its edges.
inline Mesh block_for(const ElementInfo& element, const Vector3& size, int n) {
  switch (element.shape) {
    case CellShape::triangle:
      return make_rectangle(size.head<2>(), {n, n});
    case CellShape::quadrilateral:
      return make_quadrilateral_rectangle(size.head<2>(), {n, n});
    case CellShape::tetrahedron:
      return make_box(size, {n, n, n});
    default:
      return make_hexahedron_box(size, {n, n, n});
  }
}

/// A block of 0.4 x 0.4 x 1 m that stands on its held foot, soft enough to sway.
inline Description standing_block(int n, double gravity = -9.81) {
  Description scene;
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.gravity = {0, 0, gravity};
  BodyDescription body;
  body.mesh = make_box({0.4, 0.4, 1}, {n, n, 2 * n}, Vector3::Zero(), TetPattern::five);
  body.element = "P1";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.4}};
  scene.bodies.push_back(std::move(body));
  FixDescription foot;
  foot.name = "foot";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = 2;
  foot.where.at = 0;
  scene.fixes.push_back(foot);
  return scene;
}

/// The creature that its first author let people drag: light, stiff, without gravity, held at its feet.
inline Description armadillo(const std::filesystem::path& mesh) {
  Description scene;
  scene.is_dynamic = true;
  scene.time_step = 0.01;
  BodyDescription body;
  body.mesh = read_solid_mesh(mesh, 3).mesh;
  body.element = "P1";
  body.material.constants = {{"youngs_modulus", 6e5}, {"poissons_ratio", 0.3}};
  body.material.density = 0.1;
  scene.bodies.push_back(std::move(body));
  FixDescription feet;
  feet.name = "feet";
  feet.where.kind = Where::Kind::plane;
  feet.where.axis = 1;
  feet.where.at = 0.029;  // the lowest vertex
  feet.where.tolerance = 0.1;
  scene.fixes.push_back(feet);
  return scene;
}

/// Numbers by chance (Steele, Lea & Flood 2014, splitmix64): the same on every machine.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
  }
  double between_in_ratio(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  Index below(Index count) { return static_cast<Index>(next() % static_cast<std::uint64_t>(count)); }
  bool happens(double probability) { return between(0, 1) < probability; }

  Vector3 direction() {
    while (true) {
      const Vector3 v(between(-1, 1), between(-1, 1), between(-1, 1));
      if (const double r = v.norm(); r > 0.1 && r <= 1) return v / r;
    }
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

inline MaterialPoint at_node(Index node) { return {.nodes = {node}, .weights = {1}}; }

}  // namespace resilin::testing
