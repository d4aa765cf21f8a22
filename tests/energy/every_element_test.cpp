// Properties of the elastic energy of every element of the catalogue.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "element_mesh.hpp"
#include "every_element.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/element/jacobian_bound.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/material/derive.hpp"
#include "sample_fibres.hpp"

namespace resilin {
namespace {

const Hooke hooke = hooke_from_young_poisson(1, 0.45);
const Vector3 fibre(0.6, 0.8, 0);

ElasticEnergy make_energy(const ElementInfo& element, const ElementMesh& mesh, const LawInfo& law,
                          std::string_view quadrature = "",
                          InstructionSet set = preferred_instruction_set()) {
  const auto fibres = testing::fibres_for(law, {fibre});
  return {mesh.dim,
          {element.name, quadrature},
          mesh.cells,
          mesh.X,
          law,
          law.constants_from(hooke),
          {fibres, fibres.size()},
          set};
}

/// The Hessian as a dense matrix.
Eigen::MatrixXd hessian(const ElementMesh& mesh, ElasticEnergy& energy, const VectorX& x,
                        Projection projection) {
  BlockPatternBuilder builder(static_cast<Index>(mesh.X.size() / mesh.dim));
  energy.add_pattern(builder);
  const auto pattern = std::make_shared<BlockPattern>(builder.build());
  energy.bind(*pattern);
  BlockMatrix A(mesh.dim, pattern);
  energy.add_hessian(x, {}, projection, A);
  Eigen::MatrixXd dense(x.size(), x.size());
  VectorX unit = VectorX::Zero(x.size()), column;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    unit[i] = 1;
    multiply(A, unit, column);
    dense.col(i) = column;
    unit[i] = 0;
  }
  return dense;
}

VectorX gradient(const ElasticEnergy& energy, const VectorX& x) {
  VectorX g = VectorX::Zero(x.size());
  energy.add_gradient(x, {}, g);
  return g;
}

/// Moved at random, and before that stretched without a change of volume where there are fibres: they begin
/// to bear load at a stretch of 1, where the energy has but one derivative, and every point is to be well
/// beyond.
VectorX moved_where_it_is_smooth(const ElementMesh& mesh, const LawInfo& law) {
  if (law.max_fibres == 0) return mesh.moved(0.01);
  constexpr double stretch = 1.4;
  const Matrix<3> along = fibre * fibre.transpose(), I = Matrix<3>::Identity();
  const Matrix<3> F = stretch * along + std::pow(stretch, -1.0 / (mesh.dim - 1)) * (I - along);
  VectorX x = mesh.moved(0.01);
  for (Eigen::Index node = 0; node < x.size(); node += mesh.dim)
    x.segment(node, mesh.dim) += (F - I).topLeftCorner(mesh.dim, mesh.dim) * mesh.X.segment(node, mesh.dim);
  return x;
}

/// The least J^(-2/3) |F a|^2 of all points [1]; fibres are slack below 1.
double least_fibre_stretch(const ElasticEnergy& energy, const VectorX& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Matrix<3>& F : energy.deformation_gradients(x))
    least = std::min(least, std::pow(F.determinant(), -2.0 / 3) * (F * fibre).squaredNorm());
  return least;
}

/// Properties of the elastic energy on each element of the catalogue.
struct EveryElementEnergy : OnEveryElement {
  /// Calls `check(element, mesh, law)` for laws of every kind, on curved cells.
  template <class Check>
  void for_every_law(const Check& check) const {
    const ElementMesh mesh(element, 2, 0.05);
    for (const char* name : {"neo_hookean", "stable_neo_hookean", "mooney_rivlin", "ogden", "linear_elastic",
                             "holzapfel_gasser_ogden", "orthotropic", "fung_orthotropic",
                             "ogden + neo_hookean_isochoric_log + holzapfel_gasser_ogden"}) {
      const LawInfo& law = *find_law(name);
      if (element.has_mean_volume && !law.has_volume_energy) continue;
      SCOPED_TRACE(name);
      check(element, mesh, law);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElementEnergy, ::testing::ValuesIn(elements()), name_of_element);

TEST_P(EveryElementEnergy, IsTheSumOfItsPoints) {
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    const ElasticEnergy energy = make_energy(info, mesh, law);
    const VectorX x = mesh.moved(0.01);
    const std::vector<double> volumes = energy.point_volumes(), densities = energy.energy_densities(x);
    double sum = 0;
    for (std::size_t i = 0; i < volumes.size(); ++i) sum += volumes[i] * densities[i];
    EXPECT_NEAR(energy.value(x, {}), sum, 1e-12 * std::abs(sum));
    // The volume of a curved P2 tetrahedron is an integral of degree 3, beyond its 4 points.
    EXPECT_NEAR(energy.total_rest_volume(), 1, info.degree == 2 && mesh.dim == 3 ? 1e-4 : 1e-13);
  });
}

