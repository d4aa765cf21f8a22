#pragma once

#include <filesystem>
#include <string>

namespace resilin::testing {

/// An empty folder that no other test has; it goes away with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Makes a file with this content.
  std::filesystem::path write(const std::string& name, const std::string& content) const;
  /// The content of a file.
  std::string read(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

}  // namespace resilin::testing
