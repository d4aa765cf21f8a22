#include "resilin/io/atomic_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

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

TEST(AtomicFile, SweepsUpWhatAProcessThatIsGoneHasLeft) {
  const TemporaryFolder folder;
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  waitpid(gone, nullptr, 0);
  const std::string half = ".partial." + std::to_string(gone) + ".";
  const std::vector<std::string> left = {"a.txt" + half + "0", "a.txt" + half + "17"};
  const std::vector<std::string> others = {"b.txt" + half + "0",  // a partial file of another file
                                           "a.txt.partial." + std::to_string(getppid()) + ".0",
                                           "a.txt.partial.x.0", "a.txt" + half + "0.txt", "a.txt.partial"};
  for (const std::string& name : left) folder.write(name, "half");
  for (const std::string& name : others) folder.write(name, "whole");
  write_atomically(folder / "a.txt", [](std::ostream& stream) { stream << "new"; });
  for (const std::string& name : left) EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  for (const std::string& name : others) EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
}

TEST(AtomicFile, SaysThatTheDiskIsFullWhenItIsAndOnlyThen) {
  const auto message = [](const std::filesystem::path& path, std::size_t size) -> std::string {
    try {
      write_atomically(path, [size](std::ostream& stream) { stream << std::string(size, 'x'); });
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  };
  for (const std::size_t size : {1, 70000, 1000000})  // less and more than is buffered
    EXPECT_EQ(message("/dev/full", size), "/dev/full: cannot be written: the disk is full") << size;
  const TemporaryFolder folder;
  EXPECT_EQ(message(folder / "missing/a.txt", 1),
            (folder / "missing/a.txt").string() + ": cannot be written: No such file or directory");
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
