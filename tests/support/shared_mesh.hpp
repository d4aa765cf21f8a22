#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "shared_data.hpp"

namespace resilin::testing {

/// A mesh of another project: from data/ if it ships with the repository, else from the folder of data that
/// may not be shipped. Empty where neither has it.
inline std::optional<std::filesystem::path> shared_mesh(const std::string& name) {
  const std::filesystem::path shipped = source_folder() / "data" / name;
  if (std::filesystem::exists(shipped)) return shipped;
  if (!shared_folder()) return std::nullopt;
  return *shared_folder() / "meshes" / name;
}

}  // namespace resilin::testing

/// First line of a test of a mesh: without the mesh, the test counts as skipped.
#define RESILIN_NEEDS_SHARED_MESH(name)       \
  if (!::resilin::testing::shared_mesh(name)) \
  GTEST_SKIP() << "no " << (name) << ": set RESILIN_SHARED to the folder that holds it"
