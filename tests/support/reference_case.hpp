#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "resilin/io/mesh_file.hpp"
#include "resilin/simulation/simulation.hpp"
#include "shared_data.hpp"
#include "validation_laws.hpp"

namespace resilin::testing {

/// The mesh of a reference case.
inline Mesh reference_mesh(const std::string& file) { return read_mesh(reference_folder() / file).mesh; }

/// A description with one body of linear elements, tight Newton and a direct solver: what the exact rows of
/// the cases ask for.
inline Description one_body(int dimension, Mesh mesh, const ReferenceLaw& law) {
  Description description;
  description.dimension = dimension;
  description.newton.tolerance = 1e-11;
  description.solver.kind = "cholesky";
  BodyDescription body;
  body.element = "P1";
  body.mesh = std::move(mesh);
  body.material.law = law.law;
  body.material.constants = law.constants;
  description.bodies.push_back(std::move(body));
  return description;
}

/// Gives the body the element and quadrature of a row.
inline void use_element(Description& description, const nlohmann::json& row) {
  BodyDescription& body = description.bodies[0];
  body.element = row["element"];
  const std::string rule = row["quadrature"];
  body.quadrature = rule == "3pt" ? "3-point" : rule == "4pt" ? "4-point" : rule == "exact" ? "exact" : "";
}

/// Rows that take about a second; the others are for the validation report.
inline bool is_quick(const nlohmann::json& row) {
  const bool is_known = row["element"] == "P1" || row["element"] == "P2";
  return is_known && (row["element"] == "P1" || row["values"]["ndof"] < 2500);
}

inline Where group(const std::string& name) {
  Where where;
  where.kind = Where::Kind::group;
  where.group = name;
  return where;
}

inline Where plane(int axis, double at) {
  Where where;
  where.kind = Where::Kind::plane;
  where.axis = axis;
  where.at = at;
  return where;
}

inline FixDescription fix(const std::string& name, const Where& where) {
  FixDescription description;
  description.name = name;
  description.where = where;
  return description;
}

/// Cook's membrane: held at its left side, pulled upward along its right one.
inline void load_as_cooks_membrane(Description& description) {
  description.fixes.push_back(fix("left", group("left")));
  LoadDescription traction;
  traction.kind = "traction";
  traction.where = group("right");
  traction.value = {0, 1.0 / 16, 0};
  description.loads.push_back(traction);
}

inline ProbeDescription probe(const std::string& name, const Vector3& at) {
  ProbeDescription description;
  description.name = name;
  description.at = at;
  return description;
}

/// Runs to the end; the last frame. Fails the test when a step does not converge.
inline Frame run_to_end(Simulation& simulation) {
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
  }
  return simulation.frame();
}

/// Largest difference relative to the largest component of the reference.
inline double relative_error(const Vector3& value, const nlohmann::json& reference) {
  double error = 0;
  double scale = 0;
  for (std::size_t k = 0; k < reference.size(); ++k) {
    const double expected = reference[k].get<double>();
    error = std::max(error, std::abs(value[static_cast<Eigen::Index>(k)] - expected));
    scale = std::max(scale, std::abs(expected));
  }
  return error / scale;
}

/// The reference codes agree to 1e-9 or better; the case files ask for this.
constexpr double exact_mesh_tolerance = 1e-6;

}  // namespace resilin::testing
