#include "resilin/io/text_scanner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <locale>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

double real(const std::string& text) { return TextScanner("file", text).real("a number"); }

TEST(TextScanner, ReadsNumbersAsCWritesThem) {
  EXPECT_EQ(real("1.5"), 1.5);
  EXPECT_EQ(real("+2"), 2.0);
  EXPECT_EQ(real("-1e-3"), -1e-3);
  EXPECT_EQ(real("1E+3"), 1000.0);
  EXPECT_EQ(real(".5"), 0.5);
  EXPECT_EQ(real("1e-400"), 0.0);
}

TEST(TextScanner, RefusesEverythingElse) {
  for (const char* text : {"1,5", "nan", "inf", "-Infinity", "1e999", "0x10", "1.5x", "", "--1", "+-1"}) {
    EXPECT_THROW(real(text), InputError) << text;
  }
}

/// A locale that writes decimals with a comma, made here since the machine may have none.
struct CommaDecimals : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(TextScanner, DoesNotListenToTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaDecimals));
  EXPECT_EQ(real("1.5"), 1.5);
  EXPECT_THROW(real("1,5"), InputError);
  std::locale::global(before);
}

TEST(TextScanner, CountsLinesAndSkipsComments) {
  TextScanner text("file", "# head\n\n1 # one\r\n 2\n3", '#');
  EXPECT_EQ(text.integer("a"), 1);
  EXPECT_EQ(text.line(), 3);
  EXPECT_TRUE(text.is_line_done());
  EXPECT_EQ(text.integer("b"), 2);
  EXPECT_EQ(text.integer("c"), 3);
  EXPECT_EQ(text.place(), "file: line 5");
  EXPECT_TRUE(text.at_end());
}

TEST(TextScanner, RefusesACountThatTheFileHasNoRoomFor) {
  EXPECT_EQ(TextScanner("file", "2 0 0 0 0").count("nodes", 4), 2u);
  EXPECT_THROW(TextScanner("file", "4 0 0 0 0").count("nodes", 4), InputError);
  EXPECT_THROW(TextScanner("file", "-1").count("nodes", 4), InputError);
  EXPECT_THROW(TextScanner("file", "99999999999999999999").count("nodes", 4), InputError);
}

TEST(Printable, KeepsAMessageOnOneLine) {
  EXPECT_EQ(printable("a b"), "a b");
  EXPECT_EQ(printable("a\nb\xff"), "a\\x0ab\\xff");
  EXPECT_EQ(printable(std::string(50, 'x')), std::string(40, 'x') + "...");
}

}  // namespace
}  // namespace resilin
