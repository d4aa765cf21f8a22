#include "resilin/io/atomic_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using testing::TemporaryFolder;

std::size_t num_files(const TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()),
                                                std::filesystem::directory_iterator{}));
}

TEST(AtomicFile, ReplacesTheOldContent) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.txt", "old and long");
  write_atomically(path, [](std::ostream& stream) { stream << "new"; });
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(num_files(folder), 1u);
}

TEST(AtomicFile, KeepsTheOldFileWhenWritingFails) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.txt", "old");
  const auto fails = [](std::ostream& stream) {
    stream << "half";
    throw std::runtime_error("stop");
  };
  EXPECT_THROW(write_atomically(path, fails), std::runtime_error);
  EXPECT_EQ(read_file(path), "old");
  EXPECT_THROW(write_atomically(path, [](std::ostream& stream) { stream.setstate(std::ios::badbit); }),
               FileError);
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(num_files(folder), 1u) << "a partial file is left";
}

TEST(AtomicFile, KeepsPermissionsAndFollowsLinks) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.txt", "old");
  std::filesystem::permissions(path,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("a.txt", folder / "link");
  write_atomically(folder / "link", [](std::ostream& stream) { stream << "new"; });
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(std::filesystem::status(path).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST(AtomicFile, SaysWhichPathCannotBeWritten) {
  const TemporaryFolder folder;
  const auto nothing = [](std::ostream&) {};
  for (const auto& path : {folder.path(), folder / "missing/a.txt"}) {
    try {
      write_atomically(path, nothing);
      FAIL() << path;
    } catch (const FileError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(path.string()));
    }
  }
}

TEST(AtomicFile, WritesADeviceDirectlyAndLeavesItADevice) {
  write_atomically("/dev/null", [](std::ostream& stream) { stream << "gone"; });
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(ReadFile, RefusesWhatIsNoRegularFile) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_file(folder.path()), FileError);
  EXPECT_THROW(read_file("/dev/zero"), FileError);
  EXPECT_THROW(read_file(folder / "missing"), FileError);
}

}  // namespace
}  // namespace resilin