TEST_P(EveryElementEnergy, HasItsSlopeAsGradientAndItsCurvatureAsHessian) {
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    ElasticEnergy energy = make_energy(info, mesh, law);
    const VectorX x = moved_where_it_is_smooth(mesh, law);
    if (law.max_fibres > 0) {
      EXPECT_GT(least_fibre_stretch(energy, x), 1.1);
    }
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    VectorX p = VectorX::Zero(x.size());
    for (double& value : p) value = normal(random);
    const double h = 1e-5;
    const VectorX g = gradient(energy, x);
    EXPECT_NEAR(energy.difference(x - h * p, x + h * p, {}) / (2 * h), g.dot(p), 2e-7 * g.norm() * p.norm());
    const Eigen::MatrixXd H = hessian(mesh, energy, x, Projection::none);
    const VectorX difference = (gradient(energy, x + h * p) - gradient(energy, x - h * p)) / (2 * h);
    EXPECT_LT((H * p - difference).norm(), 1e-6 * difference.norm());
  });
}

/// d(g w)/dp and dE/dp of every constant p against differences.
TEST_P(EveryElementEnergy, HasItsSlopesByTheConstants) {
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    const auto fibres = testing::fibres_for(law, {fibre});
    std::vector<double> constants = law.constants_from(hooke);
    const auto energy_at = [&](std::size_t p, double value) {
      std::vector<double> changed = constants;
      changed[p] = value;
      return ElasticEnergy(mesh.dim, {info.name, ""}, mesh.cells, mesh.X, law, changed,
                           {fibres, fibres.size()});
    };
    const VectorX x = mesh.moved(0.01), w = mesh.moved(0.02) - mesh.X;
    const ElasticEnergy energy = make_energy(info, mesh, law);
    VectorX slopes = VectorX::Zero(static_cast<Eigen::Index>(constants.size())), energies = slopes;
    energy.add_parameter_slopes("constants", x, w, {}, slopes);
    energy.add_energy_slopes("constants", x, energies);
    for (std::size_t p = 0; p < constants.size(); ++p) {
      const double value = constants[p], step = 1e-4 * (std::abs(value) + 1e-3);
      const ElasticEnergy plus = energy_at(p, value + step), minus = energy_at(p, value - step);
      const double slope = (gradient(plus, x) - gradient(minus, x)).dot(w) / (2 * step);
      const double scale = gradient(energy, x).norm() * w.norm() / (std::abs(value) + 1e-3);
      const auto i = static_cast<Eigen::Index>(p);
      EXPECT_NEAR(slopes[i], slope, 1e-6 * scale) << law.constants[p].name;
      EXPECT_NEAR(energies[i], (plus.value(x, {}) - minus.value(x, {})) / (2 * step), 1e-6 * scale)
          << law.constants[p].name;
    }
  });
}

TEST_P(EveryElementEnergy, IsPositiveSemidefiniteOnceProjected) {
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    ElasticEnergy energy = make_energy(info, mesh, law);
    const VectorX x = mesh.moved(law.needs_positive_J ? 0.015 : 0.15);
    for (const Projection projection : {Projection::clamp, Projection::absolute}) {
      const Eigen::MatrixXd H = hessian(mesh, energy, x, projection);
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(H).eigenvalues();
      EXPECT_GT(values.minCoeff(), -1e-11 * values.maxCoeff());
    }
  });
}

