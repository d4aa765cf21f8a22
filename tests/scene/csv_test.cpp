#include "resilin/scene/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_text.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

NumberTable read(const std::string& text) {
  const TemporaryFolder folder;
  return read_csv(folder.write("table.csv", text));
}

TEST(CsvTable, IsReadWithAnySeparatorHeaderAndComments) {
  const std::vector<double> expected = {1, -2.5, 3e-3, 4};
  for (const std::string text :
       {"1,-2.5\n3e-3,4\n", "x;y\n1; -2.5\n+3e-3 ;4", "# c\r\n1 -2.5\r\n\r\n3e-3\t4\r\n"}) {
    const NumberTable table = read(text);
    EXPECT_EQ(table.values, expected) << text;
    EXPECT_EQ(table.num_columns, 2u);
    EXPECT_EQ(table.num_rows(), 2u);
  }
}

TEST(CsvTable, TellsTheLineOfWhatIsNoNumber) {
  EXPECT_THAT(input_error([] { read("1,2\n3,four\n"); }),
              HasSubstr("table.csv:2: expected a number, got \"four\""));
  EXPECT_THAT(input_error([] { read("1,2\n3,nan\n"); }), HasSubstr("table.csv:2: expected a number"));
  EXPECT_THAT(input_error([] { read("1,2\n3\n"); }), HasSubstr("table.csv:2: expected 2 numbers"));
  EXPECT_THAT(input_error([] { read("1,5;2,5\n"); }), HasSubstr("decimals need a point"));
}

TEST(CsvTable, MayBeginWithAByteOrderMark) {
  EXPECT_EQ(read("\xef\xbb\xbf"
                 "1,2\n3,4\n")
                .values,
            (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(read("\xef\xbb\xbf"
                 "x,y\n3,4\n")
                .values,
            (std::vector<double>{3, 4}));
  EXPECT_THAT(input_error([] {
                read(
                    "\xff\xfe"
                    "1");
              }),
              HasSubstr("table.csv: expected a text in UTF-8"));
}

TEST(CsvTable, MayBeEmpty) { EXPECT_EQ(read("# nothing\n").num_rows(), 0u); }

}  // namespace
}  // namespace resilin::testing
