// The forces and the matrix of a Kelvin-Voigt solid, on every element of the catalogue.
#include <gtest/gtest.h>

#include <cmath>

#include "element_mesh.hpp"
#include "every_element.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/energy/damping.hpp"

namespace resilin {
namespace {

/// A body of curved cells, each with viscosities of its own, and what the kernels make of it.
struct DampedBody {
  ElementMesh mesh;
  std::vector<Viscosity> viscosities;
  std::shared_ptr<ElasticEnergy> elastic;
  std::shared_ptr<BlockPattern> pattern;
  VectorX shape, velocities;

  explicit DampedBody(const ElementInfo& element, int n = 2, bool is_uniform = false,
                      InstructionSet set = preferred_instruction_set())
      : mesh(element, n, 0.05) {
    const LawInfo& law = *find_law("neo_hookean_isochoric");
    elastic = std::make_shared<ElasticEnergy>(mesh.dim, element.name, mesh.cells, mesh.X, law,
                                              law.constants_from(hooke_from_young_poisson(1e5, 0.3)),
                                              FibreDirections{}, set);
    BlockPatternBuilder builder(static_cast<Index>(mesh.X.size() / mesh.dim));
    elastic->add_pattern(builder);
    pattern = std::make_shared<BlockPattern>(builder.build());
    elastic->bind(*pattern);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(1, 5);
    viscosities.resize(is_uniform ? 1 : static_cast<std::size_t>(elastic->num_cells()));
    for (Viscosity& viscosity : viscosities) viscosity = {.eta = uniform(random), .zeta = uniform(random)};
    shape = mesh.moved(0.02, 5);
    velocities = mesh.moved(1, 6) - mesh.X;
  }

  std::vector<double> local_shape() const { return elastic->tiles().blocks.local_displacements(shape); }
  VectorX forces(bool is_magnitude = false) const {
    VectorX result = VectorX::Zero(shape.size());
    ViscousDamping(elastic, viscosities).add_forces(local_shape(), velocities, is_magnitude, result);
    return result;
  }
  BlockMatrix matrix() const {
    BlockMatrix D(mesh.dim, pattern);
    ViscousDamping(elastic, viscosities).add_matrix(local_shape(), 1, D);
    return D;
  }
};

/// f_a = sum_q V F (2 eta Edot + zeta tr Edot 1) g_a, point by point; in 2D with zeros.
VectorX plain_forces(const ElementInfo& element, const DampedBody& body) {
  const auto dim = static_cast<std::size_t>(element.dim), n = static_cast<std::size_t>(element.num_nodes);
  VectorX forces = VectorX::Zero(body.shape.size());
  for (std::size_t cell = 0; cell * n < body.mesh.cells.size(); ++cell) {
    const auto unknown = [&](std::size_t a, std::size_t i) {
      return static_cast<Eigen::Index>(static_cast<std::size_t>(body.mesh.cells[cell * n + a]) * dim + i);
    };
    std::vector<double> positions;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t i = 0; i < dim; ++i) positions.push_back(body.mesh.X[unknown(a, i)]);
    for (const QuadraturePoint& point : body.elastic->quadrature().points) {
      const PointGeometry geometry = point_geometry(element, point, positions);
      Matrix<3> F = Matrix<3>::Zero(), rate = F;
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t i = 0; i < dim; ++i)
          for (std::size_t k = 0; k < dim; ++k) {
            const double g = geometry.gradients[a * dim + k];
            F(static_cast<int>(i), static_cast<int>(k)) += body.shape[unknown(a, i)] * g;
            rate(static_cast<int>(i), static_cast<int>(k)) += body.velocities[unknown(a, i)] * g;
          }
      const Matrix<3> product = F.transpose() * rate, strain_rate = 0.5 * (product + product.transpose());
      const Viscosity& viscosity = body.viscosities[body.viscosities.size() == 1 ? 0 : cell];
      const Matrix<3> P = F * (2 * viscosity.eta * strain_rate +
                               viscosity.zeta * strain_rate.trace() * Matrix<3>::Identity());
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t i = 0; i < dim; ++i)
          for (std::size_t k = 0; k < dim; ++k)
            forces[unknown(a, i)] += geometry.weight * P(static_cast<int>(i), static_cast<int>(k)) *
                                     geometry.gradients[a * dim + k];
    }
  }
  return forces;
}

struct ViscousDampingOfEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, ViscousDampingOfEveryElement, ::testing::ValuesIn(elements()),
                         name_of_element);

TEST_P(ViscousDampingOfEveryElement, HasTheForcesOfAKelvinVoigtSolidOnEveryInstructionSet) {
  for (const bool is_uniform : {true, false})
    for (const InstructionSet set : available_instruction_sets()) {
      const DampedBody body(element, 2, is_uniform, set);
      const VectorX magnitude = body.forces(true);
      EXPECT_LT((body.forces() - plain_forces(element, body)).norm(), 1e-13 * magnitude.norm());
      EXPECT_TRUE((body.forces().cwiseAbs().array() <= magnitude.array() * (1 + 1e-12) + 1e-300).all());
    }
}

