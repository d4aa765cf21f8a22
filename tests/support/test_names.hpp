#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace resilin::testing {

/// A text as the name of a test, which may hold letters, digits and underscores.
inline std::string as_test_name(std::string text) {
  std::ranges::replace_if(text, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return text;
}

/// The number of a parameter, so that all names differ, and how it is printed (by its PrintTo): for values
/// that are no names themselves.
template <class T>
std::string numbered_name(const ::testing::TestParamInfo<T>& entry) {
  return std::to_string(entry.index) + "_" + as_test_name(::testing::PrintToString(entry.param));
}

}  // namespace resilin::testing
