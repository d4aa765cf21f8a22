#include "resilin/results/folder_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

#include "resilin/core/error.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

std::string refusal(const TemporaryFolder& folder) {
  try {
    const FolderLock lock(folder.path());
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

/// A process that takes the folder and waits to be killed.
class Holder {
 public:
  explicit Holder(const TemporaryFolder& folder) {
    int ready[2];
    if (pipe(ready) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      const FolderLock lock(folder.path());
      static_cast<void>(write(ready[1], "x", 1) == 1);
      pause();
      _exit(0);
    }
    char byte = 0;
    static_cast<void>(read(ready[0], &byte, 1) == 1);
    close(ready[0]);
    close(ready[1]);
  }
  ~Holder() { kill_now(); }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;
  void kill_now() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }
  pid_t process() const { return process_; }

 private:
  pid_t process_ = 0;
};

TEST(FolderLock, ExcludesASecondOneAndGoesAwayWithTheFirst) {
  const TemporaryFolder folder;
  std::optional<FolderLock> first(std::in_place, folder.path());
  EXPECT_THAT(refusal(folder), HasSubstr("got one that process " + std::to_string(getpid()) + " on "));
  first.reset();
  EXPECT_FALSE(std::filesystem::exists(folder / "run.lock"));
  EXPECT_EQ(refusal(folder), "");
}

TEST(FolderLock, NamesTheProcessThatHasTheFolder) {
  const TemporaryFolder folder;
  const Holder holder(folder);
  const std::string message = refusal(folder);
  EXPECT_THAT(message, HasSubstr(folder.path().string()));
  EXPECT_THAT(message, HasSubstr("process " + std::to_string(holder.process()) + " on "));
  EXPECT_THAT(message, HasSubstr("since 20"));
  EXPECT_EQ(message.find('\n'), message.npos);
}

TEST(FolderLock, OfAKilledProcessStandsInNobodysWay) {
  const TemporaryFolder folder;
  Holder holder(folder);
  const std::string killed = std::to_string(holder.process());
  holder.kill_now();
  ASSERT_TRUE(std::filesystem::exists(folder / "run.lock"));
  const FolderLock lock(folder.path());
  EXPECT_THAT(lock.previous_holder(), HasSubstr("process " + killed));
  EXPECT_THAT(folder.read("run.lock"), HasSubstr("process " + std::to_string(getpid())));
}

/// The words in the file, true or not, decide nothing: the system knows who holds it.
TEST(FolderLock, IsNotMisledByWhatTheFileSays) {
  for (const std::string& content :
       {std::string(), std::string("process 1 on here since 2020-01-01 00:00:00\n"), std::string(5000, 'x'),
        std::string("\0\x1b[2J\n\n", 7), "process " + std::to_string(getppid()) + " on here\n"}) {
    const TemporaryFolder folder;
    folder.write("run.lock", content);
    EXPECT_EQ(refusal(folder), "");
    EXPECT_FALSE(std::filesystem::exists(folder / "run.lock"));
  }
}

TEST(FolderLock, ThatCannotBeTakenNamesTheFile) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "run.lock");
  EXPECT_THAT(refusal(folder), HasSubstr("run.lock: cannot be written"));
  std::filesystem::remove(folder / "run.lock");
  std::filesystem::create_symlink("/etc/passwd", folder / "run.lock");
  EXPECT_THAT(refusal(folder), HasSubstr("run.lock: cannot be written"));
}

}  // namespace
}  // namespace resilin::testing
