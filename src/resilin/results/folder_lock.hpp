#pragma once

#include <filesystem>
#include <string>

namespace resilin {

/// A folder of results that this process alone writes into, as long as this lives.
///
/// `run.lock` in the folder says which process holds it and since when. The system ties the hold to the
/// process (flock): it ends with it, however the process ends, so that a file left by a killed run stands in
/// nobody's way; nobody is misled by a process number that has been given out again, or that means another
/// process in another container. Two runs of one process exclude each other as well.
class FolderLock {
 public:
  /// Takes the folder, which exists. Throws FileError, with the process that has it, when another run does.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// The process that has left the folder without giving it back, in words; empty when none has.
  const std::string& previous_holder() const { return previous_holder_; }

 private:
  std::filesystem::path path_;
  std::string previous_holder_;
  int descriptor_ = -1;
};

}  // namespace resilin
