#pragma once

#include <random>
#include <string>
#include <vector>

#include "resilin/core/text.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/scene_fit.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/simulation/simulation.hpp"
#include "temporary_folder.hpp"

/// Small scenes, and measurements of them that come from runs of the scenes, not from the fit's own model.
namespace resilin::testing {

/// A strip in the plane, held at one end, under its weight; two moduli.
inline const std::string sagging_strip = R"(
[simulation]
kind = "static"
dimension = 2
gravity = [0, -9.81]
[newton]
tolerance = 1e-10
[[body]]
name = "bar"
mesh = { box = { kind = "quadrilaterals", size = [1, 0.2], cells = [10, 2] } }
material = { law = "neo_hookean", youngs_modulus = { file = "young.csv" }, poissons_ratio = 0.3, density = 1000 }
[[fix]]
name = "wall"
where = { plane = { axis = "x", at = 0 } }
[[probe]]
name = "tip"
at = [1, 0.1]
)";

inline std::string moduli_csv(double root, double tip) {
  std::string text;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 10; ++i) text += format_number(i < 5 ? root : tip) + "\n";
  return text;
}

/// Vertices of the middle line.
inline std::vector<Vector3> middle_line() {
  std::vector<Vector3> points;
  for (int i = 0; i <= 10; ++i) points.emplace_back(0.1 * i, 0.1, 0);
  return points;
}

/// The end of a run.
inline Simulation run_to_the_end(const Description& description) {
  Simulation simulation{Description(description)};
  while (!simulation.is_finished()) EXPECT_EQ(simulation.step().status, StepReport::Status::converged);
  return simulation;
}

/// The displacement of the vertex at a point.
inline Vector3 displacement_at(const Simulation& simulation, const Vector3& point) {
  const World& world = simulation.world();
  const int dim = world.dimension;
  for (Index node = 0; node < world.num_nodes(); ++node) {
    if ((world.place_of(node, world.rest_positions) - point).norm() > 1e-9) continue;
    return world.place_of(node, simulation.state().positions) - point;
  }
  ADD_FAILURE() << "no vertex at " << format_point(point, dim);
  return Vector3::Zero();
}

/// A table of markers in the plane, with normal errors.
inline std::string markers_csv(const Simulation& simulation, const std::vector<Vector3>& points, double noise,
                               std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  std::string text = "X,Y,ux,uy\n";
  for (const Vector3& point : points) {
    const Vector3 u = displacement_at(simulation, point);
    text += format_number(point[0]) + "," + format_number(point[1]) + "," +
            format_number(u[0] + noise * normal(random)) + "," +
            format_number(u[1] + noise * normal(random)) + "\n";
  }
  return text;
}

/// A folder with scene, cell values and markers, and fits in it.
class SceneFitFiles : public ::testing::Test {
 protected:
  Description scene(const std::string& text) {
    folder.write("scene.toml", text);
    return read_scene(folder / "scene.toml").description;
  }
  SceneFitReport fit(const std::string& text) {
    return fit_scenes(read_scene_fit(folder.write("fit.toml", text)));
  }
  /// A strip that swings for a second, with E = 2 MPa, and its tip's height, in scene.toml and tip.csv.
  void write_swinging_strip() {
    std::string strip = sagging_strip;
    strip.replace(strip.find("kind = \"static\""), 15,
                  "kind = \"dynamic\"\ntime_step = 0.01\nend_time = 1\nintegrator = \"bdf2\"");
    strip.replace(strip.find("{ file = \"young.csv\" }"), 22, "2e6");
    strip.replace(strip.find("cells = [10, 2]"), 15, "cells = [5, 1]");
    strip.replace(strip.find("at = [1, 0.1]"), 13, "at = [1, 0]");
    Simulation truth{scene(strip)};
    std::string csv = "time,uy\n";
    while (!truth.is_finished()) {
      truth.step();
      if (truth.state().step % 5 != 0) continue;
      csv += format_number(truth.state().time) + ",";
      csv += format_number(displacement_at(truth, {1, 0, 0})[1]) + "\n";
    }
    folder.write("tip.csv", csv);
  }
  /// The message; it is one line.
  std::string error_of(const std::string& text) {
    try {
      fit(text);
    } catch (const std::exception& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder;
  std::mt19937 random{7};
};

}  // namespace resilin::testing
