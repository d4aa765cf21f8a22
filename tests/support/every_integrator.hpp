#pragma once

#include <gtest/gtest.h>

#include <string>

#include "resilin/integrator/integrator.hpp"

namespace resilin::testing {

/// A test that runs once for each scheme of the catalogue:
///   INSTANTIATE_TEST_SUITE_P(Catalogue, MyTest, ::testing::ValuesIn(integrator_names()),
///   name_of_integrator);
struct WithEveryIntegrator : ::testing::TestWithParam<std::string> {
  const std::string integrator = GetParam();
};

inline std::string name_of_integrator(const ::testing::TestParamInfo<std::string>& entry) {
  return entry.param;
}

}  // namespace resilin::testing
