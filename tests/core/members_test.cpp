#include "resilin/core/members.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <string>
#include <vector>

#include "resilin/core/archive.hpp"

namespace resilin::testing {

struct Screw {
  double length;  // [m]
  int turns;
  std::string kind;
};
struct Nothing {};
struct Box {
  std::vector<Screw> screws;
};

RESILIN_MEMBERS(Screw, length, turns, kind)
RESILIN_MEMBERS(Box, screws)

namespace {

TEST(Members, AreVisitedInTheirOrderUnderTheirNames) {
  const Screw screw{0.02, 7, "wood"};
  std::string seen;
  visit_members(screw, [&](std::string_view name, const auto& value) {
    seen += std::string(name) + " of " + std::to_string(sizeof(value)) + " bytes, ";
  });
  EXPECT_EQ(seen, "length of 8 bytes, turns of 4 bytes, kind of " + std::to_string(sizeof(std::string)) +
                      " bytes, ");
}

TEST(Members, CanBeChangedWhereTheyAreVisited) {
  Screw screw{0.02, 7, "wood"};
  visit_members(screw, [](std::string_view name, auto& value) {
    if constexpr (std::is_same_v<decltype(value), int&>) value = static_cast<int>(name.size());
  });
  EXPECT_EQ(screw.turns, 5);
}

TEST(Members, AreKnownOfStructsThatSaidSo) {
  EXPECT_TRUE(HasMembers<Screw> && HasMembers<const Box>);
  EXPECT_FALSE(HasMembers<Nothing> || HasMembers<double>);
}

TEST(Archive, GivesBackWhatItTook) {
  const Box box{{{0.1, 1, "a"}, {-0.0, -2, ""}}};
  ArchiveWriter writer;
  writer(box);
  const std::string bytes = writer.take();
  Box again;
  ArchiveReader reader(bytes, "box");
  reader(again);
  EXPECT_NO_THROW(reader.end());
  ASSERT_EQ(again.screws.size(), 2U);
  EXPECT_EQ(again.screws[0].kind, "a");
  EXPECT_TRUE(std::signbit(again.screws[1].length));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ArchiveReader cut(std::string_view(bytes).substr(0, size), "box");
    EXPECT_THROW(cut(again), InputError) << size;
  }
}

}  // namespace
}  // namespace resilin::testing
