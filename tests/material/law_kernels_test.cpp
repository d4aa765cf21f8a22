// The laws compiled for the instruction sets of this machine against the baseline, whose values other tests
// compare with truth.
#include "resilin/material/kernels/law_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "resilin/material/batch.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

/// Result of a batch: energies, stresses, tangents and the derivatives by every constant.
template <int dim>
std::vector<double> everything_of(const Material& material, const std::vector<double>& H,
                                  InstructionSet set) {
  const std::size_t count = H.size() / (dim * dim);
  StateBatch<double> states{.law = material.law,
                            .dim = dim,
                            .count = count,
                            .deformation_gradients = H.data(),
                            .holds_displacement_gradients = true,
                            .constants = {},
                            .instruction_set = set};
  for (const double& constant : material.constants) states.constants.push_back({&constant, 0});
  if (!material.fibres.empty()) states.fibres = material.fibres.front().data();
  states.num_fibres = material.fibres.size();

  constexpr std::size_t n = dim * dim;
  std::vector<double> all, part(count);
  const auto add = [&](std::size_t size, const auto& evaluate) {
    part.assign(size, 0);
    evaluate(part.data());
    all.insert(all.end(), part.begin(), part.end());
  };
  add(count, [&](double* out) { energy_densities(states, out); });
  add(count * n, [&](double* out) { first_piola_kirchhoff_stresses(states, out); });
  for (const Projection projection : {Projection::none, Projection::clamp, Projection::absolute})
    add(count * n * n, [&](double* out) { stress_tangents(states, projection, out); });
  for (std::size_t p = 0; p < material.constants.size(); ++p) {
    add(count, [&](double* out) { constant_derivatives<double>(states, p, out, nullptr); });
    add(count * n, [&](double* out) { constant_derivatives<double>(states, p, nullptr, out); });
  }
  return all;
}

template <int dim>
void expect_the_same_everywhere(const LawInfo& law) {
  const Material material = testing::sample_material(law);
  std::vector<double> H;
  for (const Matrix<dim>& sample : testing::sample_gradients<dim>(law))
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) H.push_back(sample(i, k));
  const std::vector<double> expected = everything_of<dim>(material, H, available_instruction_sets().front());
  for (const InstructionSet set : available_instruction_sets()) {
    const std::vector<double> got = everything_of<dim>(material, H, set);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double scale = std::abs(expected[i]) + 100 * testing::sample_hooke().mu;
      if (std::isnan(expected[i])) {
        ASSERT_TRUE(std::isnan(got[i])) << law.name << " " << name(set) << " dim " << dim << " at " << i;
      } else if (std::isinf(expected[i])) {
        ASSERT_EQ(got[i], expected[i]) << law.name << " " << name(set);
      } else {
        ASSERT_NEAR(got[i], expected[i], 1e-11 * scale)  // condition of the states times round-off
            << law.name << " " << name(set) << " dim " << dim << " at " << i;
      }
    }
  }
}

TEST(LawKernels, GiveTheSameOnEveryInstructionSet) {
  for (const LawInfo* law : laws()) {
    expect_the_same_everywhere<2>(*law);
    expect_the_same_everywhere<3>(*law);
  }
}

/// A constant of a law, and the energy density of a state as a function of it.
template <int dim>
double energy_with(Material material, std::size_t p, double value, const Matrix<dim>& H) {
  material.constants[p] = value;
  return from_displacement_gradient::energy_density<dim>(material, H);
}

template <int dim>
void check_constant_derivatives(const LawInfo& law) {
  const Material material = testing::sample_material(law);
  for (const Matrix<dim>& H : testing::sample_gradients<dim>(law, 12)) {
    const Eigen::Matrix<double, dim, dim, Eigen::RowMajor> rows = H;
    StateBatch<double> states{.law = &law,
                              .dim = dim,
                              .count = 1,
                              .deformation_gradients = rows.data(),
                              .holds_displacement_gradients = true,
                              .constants = {}};
    for (const double& constant : material.constants) states.constants.push_back({&constant, 0});
    if (!material.fibres.empty()) states.fibres = material.fibres.front().data();
    states.num_fibres = material.fibres.size();
    const double psi = from_displacement_gradient::energy_density<dim>(material, H);
    if (!std::isfinite(psi)) continue;
    const Matrix<dim> P = from_displacement_gradient::first_piola_kirchhoff_stress<dim>(material, H);
    for (std::size_t p = 0; p < material.constants.size(); ++p) {
      const double value = material.constants[p], step = 1e-5 * (std::abs(value) + 1e-3);
      // Central differences: the error is about step^2 and round-off over step.
      const double plus = energy_with<dim>(material, p, value + step, H),
                   minus = energy_with<dim>(material, p, value - step, H);
      const double scale = (std::abs(psi) + testing::sample_hooke().mu) / (std::abs(value) + 1e-3);
      double dpsi, second;
      Eigen::Matrix<double, dim, dim, Eigen::RowMajor> dP;
      constant_derivatives(states, p, &dpsi, dP.data());
      EXPECT_NEAR(dpsi, (plus - minus) / (2 * step), 1e-7 * scale)
          << law.name << " " << law.constants[p].name << "\n"
          << H;
      Material up = material, down = material;
      up.constants[p] += step;
      down.constants[p] -= step;
      const Matrix<dim> slope = (from_displacement_gradient::first_piola_kirchhoff_stress<dim>(up, H) -
                                 from_displacement_gradient::first_piola_kirchhoff_stress<dim>(down, H)) /
                                (2 * step);
      EXPECT_LT((dP - slope).norm(), 1e-7 * (scale + P.norm() / (std::abs(value) + 1e-3)))
          << law.name << " " << law.constants[p].name << "\n"
          << H;
      for (std::size_t q = 0; q < material.constants.size(); ++q) {
        second_constant_derivatives(states, p, q, &second);
        const auto slope_at = [&](double sign) {
          Material moved = material;
          const double far = 1e-5 * (std::abs(material.constants[q]) + 1e-3);
          moved.constants[q] += sign * far;
          StateBatch<double> there = states;
          there.constants.clear();
          for (const double& constant : moved.constants) there.constants.push_back({&constant, 0});
          double result;
          constant_derivatives<double>(there, p, &result, nullptr);
          return result / far;
        };
        EXPECT_NEAR(second, (slope_at(1) - slope_at(-1)) / 2,
                    1e-6 * scale / (std::abs(material.constants[q]) + 1e-3))
            << law.name << " " << law.constants[p].name << " " << law.constants[q].name;
      }
    }
  }
}

TEST(LawKernels, DerivativesByTheConstantsAreThoseOfTheEnergyAndOfTheStress) {
  for (const LawInfo* law : laws()) {
    check_constant_derivatives<2>(*law);
    check_constant_derivatives<3>(*law);
  }
}

}  // namespace
}  // namespace resilin
