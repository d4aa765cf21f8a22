// Derivatives on given meshes against NGSolve and an independent adjoint (tests/reference/gradients.json).

#include "derivative_checks.hpp"
#include "reference_case.hpp"

namespace resilin::testing {
namespace {

constexpr double tolerance = 1e-7;  ///< tolerance of the reference, relative to the largest number

double relative_error(const VectorX& values, const std::vector<double>& expected) {
  const auto reference =
      Eigen::Map<const VectorX>(expected.data(), static_cast<Eigen::Index>(expected.size()));
  EXPECT_EQ(values.size(), reference.size());
  return (values - reference).cwiseAbs().maxCoeff() / reference.cwiseAbs().maxCoeff();
}

std::vector<double> flat(const nlohmann::json& rows) {
  std::vector<double> all;
  for (const auto& row : rows)
    for (const auto& number : row) all.push_back(number);
  return all;
}

/// The vertex at a place.
Index vertex_at(const Mesh& mesh, const Vector3& place) {
  Index nearest = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if ((mesh.vertices[v] - place).norm() < (mesh.vertices[static_cast<std::size_t>(nearest)] - place).norm())
      nearest = static_cast<Index>(v);
  EXPECT_LT((mesh.vertices[static_cast<std::size_t>(nearest)] - place).norm(), 1e-9);
  return nearest;
}

/// Gradients of the displacement of a vertex in the last frame, of one component after another.
std::vector<std::vector<VectorX>> gradients_of_vertex(Derivatives& run, Index vertex) {
  std::vector<std::vector<VectorX>> all;
  for (int k = 0; k < 3; ++k) {
    std::vector<FrameChange> slopes(static_cast<std::size_t>(run.num_frames()));
    slopes.back().positions = VectorX::Unit(run.world().rest_positions.size(), 3 * vertex + k);
    all.push_back(run.transposed(slopes));
  }
  return all;
}

struct CantileverCase {
  Description scene;
  Index vertex;
};

CantileverCase cantilever(const nlohmann::json& reference, const nlohmann::json& row) {
  Description scene =
      one_body(3, reference_mesh(reference["mesh"]), reference_law_from_young("nh_log", 5e5, 0.3));
  scene.newton.tolerance = 1e-12;
  BodyDescription& body = scene.bodies[0];
  body.element = row["element"];
  const std::string rule = row["quadrature"];
  if (rule.find("exact") != std::string::npos) body.quadrature = "exact";
  if (rule.starts_with("4")) body.quadrature = "4-point";
  body.material.density = 1000;
  std::vector<double> moduli;
  const std::vector<Index>& cells = body.mesh.find_solid(3)->nodes;
  for (std::size_t first = 0; first < cells.size(); first += 4) {
    double x = 0;
    for (std::size_t a = 0; a < 4; ++a)
      x += body.mesh.vertices[static_cast<std::size_t>(cells[first + a])].x() / 4;
    moduli.push_back(row[x < 0.5 ? "E_first_half" : "E_second_half"]);
  }
  body.material.constants = {{"poissons_ratio", 0.3}};
  body.material.cell_constants = {{"youngs_modulus", moduli}};
  scene.gravity = {0, 0, -9.81};
  scene.fixes = {fix("wall", plane(0, 0))};
  LoadDescription force;  // to be differentiated by
  force.name = "force";
  force.kind = "body_force";
  scene.loads = {force};
  const Index vertex = vertex_at(body.mesh, {1, 0.1, 0.1});
  return {std::move(scene), vertex};
}

TEST(GradientsReference, StaticsAndShape) {
  const nlohmann::json reference = read_reference("gradients")["static_and_shape"];
  for (const auto& row : reference["rows"]) {
    SCOPED_TRACE(row["element"].get<std::string>() + ", " + row["quadrature"].get<std::string>());
    const CantileverCase c = cantilever(reference, row);
    const BodyDescription& body = c.scene.bodies[0];
    const auto run =
        Derivatives::run(c.scene, {"body.body.material.youngs_modulus", "body.body.rest_positions",
                                   "simulation.gravity", "load.force.value"});
    const auto gradients = gradients_of_vertex(*run, c.vertex);
    const std::vector<double>& moduli = body.material.cell_constants.at("youngs_modulus");
    std::map<std::string, Vector3> found = {{"d_dE_first_half", Vector3::Zero()},
                                            {"d_dE_second_half", Vector3::Zero()}};
    const VectorX rest = run->parameters()[1].value;
    for (int k = 0; k < 3; ++k) {
      const VectorX& by_E = gradients[static_cast<std::size_t>(k)][0];
      const VectorX& by_X = gradients[static_cast<std::size_t>(k)][1];
      const VectorX& by_g = gradients[static_cast<std::size_t>(k)][2];
      const std::vector<Index>& cells = body.mesh.find_solid(3)->nodes;
      for (std::size_t cell = 0; cell < moduli.size(); ++cell) {
        double x = 0;
        for (std::size_t a = 0; a < 4; ++a)
          x += body.mesh.vertices[static_cast<std::size_t>(cells[4 * cell + a])].x() / 4;
        found[x < 0.5 ? "d_dE_first_half" : "d_dE_second_half"][k] += by_E[static_cast<Eigen::Index>(cell)];
      }
      const Vector3 sizes(1, 0.2, 0.2);
      const char* const names[] = {"d_dlength", "d_dwidth", "d_dheight"};
      for (int axis = 0; axis < 3; ++axis) {
        double slope = 0;
        for (Eigen::Index v = 0; v < rest.size() / 3; ++v)
          slope += by_X[3 * v + axis] * rest[3 * v + axis] / sizes[axis];
        // u = x - X of a vertex that moves with the box.
        if (axis == k) slope -= rest[3 * c.vertex + axis] / sizes[axis];
        found[names[axis]][k] = slope;
      }
      found["d_dload"][k] = by_g.dot(Vector3(0, 0, -9.81));
      EXPECT_NEAR(gradients[static_cast<std::size_t>(k)][3][2] * 1000, by_g[2], 1e-9 * std::abs(by_g[2]));
    }
    for (const auto& [name, value] : found) {
      ASSERT_TRUE(row.contains(name)) << name;
      EXPECT_LT(resilin::testing::relative_error(value, row[name]), tolerance) << name;
    }
    EXPECT_LT(resilin::testing::relative_error(
                  Vector3(run->positions(run->num_frames() - 1).segment<3>(3 * c.vertex) -
                          rest.segment<3>(3 * c.vertex)),
                  row["tip_center"]),
              tolerance);
  }
}

TEST(GradientsReference, EveryCellVertexAndForceInStatics) {
  const nlohmann::json reference = read_reference("gradients")["static_and_shape"];
  const nlohmann::json& arrays = reference["adjoint_arrays"];
  nlohmann::json row = {
      {"element", "P1"}, {"quadrature", "1 point"}, {"E_first_half", 5e5}, {"E_second_half", 5e5}};
  CantileverCase c = cantilever(reference, row);
  c.scene.loads.clear();
  std::vector<std::string> wrt = {"body.body.material.youngs_modulus", "body.body.rest_positions"};
  const std::size_t num_vertices = c.scene.bodies[0].mesh.vertices.size();
  for (std::size_t v = 0; v < num_vertices; ++v) {
    LoadDescription load;
    load.name = std::to_string(v);
    load.kind = "nodal_force";
    load.where.kind = Where::Kind::vertices;
    load.where.vertices = {static_cast<Index>(v)};
    c.scene.loads.push_back(load);
    wrt.push_back("load." + load.name + ".value");
  }
  const auto run = Derivatives::run(c.scene, wrt);
  const std::vector<VectorX> gradient = gradients_of_vertex(*run, c.vertex)[2];
  EXPECT_LT(relative_error(gradient[0], arrays["d_dE_per_cell"].get<std::vector<double>>()), tolerance);
  VectorX by_X = gradient[1];
  EXPECT_LT(
      by_X.reshaped(3, static_cast<Eigen::Index>(num_vertices)).rowwise().sum().cwiseAbs().maxCoeff() - 1,
      1e-9);  // a translation of all moves the vertex, and its displacement not at all
  by_X[3 * c.vertex + 2] -= 1;
  EXPECT_LT(relative_error(by_X, flat(arrays["d_drest_positions"])), tolerance);
  VectorX by_f(3 * static_cast<Eigen::Index>(num_vertices));
  for (std::size_t v = 0; v < num_vertices; ++v)
    by_f.segment<3>(3 * static_cast<Eigen::Index>(v)) = gradient[2 + v];
  EXPECT_LT(relative_error(by_f, flat(arrays["d_dnodal_force"])), tolerance);
}

TEST(GradientsReference, MotionByStartDensityAndStiffness) {
  const nlohmann::json reference = read_reference("gradients")["dynamic"];
  Description scene =
      one_body(3, reference_mesh(reference["mesh"]), reference_law_from_young("nh_log", 1.7e7, 0.45));
  scene.newton.tolerance = 1e-12;
  scene.is_dynamic = true;
  scene.time_step = 0.01;
  scene.end_time = 0.2;
  BodyDescription& body = scene.bodies[0];
  body.mass = MassKind::consistent;
  body.material.density = 1100;
  body.material.constants = {{"poissons_ratio", 0.45}};
  body.material.cell_constants = {{"youngs_modulus", std::vector<double>(288, 1.7e7)}};
  body.velocity_gradient(0, 2) = 5.0 / 3;
  scene.fixes = {fix("foot", plane(2, 0))};
  const Index vertex = vertex_at(body.mesh, {1, 1, 6});
  const auto run = Derivatives::run(scene, {"body.body.material.youngs_modulus", "body.body.density",
                                            "body.body.initial_velocities", "body.body.initial_positions"});
  const auto gradients = gradients_of_vertex(*run, vertex);
  std::map<std::string, Vector3> found;
  for (int k = 0; k < 3; ++k) {
    const std::vector<VectorX>& gradient = gradients[static_cast<std::size_t>(k)];
    found["d_dE"][k] = gradient[0].sum();
    found["d_ddensity"][k] = gradient[1][0];
    found["d_dvelocity_scale"][k] = gradient[2].dot(run->parameters()[2].value);
    double slope = 0;
    for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v)
      slope += gradient[3][3 * static_cast<Eigen::Index>(v)] * body.mesh.vertices[v].z() / 6;
    found["d_dinitial_displacement_scale"][k] = slope;
  }
  const auto& row = reference["rows"][0];
  for (const auto& [name, value] : found)
    EXPECT_LT(resilin::testing::relative_error(value, row[name]), tolerance) << name;
  const auto& arrays = reference["adjoint_arrays"];
  EXPECT_LT(relative_error(gradients[0][0], arrays["d_dE_per_cell"].get<std::vector<double>>()), tolerance);
  EXPECT_LT(relative_error(gradients[0][2], flat(arrays["d_dinitial_velocities"])), tolerance);
  // The reference moves no vertex of the foot.
  VectorX by_start = gradients[0][3];
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v)
    if (body.mesh.vertices[v].z() == 0) by_start.segment<3>(3 * static_cast<Eigen::Index>(v)).setZero();
  EXPECT_LT(relative_error(by_start, flat(arrays["d_dinitial_displacements"])), tolerance);
}

}  // namespace
}  // namespace resilin::testing
