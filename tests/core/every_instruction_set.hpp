#pragma once

#include <gtest/gtest.h>

#include <string>

#include "lanes_probe.hpp"
#include "resilin/core/cpu.hpp"

namespace resilin::testing {

/// A test that runs once for each instruction set of this processor.
struct EveryInstructionSet : ::testing::TestWithParam<InstructionSet> {
  const LanesProbe& probe = lanes_probe(GetParam());
};

inline std::string name_of_set(const ::testing::TestParamInfo<InstructionSet>& info) {
  return std::string(name(info.param));
}

}  // namespace resilin::testing
