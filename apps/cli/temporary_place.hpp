#pragma once

#include <filesystem>
#include <string>

namespace resilin::cli {

/// A folder of its own among the system's temporary files, which goes with what is in it.
class TemporaryPlace {
 public:
  /// @param purpose  the beginning of its name
  explicit TemporaryPlace(const std::string& purpose);
  ~TemporaryPlace();
  TemporaryPlace(const TemporaryPlace&) = delete;
  TemporaryPlace& operator=(const TemporaryPlace&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace resilin::cli
