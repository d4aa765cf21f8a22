#include "temporary_place.hpp"

#include <stdlib.h>  // mkdtemp

#include <system_error>

#include "resilin/core/error.hpp"

namespace resilin::cli {

TemporaryPlace::TemporaryPlace(const std::string& purpose) {
  std::string name =
      (std::filesystem::temp_directory_path() / (purpose + "-")).string() + std::string(6, 'X');
  if (mkdtemp(name.data()) == nullptr) throw FileError(name, "no temporary folder can be made");
  path_ = name;
}

TemporaryPlace::~TemporaryPlace() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace resilin::cli
