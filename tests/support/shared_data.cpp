#include "shared_data.hpp"

#include <cstdlib>
#include <fstream>

namespace resilin::testing {

std::filesystem::path source_folder() { return RESILIN_SOURCE_DIR; }

std::optional<std::filesystem::path> shared_folder() {
  const char* variable = std::getenv("RESILIN_SHARED");
  const std::filesystem::path folder =
      variable != nullptr ? std::filesystem::path(variable) : source_folder().parent_path() / "shared";
  if (!std::filesystem::is_directory(folder / "validation")) return std::nullopt;
  return folder;
}

std::filesystem::path reference_folder() { return source_folder() / "tests" / "reference"; }

nlohmann::json read_reference(const std::string& name) {
  std::ifstream file(reference_folder() / (name + ".json"));
  return nlohmann::json::parse(file);
}

}  // namespace resilin::testing
