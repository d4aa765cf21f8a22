#include "resilin/energy/elastic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"
#include "sample_body.hpp"

namespace resilin {
namespace {

using testing::Body;
using testing::make_energy;

/// The assembled Hessian as a dense matrix.
struct Assembled {
  std::shared_ptr<BlockPattern> pattern;
  BlockMatrix A;

  Assembled(const Body& body, ElasticEnergy& energy) {
    BlockPatternBuilder builder(static_cast<Index>(body.X.size() / body.dim));
    energy.add_pattern(builder);
    pattern = std::make_shared<BlockPattern>(builder.build());
    A = BlockMatrix(body.dim, pattern);
    A.set_zero();
    energy.bind(*pattern);
  }
  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd D = Eigen::MatrixXd::Zero(A.num_unknowns(), A.num_unknowns());
    const int dim = A.dim;
    for (Index i = 0; i < A.num_nodes(); ++i)
      for (Offset s = pattern->row_begin[static_cast<std::size_t>(i)];
           s < pattern->row_begin[static_cast<std::size_t>(i) + 1]; ++s) {
        const Index j = pattern->columns[static_cast<std::size_t>(s)];
        for (int r = 0; r < dim; ++r)
          for (int c = 0; c < dim; ++c) {
            D(i * dim + r, j * dim + c) = A.block(s)[r * dim + c];
            D(j * dim + c, i * dim + r) = A.block(s)[r * dim + c];
          }
      }
    return D;
  }
};

template <class Check>
void for_every_law_and_dimension(const Check& check) {
  for (const int dim : {2, 3}) {
    const Body body(dim);
    for (const LawInfo* law : laws()) {
      SCOPED_TRACE(std::string(law->name) + " dim " + std::to_string(dim));
      check(body, *law, body.moved(law->needs_positive_J ? 0.008 : 0.06));
    }
  }
}

template <int dim>
Matrix<dim> displacement_gradient(const Body& body, Index cell, const VectorX& x, PointGeometry& geometry) {
  const ElementInfo& element = *find_element("P1", dim);
  std::vector<double> positions;
  for (int a = 0; a <= dim; ++a)
    for (int c = 0; c < dim; ++c)
      positions.push_back(body.X[body.cells[static_cast<std::size_t>(cell * (dim + 1) + a)] * dim + c]);
  geometry = point_geometry(element, element.quadrature("", "quadrature").points[0], positions);
  Matrix<dim> H = Matrix<dim>::Zero();
  for (int a = 0; a <= dim; ++a)
    for (int c = 0; c < dim; ++c)
      for (int k = 0; k < dim; ++k) {
        const Index unknown = body.cells[static_cast<std::size_t>(cell * (dim + 1) + a)] * dim + c;
        H(c, k) += (x[unknown] - body.X[unknown]) * geometry.gradients[static_cast<std::size_t>(a * dim + k)];
      }
  return H;
}

/// Energy, forces and Hessian summed cell by cell from material/derive.hpp.
template <int dim>
struct Plain {
  double energy = 0;
  VectorX forces;
  Eigen::MatrixXd hessian;

