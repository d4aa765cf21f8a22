#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace resilin::testing {

/// The folder with reference data that does not ship with the repository: $RESILIN_SHARED, else ../shared
/// beside the checkout. Empty when there is none.
std::optional<std::filesystem::path> shared_folder();

/// The repository itself.
std::filesystem::path source_folder();

/// Results and meshes of other programs and closed forms that ship with the tests
/// (tests/reference/README.md).
std::filesystem::path reference_folder();

/// Reads tests/reference/NAME.json.
nlohmann::json read_reference(const std::string& name);

}  // namespace resilin::testing

/// First line of a test that needs data which may not be shipped: without them, the test counts as skipped.
#define RESILIN_NEEDS_SHARED_DATA()         \
  if (!::resilin::testing::shared_folder()) \
  GTEST_SKIP() << "no reference data: set RESILIN_SHARED to the folder that holds them"
