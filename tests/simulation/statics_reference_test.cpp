// Statics on given meshes against two codes that are not ours (tests/reference).

#include <gtest/gtest.h>

#include "reference_case.hpp"

namespace resilin::testing {
namespace {

double total_rest_volume(const Simulation& simulation) {
  return simulation.world().bodies[0].domains.front().energy->total_rest_volume();
}

TEST(StaticsReference, CooksMembraneInTwoDimensions) {
  const nlohmann::json reference = read_reference("cook_2d");
  const double mu = reference["material"]["mu"];
  const double lambda = reference["material"]["lam"];
  for (const auto& row : reference["exact_mesh_values"]) {
    if (!is_quick(row)) continue;
    SCOPED_TRACE(row.dump());
    Description description = one_body(2, reference_mesh(row["mesh"]), reference_law(row["law"], mu, lambda));
    use_element(description, row);
    load_as_cooks_membrane(description);
    description.probes = {probe("mid", {48, 52, 0}), probe("top", {48, 60, 0})};
    Simulation simulation(description);
    const Frame frame = run_to_end(simulation);
    const auto& values = row["values"];
    EXPECT_NEAR(frame.probes[0].displacement.y(), values["uy_mid"],
                exact_mesh_tolerance * values["uy_mid"].get<double>());
    EXPECT_LT(relative_error(frame.probes[1].displacement, {values["ux_top"], values["uy_top"]}),
              exact_mesh_tolerance);
    EXPECT_NEAR(frame.total_energy(), values["total_potential"],
                exact_mesh_tolerance * std::abs(values["total_potential"].get<double>()));
    EXPECT_LT(relative_error(frame.reactions[0].second, values["reaction"]), exact_mesh_tolerance);
  }
}

TEST(StaticsReference, CantileverUnderItsWeight) {
  const nlohmann::json reference = read_reference("cantilever_gravity_3d");
  for (const auto& row : reference["exact_mesh_values"]) {
    if (!is_quick(row) || row["mesh"] == "by recipe") continue;
    SCOPED_TRACE(row.dump());
    const ReferenceLaw law = reference_law_from_young(row["law"], 5e5, row["nu"]);
    Description description = one_body(3, reference_mesh(row["mesh"]), law);
    use_element(description, row);
    description.gravity = {0, 0, -9.81};
    description.fixes.push_back(fix("wall", plane(0, 0)));
    description.probes = {probe("center", {1, 0.1, 0.1}), probe("corner", {1, 0.2, 0.2})};
    Simulation simulation(description);
    const Frame frame = run_to_end(simulation);
    const auto& values = row["values"];
    EXPECT_LT(relative_error(frame.probes[0].displacement, values["tip_center"]), exact_mesh_tolerance);
    EXPECT_LT(relative_error(frame.probes[1].displacement, values["tip_corner"]), exact_mesh_tolerance);
    const double potential = frame.total_energy() + law.rest_energy_density * total_rest_volume(simulation);
    EXPECT_NEAR(potential, values["total_potential"],
                exact_mesh_tolerance * std::abs(values["total_potential"].get<double>()));
    EXPECT_LT(relative_error(frame.reactions[0].second, values["reaction"]), exact_mesh_tolerance);
  }
}

TEST(StaticsReference, BarTwistedByHalfATurn) {
  const nlohmann::json reference = read_reference("twist_bar_3d");
  for (const auto& row : reference["exact_mesh_values"]) {
    if (!is_quick(row)) continue;
    SCOPED_TRACE(row.dump());
    const std::string mesh = row["cells"] == "2x10" ? "meshes/bar_2x2x10.msh" : "meshes/bar_4x4x20.msh";
    const ReferenceLaw law = reference_law(row["law"], 1, 9);
    Description description = one_body(3, reference_mesh(mesh), law);
    use_element(description, row);
    description.load_steps = 6;
    description.fixes = {fix("bottom", plane(2, 0)), fix("top", plane(2, 5))};
    description.fixes[1].rotate =
        Rotation{.axis = Vector3::UnitZ(), .center = Vector3::Zero(), .degrees = 180};
    description.probes = {probe("mid", {0.5, 0.5, 2.5})};
    Simulation simulation(description);
    const Frame frame = run_to_end(simulation);
    const auto& values = row["values"];
    EXPECT_LT(relative_error(frame.probes[0].displacement, values["mid_corner"]), exact_mesh_tolerance);
    EXPECT_NEAR(frame.reactions[1].second.z(), values["axial_force"],
                exact_mesh_tolerance * std::abs(values["axial_force"].get<double>()));
    EXPECT_NEAR(frame.total_energy() + law.rest_energy_density * total_rest_volume(simulation),
                values["energy"], exact_mesh_tolerance * values["energy"].get<double>());
    EXPECT_NEAR(frame.reaction_torques[1].z(), values["torque"],
                exact_mesh_tolerance * values["torque"].get<double>());
  }
}

TEST(StaticsReference, PatchTestGivesTheAffineSolution) {
  const nlohmann::json reference = read_reference("patch_test");
  for (const auto& row : reference["cases"]) {
    if (row["law"] == "mooney_rivlin") continue;  // a law of a later version
    SCOPED_TRACE(row.dump());
    const int dim = static_cast<int>(row["F0"].size());
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int i = 0; i < dim; ++i) {
      for (int j = 0; j < dim; ++j)
        gradient(i, j) =
            row["F0"][static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].get<double>() - (i == j);
    }
    const double lambda = row["law"] == "nh_iso_j1" ? 3.5 - 2 * 1.25 / 3 /* kappa is 3.5 */ : 2.75;
    const ReferenceLaw law = reference_law(row["law"], 1.25, lambda);
    Description description = one_body(dim, reference_mesh(row["mesh"]), law);
    for (int axis = 0; axis < dim; ++axis) {
      for (const double side : {0.0, 1.0}) {
        FixDescription held = fix("side", plane(axis, side));
        held.gradient = gradient;
        description.fixes.push_back(held);
      }
    }
    Simulation simulation(description);
    const Frame frame = run_to_end(simulation);
    const VectorX& X = simulation.world().rest_positions;
    double largest_error = 0;
    for (Index i = 0; i < simulation.world().num_nodes(); ++i) {
      const Eigen::VectorXd expected =
          X.segment(i * dim, dim) + gradient.topLeftCorner(dim, dim) * X.segment(i * dim, dim);
      largest_error =
          std::max(largest_error, (simulation.state().positions.segment(i * dim, dim) - expected).norm());
    }
    EXPECT_LT(largest_error, 1e-12);  // lengths are about 1: a few hundred round-offs
    const double energy = row["energy"];
    EXPECT_NEAR(frame.elastic_energy + law.rest_energy_density, energy, 1e-12 * energy * 10);
  }
}

}  // namespace
}  // namespace resilin::testing