TEST_P(ViscousDampingOfEveryElement, HasTheMatrixOfItsForcesOnEveryInstructionSet) {
  for (const InstructionSet set : available_instruction_sets()) {
    const DampedBody body(element, 2, false, set);
    VectorX product;
    multiply(body.matrix(), body.velocities, product);
    EXPECT_LT((product - body.forces()).norm(), 1e-13 * body.forces(true).norm());
    EXPECT_GT(product.dot(body.velocities), 0);
  }
}

/// The matrix is the same whether the term adds it or the body takes it along, in parts of what both are.
TEST_P(ViscousDampingOfEveryElement, IsTakenAlongByTheLoopOfItsBody) {
  DampedBody body(element);
  const Stage stage{.base_positions = body.mesh.X,
                    .base_velocities = body.velocities,
                    .duration = 0.1,
                    .shape = body.shape};
  const ViscousDamping damping(body.elastic, body.viscosities);
  const auto term = damping.begin_stage(stage);
  ASSERT_NE(term->cell_matrices(), nullptr);
  EXPECT_TRUE(body.elastic->takes(*term->cell_matrices()));
  EXPECT_FALSE(DampedBody(element).elastic->takes(*term->cell_matrices()));
  for (const Projection projection : {Projection::none, Projection::clamp}) {
    BlockMatrix apart(body.mesh.dim, body.pattern), together = apart;
    body.elastic->add_hessian(body.shape, {}, projection, apart);
    term->add_hessian(body.shape, {}, projection, apart);
    const std::array along = {term->cell_matrices()};
    body.elastic->add_hessian_at({}, body.shape, {}, projection, together, along);
    const Eigen::Map<const VectorX> expected(apart.values.data(),
                                             static_cast<Eigen::Index>(apart.values.size())),
        got(together.values.data(), expected.size());
    EXPECT_LT((got - expected).norm(), 1e-13 * expected.norm());
  }
}

/// x' = w x x + c: the rate of Green's strain is zero, and so are the forces.
TEST_P(ViscousDampingOfEveryElement, LeavesRigidMotionsAlone) {
  DampedBody body(element);
  const double scale = body.forces(true).norm();
  for (Eigen::Index node = 0; node < body.shape.size() / body.mesh.dim; ++node) {
    const auto x = body.shape.segment(node * body.mesh.dim, body.mesh.dim);
    auto v = body.velocities.segment(node * body.mesh.dim, body.mesh.dim);
    v = VectorX::Constant(body.mesh.dim, 3);
    v[0] -= 2 * x[1];
    v[1] += 2 * x[0];
  }
  EXPECT_LT(body.forces().norm(), 1e-13 * scale);
}

TEST_P(ViscousDampingOfEveryElement, GivesNoForceInSum) {
  const DampedBody body(element);
  const VectorX forces = body.forces();
  for (int i = 0; i < body.mesh.dim; ++i)
    EXPECT_LT(std::abs(forces(Eigen::seq(i, Eigen::last, body.mesh.dim)).sum()), 1e-12 * forces.norm());
}

TEST_P(ViscousDampingOfEveryElement, GivesTheSameBitsForAnyNumberOfThreads) {
  const int threads_before = num_threads();
  set_num_threads(1);
  const DampedBody body(element, element.dim == 3 ? 6 : 24);  // more blocks than one tile
  const VectorX forces = body.forces(), magnitude = body.forces(true);
  const BlockMatrix D = body.matrix();
  const double heat =
      ViscousDamping(body.elastic, body.viscosities).dissipation(body.mesh.X, body.shape, 0.1);
  for (const int threads : {2, 3, 8}) {
    set_num_threads(threads);
    EXPECT_EQ(body.forces(), forces);
    EXPECT_EQ(body.forces(true), magnitude);
    EXPECT_EQ(body.matrix().values, D.values);
    EXPECT_EQ(ViscousDamping(body.elastic, body.viscosities).dissipation(body.mesh.X, body.shape, 0.1), heat);
  }
  set_num_threads(threads_before);
  EXPECT_GT(heat, 0);
}

/// Evaluated in any order, also over and over, a stage's term says the same of each place.
TEST_P(ViscousDampingOfEveryElement, SaysTheSameOfAPlaceWheneverItIsAsked) {
  const DampedBody body(element);
  const Stage stage{.base_positions = body.mesh.X,
                    .base_velocities = body.velocities,
                    .duration = 0.1,
                    .shape = body.shape};
  const ViscousDamping damping(body.elastic, body.viscosities);
  std::vector<VectorX> places, forces;
  for (unsigned seed = 10; seed < 14; ++seed) {
    places.push_back(body.mesh.moved(0.1, seed));
    forces.push_back(VectorX::Zero(body.shape.size()));
    damping.begin_stage(stage)->add_gradient(places.back(), {}, forces.back());
  }
  const auto kept = damping.begin_stage(stage);
  for (const std::size_t i : {0U, 1U, 0U, 2U, 0U, 3U, 3U, 1U}) {
    VectorX gradient = VectorX::Zero(body.shape.size());
    kept->add_gradient(places[i], {}, gradient);
    EXPECT_EQ(gradient, forces[i]);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double there = kept->value(places[k], {}), here = kept->value(places[i], {});
      EXPECT_NEAR(kept->difference(places[i], places[k], {}), there - here, 1e-12 * (there + here));
    }
  }
}

}  // namespace
}  // namespace resilin
