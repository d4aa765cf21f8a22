#include "fit_laws.hpp"

#include <cmath>
#include <random>
#include <tuple>

#include "clock.hpp"
#include "resilin/fit/fit_report.hpp"
#include "resilin/fit/law_choice.hpp"

namespace resilin::bench {
namespace {

/// Ogden's rubber of 1972 with an error of 2 % and 2 kPa.
FitDescription rubber_tests() {
  const LawInfo& law = require_law("ogden", "law");
  const std::vector<double> constants = {0.63e6, 1.3, 0.0012e6, 5, -0.01e6, -2, 0};
  std::mt19937 random(1944);
  std::normal_distribution<double> normal;
  FitDescription description;
  for (const auto& [mode, end, count] :
       {std::tuple(TestMode::uniaxial, 7.6, 24), std::tuple(TestMode::planar, 5.0, 13),
        std::tuple(TestMode::equibiaxial, 4.4, 16)}) {
    MaterialTest test;
    test.mode = mode;
    test.place = test.name = std::string(spellings(mode)[static_cast<std::size_t>(mode)]);
    test.has_unit = true;
    std::vector<LoadedState> states;
    for (int i = 1; i <= count; ++i)
      states.push_back({mode, 1 + (end - 1) * std::pow(i / double(count), 1.3)});
    const VectorX stress = HomogeneousModel(law, false, states).stresses(constants);
    for (std::size_t i = 0; i < states.size(); ++i) {
      const double exact = stress[static_cast<Eigen::Index>(i)];
      test.load.push_back(states[i].load);
      test.stress.push_back(exact * (1 + 0.02 * normal(random)) + 2e3 * normal(random));
    }
    description.tests.push_back(test);
  }
  return description;
}

}  // namespace

std::vector<Measurement> measure_fits() {
  constexpr int num_calls = 11;
  FitDescription description = rubber_tests();
  std::vector<Measurement> measurements;
  for (const std::string& law : usual_fit_laws()) {
    description.laws = {law};
    measurements.emplace_back(law + ", ms",
                              1e3 * median_wall_seconds(num_calls, [&] { fit_materials(description); }));
  }
  description.laws.clear();
  measurements.emplace_back("all six, ms",
                            1e3 * median_wall_seconds(num_calls, [&] { fit_materials(description); }));
  return measurements;
}

}  // namespace resilin::bench