  Plain(const Body& body, const Material& material, const VectorX& x, Projection projection) {
    namespace derive = from_displacement_gradient;
    forces = VectorX::Zero(x.size());
    hessian = Eigen::MatrixXd::Zero(x.size(), x.size());
    for (Index cell = 0; cell < static_cast<Index>(body.cells.size()) / (dim + 1); ++cell) {
      PointGeometry geometry;
      const Matrix<dim> H = displacement_gradient<dim>(body, cell, x, geometry);
      energy += geometry.weight * derive::energy_density<dim>(material, H);
      const Matrix<dim> P = derive::first_piola_kirchhoff_stress<dim>(material, H);
      const TangentMatrix<dim> A = derive::stress_tangent<dim>(material, H, projection);
      Eigen::Matrix<double, dim*(dim + 1), dim * dim> G;  // x_a component i -> F_ik by columns
      G.setZero();
      for (int a = 0; a <= dim; ++a)
        for (int i = 0; i < dim; ++i)
          for (int k = 0; k < dim; ++k)
            G(a * dim + i, i + dim * k) = geometry.gradients[static_cast<std::size_t>(a * dim + k)];
      const Eigen::Map<const Eigen::Matrix<double, dim * dim, 1>> p(P.data());
      const Eigen::VectorXd f = geometry.weight * G * p;
      const Eigen::MatrixXd K = geometry.weight * G * A * G.transpose();
      for (int r = 0; r < dim * (dim + 1); ++r) {
        const Index row = body.cells[static_cast<std::size_t>(cell * (dim + 1) + r / dim)] * dim + r % dim;
        forces[row] += f[r];
        for (int c = 0; c < dim * (dim + 1); ++c)
          hessian(row, body.cells[static_cast<std::size_t>(cell * (dim + 1) + c / dim)] * dim + c % dim) +=
              K(r, c);
      }
    }
  }
};

template <int dim>
void expect_like_plain(const Body& body, const LawInfo& law, const VectorX& x, InstructionSet set) {
  ElasticEnergy energy = make_energy(body, law, set);
  for (const Projection projection : {Projection::none, Projection::clamp, Projection::absolute}) {
    const Plain<dim> plain(body, energy.material(0), x, projection);
    EXPECT_NEAR(energy.value(x, {}), plain.energy, 1e-13 * plain.energy);
    VectorX forces = VectorX::Zero(x.size()), magnitude = forces;
    energy.add_gradient(x, {}, forces);
    energy.add_gradient_magnitude(x, {}, magnitude);
    EXPECT_LT((forces - plain.forces).norm(), 1e-13 * magnitude.norm());
    Assembled assembled(body, energy);
    energy.add_hessian(x, {}, projection, assembled.A);
    EXPECT_LT((assembled.dense() - plain.hessian).norm(), 1e-13 * plain.hessian.norm())
        << static_cast<int>(projection);
  }
}

TEST(ElasticEnergy, EqualsThePlainSumOverCellsOnEveryInstructionSet) {
  for (const InstructionSet set : available_instruction_sets()) {
    SCOPED_TRACE(name(set));
    for_every_law_and_dimension([&](const Body& body, const LawInfo& law, const VectorX& x) {
      if (body.dim == 2)
        expect_like_plain<2>(body, law, x, set);
      else
        expect_like_plain<3>(body, law, x, set);
    });
  }
}

TEST(ElasticEnergy, HessianIsTheSlopeOfTheForces) {
  for_every_law_and_dimension([](const Body& body, const LawInfo& law, const VectorX& x) {
    ElasticEnergy energy = make_energy(body, law);
    Assembled assembled(body, energy);
    energy.add_hessian(x, {}, Projection::none, assembled.A);
    const VectorX p = body.moved(1, 5) - body.X;
    const double step = 1e-7;  // step of positions about 0.3 m apart
    VectorX plus = VectorX::Zero(x.size()), minus = plus, product;
    energy.add_gradient(x + step * p, {}, plus);
    energy.add_gradient(x - step * p, {}, minus);
    multiply(assembled.A, p, product);
    EXPECT_LT(((plus - minus) / (2 * step) - product).norm(), 1e-6 * product.norm());
    EXPECT_NEAR((energy.value(x + step * p, {}) - energy.value(x - step * p, {})) / (2 * step),
                (0.5 * (plus + minus)).dot(p),
                1e-5 * std::abs(plus.dot(p)) + 1e-3 * step * plus.norm() * p.norm());
  });
}

TEST(ElasticEnergy, ForcesAndTheirTorquesVanishInSum) {
  for_every_law_and_dimension([](const Body& body, const LawInfo& law, const VectorX& x) {
    ElasticEnergy energy = make_energy(body, law);
    VectorX f = VectorX::Zero(x.size()), size = f;
    energy.add_gradient(x, {}, f);
    energy.add_gradient_magnitude(x, {}, size);
    const auto forces = f.reshaped(body.dim, x.size() / body.dim);
    const VectorX sum = forces.rowwise().sum();
    EXPECT_LT(sum.norm(), 1e-13 * size.sum());
    if (law.kind == LawKind::small_strain) return;  // its forces turn the rest shape, not the deformed one
    const Eigen::MatrixXd moment = forces * x.reshaped(body.dim, x.size() / body.dim).transpose();
    EXPECT_LT((moment - moment.transpose()).norm(), 1e-13 * size.sum() * x.cwiseAbs().maxCoeff());
  });
}

TEST(ElasticEnergy, DifferenceKeepsTheDigitsThatTheValuesLose) {
  for_every_law_and_dimension([](const Body& body, const LawInfo& law, const VectorX& x) {
    const ElasticEnergy energy = make_energy(body, law);
    const VectorX p = body.moved(1e-12, 9) - body.X;
    VectorX f = VectorX::Zero(x.size());
    energy.add_gradient(x, {}, f);
    const VectorX to = x + p;
    const double slope = f.dot(to - x);  // the step that was really made, after rounding
    EXPECT_NEAR(energy.difference(x, to, {}), slope, 1e-4 * f.norm() * p.norm());
    EXPECT_EQ(energy.difference(x, x, {}), 0);
  });
}

TEST(ElasticEnergy, GivesTheSameBitsForAnyNumberOfThreads) {
  const int before = num_threads();
  for_every_law_and_dimension([](const Body& body, const LawInfo& law, const VectorX& x) {
    std::vector<VectorX> forces;
    std::vector<std::vector<double>> values;
    std::vector<double> energies;
    for (const int threads : {1, 2, 5}) {
      set_num_threads(threads);
      ElasticEnergy energy = make_energy(body, law);
      Assembled assembled(body, energy);
      energy.add_hessian(x, {}, Projection::clamp, assembled.A);
      forces.push_back(VectorX::Zero(x.size()));
      energy.add_gradient(x, {}, forces.back());
      values.push_back(assembled.A.values);
      energies.push_back(energy.value(x, {}));
    }
    for (std::size_t i = 1; i < forces.size(); ++i) {
      EXPECT_EQ(energies[i], energies[0]);
      EXPECT_TRUE((forces[i].array() == forces[0].array()).all());
      EXPECT_EQ(values[i], values[0]);
    }
  });
  set_num_threads(before);
}

TEST(ElasticEnergy, CellsKeepTheirOwnConstants) {
  const Body body(3);
  const LawInfo& law = *find_law("neo_hookean");
  const auto soft = law.constants_from(hooke_from_young_poisson(1e5, 0.3));
  std::vector<double> constants;
  for (std::size_t cell = 0; cell < body.cells.size() / 4; ++cell)
    for (const double c : soft) constants.push_back(c * (1 + static_cast<double>(cell)));
  const ElasticEnergy energy(3, "P1", body.cells, body.X, law, constants);
  const VectorX x = body.moved(0.008);
  const auto densities = energy.energy_densities(x), volumes = energy.rest_volumes();
  const ElasticEnergy uniform(3, "P1", body.cells, body.X, law, soft);
  const auto uniform_densities = uniform.energy_densities(x);
  double sum = 0;
  for (std::size_t cell = 0; cell < densities.size(); ++cell) {
    EXPECT_NEAR(densities[cell], (1 + static_cast<double>(cell)) * uniform_densities[cell],
                1e-12 * densities[cell]);
    sum += densities[cell] * volumes[cell];
  }
  EXPECT_NEAR(energy.value(x, {}), sum, 1e-13 * sum);
}

TEST(ElasticEnergy, IsInfiniteWhenACellInvertsAndOnlyItsForcesAreUndefined) {
  const Body body(3);
  const ElasticEnergy energy = make_energy(body, *find_law("neo_hookean"));
  VectorX x = body.X;
  const Index node = body.cells[0];
  x.segment(3 * node, 3) += Vector3(0.5, 0, 0);
  EXPECT_EQ(energy.value(x, {}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(energy.difference(body.X, x, {}), std::numeric_limits<double>::infinity());
  EXPECT_LE(energy.min_volume_ratio(x).ratio, 0);
  VectorX f = VectorX::Zero(x.size());
  energy.add_gradient(x, {}, f);
  EXPECT_TRUE(std::isnan(f[3 * node]));
  EXPECT_TRUE(f.array().isFinite().any());
}

TEST(ElasticEnergy, StepBoundNeverLetsACellInvert) {
  for (const int dim : {2, 3}) {
    const Body body(dim);
    const ElasticEnergy energy = make_energy(body, *find_law("neo_hookean"));
    for (unsigned seed = 0; seed < 200; ++seed) {
      const VectorX x = body.moved(0.008, 2 * seed);
      const double size = std::pow(10.0, static_cast<double>(seed % 7) - 3);
      const VectorX p = size * (body.moved(1, 2 * seed + 1) - body.X);
      const double step = energy.max_step(x, p, {});
      ASSERT_GT(step, 0);
      ASSERT_LE(step, 1);
      const auto before = energy.volume_ratios(x);
      for (const double part : {0.3, 0.7, 0.95, 1.0}) {
        const auto after = energy.volume_ratios(x + part * step * p);
        for (std::size_t cell = 0; cell < after.size(); ++cell)
          ASSERT_GT(after[cell], 0.0999 * before[cell]) << "seed " << seed << " step " << step;
      }
      if (step < 1) {  // and it does not stop early: a little further some cell has lost nine tenths
        const auto after = energy.volume_ratios(x + 1.001 * step * p);
        bool some_is_lost = false;
        for (std::size_t cell = 0; cell < after.size(); ++cell)
          some_is_lost |= after[cell] < 0.1001 * before[cell];
        EXPECT_TRUE(some_is_lost) << "seed " << seed << " step " << step;
      }
    }
  }
  const Body body(3);
  EXPECT_EQ(make_energy(body, *find_law("stable_neo_hookean")).max_step(body.X, 100 * body.moved(1), {}), 1);
}

TEST(ElasticEnergy, RefusesACellWithoutPositiveVolume) {
  Body body(3);
  std::swap(body.cells[4], body.cells[5]);
  EXPECT_THROW(make_energy(body, *find_law("neo_hookean")), InputError);
  body.cells[4] = 100000;
  EXPECT_THROW(make_energy(body, *find_law("neo_hookean")), InputError);
}

/// Two cells with a direction each are not one cell with two families.
TEST(ElasticEnergy, TellsDirectionsOfCellsFromFamilies) {
  VectorX X(8);
  X << 0, 0, 1, 0, 1, 1, 0, 1;
  const std::vector<Index> cells = {0, 1, 2, 0, 2, 3}, first = {0, 1, 2}, second = {0, 2, 3};
  const LawInfo& law = *find_law("holzapfel_gasser_ogden");
  const auto constants = law.constants_from(hooke_from_young_poisson(1e5, 0.3));
  const Vector3 a(1, 0, 0), b(0, 1, 0);
  const auto value = [&](const std::vector<Index>& some, const FibreDirections& fibres) {
    return ElasticEnergy(2, "P1", some, X, law, constants, fibres).value(1.2 * X, {});
  };
  const double expected = value(first, {{a}, 1}) + value(second, {{b}, 1});
  EXPECT_NEAR(value(cells, {{a, b}, 1}), expected, 1e-12 * expected);
  EXPECT_GT(value(cells, {{a, b}, 2}), 1.02 * expected);
  EXPECT_THROW(value(cells, {{a, b, a}, 1}), InputError);
  EXPECT_THROW(value(cells, {}), InputError);
}

TEST(ElasticEnergy, ReportsCauchyStressAndItsVonMisesMeasure) {
  const Body body(2);
  const ElasticEnergy energy = make_energy(body, *find_law("neo_hookean"));
  VectorX x = body.X;
  for (Eigen::Index i = 0; i < x.size(); i += 2) x[i] *= 1.2;  // uniaxial strain
  const Material material = energy.material(0);
  Matrix<2> F = Matrix<2>::Identity();
  F(0, 0) = 1.2;
  const double mu = material.constants[0], lambda = material.constants[1];
  // Neo-Hookean: sigma = (mu (b - I) + lambda ln J I) / J
  const double sigma_11 = (mu * 0.44 + lambda * std::log(1.2)) / 1.2, sigma_33 = lambda * std::log(1.2) / 1.2;
  for (const Matrix<3>& stress : energy.cauchy_stresses(x)) {
    EXPECT_NEAR(stress(0, 0), sigma_11, 1e-11 * sigma_11);
    EXPECT_NEAR(stress(1, 1), sigma_33, 1e-11 * sigma_11);
    EXPECT_NEAR(stress(2, 2), sigma_33, 1e-11 * sigma_11);
  }
  for (const double measure : energy.von_mises_stresses(x))
    EXPECT_NEAR(measure, sigma_11 - sigma_33, 1e-11 * sigma_11);
  for (const double J : energy.volume_ratios(x)) EXPECT_NEAR(J, 1.2, 1e-14);
}

}  // namespace
}  // namespace resilin
