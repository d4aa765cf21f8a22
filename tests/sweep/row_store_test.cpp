#include "resilin/sweep/row_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sweep_scenes.hpp"

namespace resilin::testing {
namespace {

std::string line_of(const SceneHash& hash, const std::string& status, const std::string& more = "") {
  return "{\"hash\":\"" + hash.text() + "\",\"status\":\"" + status + "\",\"reason\":\"" + more + "\"}\n";
}

SceneHash hash(std::uint64_t number) { return scene_hash_of(std::to_string(number)); }

void append_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::app | std::ios::binary) << bytes;
}

TEST(RowStore, FindsWhatItAndOthersHaveAdded) {
  const TemporaryFolder folder;
  RowStore first(folder / "rows"), second(folder / "rows");
  first.append(line_of(hash(1), "done"));
  EXPECT_FALSE(second.find(hash(1)));
  second.refresh();
  ASSERT_TRUE(second.find(hash(1)));
  EXPECT_FALSE(second.find(hash(1))->is_old);
  EXPECT_EQ(second.line(hash(1)) + "\n", line_of(hash(1), "done"));
  second.append(line_of(hash(2), "refused"));
  first.append(line_of(hash(3), "done"));
  first.refresh();
  EXPECT_EQ(first.find(hash(2))->status, SceneStatus::refused);
  EXPECT_EQ(first.line(hash(3)) + "\n", line_of(hash(3), "done"));
  const RowStore third(folder / "rows");
  EXPECT_TRUE(third.find(hash(3))->is_old);
}

TEST(RowStore, PassesOverLinesThatAreNotWhole) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "rows");
  const std::string whole = line_of(hash(1), "done");
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    std::filesystem::remove(folder / "rows" / "9-0.jsonl");
    append_bytes(folder / "rows" / "9-0.jsonl", line_of(hash(2), "done") + whole.substr(0, size));
    const RowStore store(folder / "rows");
    EXPECT_TRUE(store.find(hash(2)));
    EXPECT_EQ(store.find(hash(1)).has_value(), size == whole.size()) << size;
  }
  append_bytes(folder / "rows" / "9-0.jsonl", std::string(100, '\0') + "\n{}\n\n" + line_of(hash(3), "odd"));
  EXPECT_FALSE(RowStore(folder / "rows").find(hash(3)));
}

TEST(RowStore, ReadsALineOnceItIsWhole) {
  const TemporaryFolder folder;
  RowStore store(folder / "rows");
  const std::string whole = line_of(hash(1), "done");
  append_bytes(folder / "rows" / "9-0.jsonl", whole.substr(0, 50));
  store.refresh();
  EXPECT_FALSE(store.find(hash(1)));
  append_bytes(folder / "rows" / "9-0.jsonl", whole.substr(50) + line_of(hash(2), "done"));
  store.refresh();
  EXPECT_EQ(store.line(hash(1)) + "\n", whole);
  EXPECT_TRUE(store.find(hash(2)));
}

TEST(RowStore, PrefersWhatIsDoneAndElseWhatIsNewer) {
  const TemporaryFolder folder;
  RowStore store(folder / "rows");
  store.append(line_of(hash(1), "refused", "a"));
  store.append(line_of(hash(1), "failed", "b"));
  EXPECT_EQ(store.find(hash(1))->status, SceneStatus::failed);
  store.append(line_of(hash(1), "done", "c"));
  store.append(line_of(hash(1), "failed", "d"));
  EXPECT_EQ(store.line(hash(1)) + "\n", line_of(hash(1), "done", "c"));
}

TEST(RowStore, FindsEachOfMany) {
  const TemporaryFolder folder;
  constexpr std::uint64_t count = 30000;
  {
    RowStore store(folder / "rows");
    for (std::uint64_t i = 0; i < count; ++i) store.append(line_of(hash(i), i % 7 == 0 ? "failed" : "done"));
    for (std::uint64_t i = 0; i < count; i += 7) store.append(line_of(hash(i), "done", "again"));
    EXPECT_EQ(store.line(hash(7)) + "\n", line_of(hash(7), "done", "again"));
  }
  const RowStore store(folder / "rows");
  for (std::uint64_t i = 0; i < count; ++i) {
    ASSERT_TRUE(store.find(hash(i))) << i;
    ASSERT_EQ(store.find(hash(i))->status, SceneStatus::done) << i;
  }
  EXPECT_FALSE(store.find(hash(count)));
  EXPECT_EQ(store.line(hash(14)) + "\n", line_of(hash(14), "done", "again"));
}

}  // namespace
}  // namespace resilin::testing