TEST_P(EveryElementEnergy, IsStableAtRestHoweverFlatItsCells) {
  for (const double thickness : {1.0, 0.3, 0.1}) {
    ElementMesh mesh(element, 1, 0);
    for (Eigen::Index i = mesh.dim - 1; i < mesh.X.size(); i += mesh.dim) mesh.X[i] *= thickness;
    for (const LawInfo* each : laws()) {
      const LawInfo& law = *each;
      if ((element.has_mean_volume && !law.has_volume_energy) || !std::isnan(law.only_poissons_ratio))
        continue;
      SCOPED_TRACE(law.name);
      ElasticEnergy energy = make_energy(element, mesh, law);
      const Eigen::MatrixXd H = hessian(mesh, energy, mesh.X, Projection::none);
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(H).eigenvalues();
      EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff()) << "thickness " << thickness;
    }
  }
}

TEST_P(EveryElementEnergy, PassesThePatchTestOnCurvedCells) {
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    const ElasticEnergy energy = make_energy(info, mesh, law);
    Matrix<3> F;
    F << 1.2, 0.3, 0.1, -0.1, 0.9, 0.2, 0.05, -0.15, 1.1;
    VectorX x = mesh.X;
    for (Eigen::Index node = 0; node < x.size() / mesh.dim; ++node)
      x.segment(node * mesh.dim, mesh.dim) =
          F.topLeftCorner(mesh.dim, mesh.dim) * mesh.X.segment(node * mesh.dim, mesh.dim);
    const VectorX g = gradient(energy, x);
    double inner = 0;
    for (Index node = 0; node < static_cast<Index>(x.size() / mesh.dim); ++node)
      if (!mesh.is_on_boundary(node))
        inner = std::max(inner, g.segment(Eigen::Index{node} * mesh.dim, mesh.dim).norm());
    // Quadrature of curved cells is not exact for N_a, but the sum over the cells at an inner node is: the
    // gradients of a shape function that vanishes on the boundary integrate to zero only when the rule holds
    // cof(dX/dxi) dN/dxi, of degree 3 on curved P2 tetrahedra and 2 on triangles and cubes per direction.
    const bool is_integrated = info.degree == 1 || mesh.dim == 2;
    EXPECT_LT(inner, (is_integrated ? 1e-13 : 2e-3) * g.norm());
    if (is_integrated) return;
    const ElasticEnergy finer = make_energy(info, mesh, law, "8-point");
    const VectorX finer_g = gradient(finer, x);
    for (Index node = 0; node < static_cast<Index>(x.size() / mesh.dim); ++node)
      if (!mesh.is_on_boundary(node)) {
        EXPECT_LT(finer_g.segment(Eigen::Index{node} * mesh.dim, mesh.dim).norm(), 1e-13 * finer_g.norm());
      }
  });
}

TEST_P(EveryElementEnergy, GivesTheSameBitsForAnyNumberOfThreads) {
  const int before = num_threads();
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    const VectorX x = mesh.moved(0.01);
    std::vector<double> energies;
    std::vector<VectorX> gradients;
    std::vector<Eigen::MatrixXd> hessians;
    for (const int threads : {1, 2, 3}) {
      set_num_threads(threads);
      ElasticEnergy energy = make_energy(info, mesh, law);
      energies.push_back(energy.value(x, {}));
      gradients.push_back(gradient(energy, x));
      hessians.push_back(hessian(mesh, energy, x, Projection::clamp));
    }
    for (std::size_t i = 1; i < energies.size(); ++i) {
      EXPECT_EQ(energies[i], energies[0]);
      EXPECT_EQ(gradients[i], gradients[0]);
      EXPECT_EQ(hessians[i], hessians[0]);
    }
  });
  set_num_threads(before);
}

TEST_P(EveryElementEnergy, IsTheSameForEveryInstructionSet) {
  for_every_law([](const ElementInfo& info, const ElementMesh& mesh, const LawInfo& law) {
    const VectorX x = mesh.moved(0.01);
    ElasticEnergy energy = make_energy(info, mesh, law);
    const VectorX g = gradient(energy, x);
    const Eigen::MatrixXd H = hessian(mesh, energy, x, Projection::clamp);
    for (const InstructionSet set : available_instruction_sets()) {
      ElasticEnergy other = make_energy(info, mesh, law, "", set);
      EXPECT_LT((gradient(other, x) - g).norm(), 1e-13 * g.norm());
      EXPECT_LT((hessian(mesh, other, x, Projection::clamp) - H).norm(), 1e-11 * H.norm());
    }
  });
}

