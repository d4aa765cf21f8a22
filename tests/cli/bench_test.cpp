#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

TEST(Benchmarks, AreListedAndExplainThemselves) {
  const TemporaryFolder folder;
  const ProgramResult list = run_program(folder.path(), {"bench"});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.out, HasSubstr("solvers"));
  const ProgramResult help = run_program(folder.path(), {"bench", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("Example"));
  EXPECT_THAT(help.out, HasSubstr("resilin bench"));
}

}  // namespace
}  // namespace resilin::testing
