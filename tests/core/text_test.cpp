#include "resilin/core/text.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <clocale>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/core/log.hpp"

namespace resilin {
namespace {

using Words = std::vector<std::string>;

TEST(Join, PutsTheSeparatorBetweenAllWords) {
  EXPECT_EQ(join(Words{}), "");
  EXPECT_EQ(join(Words{"a"}), "a");
  EXPECT_EQ(join(Words{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(join(Words{"", "b", ""}, "|"), "|b|");
}

TEST(NearestWord, IsTheOneWithTheFewestChangedLetters) {
  const Words words = {"density", "poissons_ratio", "shear_modulus", "youngs_modulus"};
  EXPECT_EQ(nearest_word("density", words), "density");
  EXPECT_EQ(nearest_word("densty", words), "density");
  EXPECT_EQ(nearest_word("young_modulus", words), "youngs_modulus");
  EXPECT_EQ(nearest_word("poisson_ratio", words), "poissons_ratio");
  EXPECT_EQ(nearest_word("modulus", Words{"modules", "modulus_"}), "modules");  // the first of equals
}

TEST(NearestWord, IsNoneWhereNothingIsMeant) {
  const Words words = {"at", "box", "group", "plane"};
  EXPECT_EQ(nearest_word("temperature", words), "");
  EXPECT_EQ(nearest_word("xy", words), "") << "every letter is another";
  EXPECT_EQ(nearest_word("q", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("bx", words), "box");
  EXPECT_EQ(nearest_word("anything", Words{}), "");
}

TEST(RefuseWord, NamesPlaceWordsAndTheNearest) {
  const auto message = [](const std::string& word) -> std::string {
    try {
      refuse_word("scene.toml:3: kind", word, Words{"box", "plane"});
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(message("plan"),
            "scene.toml:3: kind: expected one of box, plane, got \"plan\"; did you mean \"plane\"?");
  EXPECT_EQ(message("temperature"), "scene.toml:3: kind: expected one of box, plane, got \"temperature\"");
}

double read(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

TEST(FormatNumber, ReadsBackAsTheSameBits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (std::isfinite(value)) {
      EXPECT_EQ(read(format_number(value)), value);
    }
  }
  for (const double value : {0.1, 1e-310, 1.0 / 3, 5e-324, std::numeric_limits<double>::max()})
    EXPECT_EQ(read(format_number(value)), value);
  EXPECT_TRUE(std::signbit(read(format_number(-0.0))));
}

TEST(FormatNumber, IsAsShortAsItMayBe) {
  EXPECT_EQ(format_number(0.1), "0.1");
  EXPECT_EQ(format_number(1024), "1024");
  EXPECT_EQ(format_number(100000), "1e+05");
  EXPECT_EQ(format_number(1e22), "1e+22");
  EXPECT_EQ(format_number(-2.5), "-2.5");
}

TEST(FormatShort, HasThreeDigits) {
  EXPECT_EQ(format_fixed(0.5, 2), "0.50");
  EXPECT_EQ(format_fixed(-1.2, 1),
            "\xE2\x88\x92"
            "1.2");
  EXPECT_EQ(format_fixed(-0.001, 2), "0.00");
  EXPECT_EQ(format_short(0.0123456), "0.0123");
  EXPECT_EQ(format_short(1.23456e-9), "1.23e-09");
  EXPECT_EQ(format_short(2), "2");
  EXPECT_EQ(format_short(-1234567), "-1.23e+06");
  EXPECT_EQ(format_short(999.6), "1e+03");
}

TEST(FormatNumbers, HaveAPointWhateverTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "C"}) {
    if (std::setlocale(LC_ALL, locale) == nullptr) continue;
    EXPECT_EQ(format_number(0.5), "0.5");
    EXPECT_EQ(format_short(0.5), "0.5");
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST(FormatBytes, HasThreeDigitsAtMostInStepsOfAThousand) {
  const std::vector<std::pair<std::uintmax_t, std::string>> cases = {{0, "0 B"},
                                                                     {512, "512 B"},
                                                                     {999, "999 B"},
                                                                     {1000, "1 kB"},
                                                                     {9994, "9.99 kB"},
                                                                     {9996, "10 kB"},
                                                                     {34000, "34 kB"},
                                                                     {34040, "34 kB"},
                                                                     {99960, "100 kB"},
                                                                     {999499, "999 kB"},
                                                                     {999500, "1 MB"},
                                                                     {5600000, "5.6 MB"},
                                                                     {123456789, "123 MB"},
                                                                     {7890000000, "7.89 GB"},
                                                                     {1500000000000, "1.5 TB"},
                                                                     {UINTMAX_MAX, "18.4 EB"}};
  for (const auto& [count, text] : cases) EXPECT_EQ(format_bytes(count), text);
}

TEST(FormatTable, AlignsColumnsWithTwoBlanksBetween) {
  EXPECT_EQ(format_table({{"name", "unknowns", "s"}, {"a", "12"}, {"longer name", "3", "0.5"}}),
            "name         unknowns  s\n"
            "a            12\n"
            "longer name  3         0.5\n");
  EXPECT_EQ(format_table({}), "");
}

TEST(InputError, SaysWhereWhatWasExpectedWhatCameAndWhatToDo) {
  EXPECT_STREQ(InputError("a.toml:3: x", "a number", "\"y\"").what(),
               "a.toml:3: x: expected a number, got \"y\"");
  EXPECT_STREQ(InputError("x", "1", "2", "say 1").what(), "x: expected 1, got 2; say 1");
  EXPECT_STREQ(InputError("a.msh", "element 2 is inverted").what(), "a.msh: element 2 is inverted");
}

TEST(Log, GoesToTheSinkOfTheDayAndNowhereWithoutOne) {
  std::vector<std::pair<LogLevel, std::string>> got;
  const LogSink before =
      set_log_sink([&](LogLevel level, std::string_view message) { got.emplace_back(level, message); });
  log_debug("one");
  log_info("two");
  log_warning("three");
  const LogSink ours = set_log_sink({});
  log_warning("lost");
  EXPECT_TRUE(ours);
  set_log_sink(before);
  const std::vector<std::pair<LogLevel, std::string>> expected = {
      {LogLevel::debug, "one"}, {LogLevel::info, "two"}, {LogLevel::warning, "three"}};
  EXPECT_EQ(got, expected);
}

}  // namespace
}  // namespace resilin