TEST_P(EveryElementEnergy, TakesRulesWithManyPoints) {
  const ElementMesh mesh(element, 1);
  const LawInfo& law = *find_law("stable_neo_hookean");
  const VectorX x = mesh.moved(0.02);
  for (const std::string& rule : element.quadrature_names()) {
    ElasticEnergy energy = make_energy(element, mesh, law, rule);
    EXPECT_NEAR(energy.total_rest_volume(), 1, 1e-13) << rule;
    const Eigen::MatrixXd H = hessian(mesh, energy, x, Projection::none);
    EXPECT_LT((H - H.transpose()).norm(), 1e-13 * H.norm());
    VectorX p = mesh.moved(1) - mesh.X;
    const double h = 1e-5;
    const VectorX difference = (gradient(energy, x + h * p) - gradient(energy, x - h * p)) / (2 * h);
    EXPECT_LT((H * p - difference).norm(), 1e-6 * difference.norm()) << rule;
  }
}

TEST(InversionBound, HoldsInTheWholeCellWhenAskedFor) {
  // A curved triangle whose corner folds between its quadrature points.
  const ElementInfo& element = *find_element("P2", 2);
  VectorX X(12), x(12);
  X << 0, 0, 1, 0, 0, 1, 0.5, 0, 0.5, 0.5, 0, 0.5;
  x = X;
  x[6] = 0.78;  // beyond three quarters of the edge
  const std::vector<Index> cells = {0, 1, 2, 3, 4, 5};
  const LawInfo& law = *find_law("neo_hookean");
  ElasticEnergy energy(2, "P2", cells, X, law, law.constants_from(hooke));
  EXPECT_TRUE(std::isfinite(energy.value(x, {})));
  EXPECT_EQ(energy.max_step(X, x - X, {}), 1);
  energy.bound_inversion_everywhere();
  const double step = energy.max_step(X, x - X, {});
  EXPECT_GT(step, 0.5);
  EXPECT_LT(step, 0.9);
  const VectorX reached = X + step * (x - X);
  EXPECT_EQ(jacobian_sign(element, std::span(reached.data(), 12)).kind, JacobianSign::Kind::positive);
}

TEST(MeanVolume, PressuresArePredictedToFirstOrder) {
  for (const char* name : {"P2P0", "Q1P0"}) {
    const ElementInfo& element = *find_element(name, 3);
    const ElementMesh mesh(element, 2, 0.05);
    const ElasticEnergy energy = make_energy(element, mesh, *find_law("neo_hookean"));
    const VectorX x = mesh.moved(0.01), p = mesh.moved(1, 7) - mesh.X;
    const double t = 1e-5;
    const VectorX slope = (energy.internal_values(x + t * p) - energy.internal_values(x - t * p)) / (2 * t);
    const VectorX predicted = energy.predicted_internal_values(x, p, 1) - energy.internal_values(x);
    EXPECT_LT((predicted - slope).norm(), 1e-6 * slope.norm()) << name;
  }
}

TEST(MeanVolume, HessianAtTheirOwnPressuresIsTheExactOne) {
  const ElementInfo& element = *find_element("P2P0", 3);
  const ElementMesh mesh(element, 1);
  ElasticEnergy energy = make_energy(element, mesh, *find_law("neo_hookean"));
  const VectorX x = mesh.moved(0.01);
  hessian(mesh, energy, x, Projection::none);  // binds
  BlockPatternBuilder builder(static_cast<Index>(mesh.X.size() / 3));
  energy.add_pattern(builder);
  const auto pattern = std::make_shared<BlockPattern>(builder.build());
  energy.bind(*pattern);
  BlockMatrix exact(3, pattern), carried(3, pattern), other(3, pattern);
  energy.add_hessian(x, {}, Projection::none, exact);
  energy.add_hessian_at(energy.internal_values(x), x, {}, Projection::none, carried);
  energy.add_hessian_at(energy.internal_values(mesh.X), x, {}, Projection::none, other);
  EXPECT_EQ(exact.values, carried.values);
  EXPECT_NE(exact.values, other.values);
}

TEST(MeanVolume, RefusesALawWhoseVolumeEnergyDoesNotStandApart) {
  const ElementInfo& element = *find_element("P2P0", 2);
  const ElementMesh mesh(element, 1);
  EXPECT_THROW(make_energy(element, mesh, *find_law("saint_venant_kirchhoff")), InputError);
}

}  // namespace
}  // namespace resilin
