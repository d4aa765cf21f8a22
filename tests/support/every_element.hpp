#pragma once

#include <gtest/gtest.h>

#include <string>

#include "resilin/element/catalog.hpp"

namespace resilin {

/// A test that runs once for each element of the catalogue:
///   INSTANTIATE_TEST_SUITE_P(Catalogue, MyTest, ::testing::ValuesIn(elements()), name_of_element);
struct OnEveryElement : ::testing::TestWithParam<const ElementInfo*> {
  const ElementInfo& element = *GetParam();
};

/// "P2_3d": a test's name may hold letters, digits and underscores.
inline std::string name_of_element(const ::testing::TestParamInfo<const ElementInfo*>& entry) {
  return std::string(entry.param->name) + "_" + std::to_string(entry.param->dim) + "d";
}

}  // namespace resilin
