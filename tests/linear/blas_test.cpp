#include "resilin/linear/blas.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <optional>

namespace resilin::testing {
namespace {

/// With OpenBLAS; another BLAS is left as it is.
TEST(Blas, IsKeptOnOneThreadUntilTheLastWhoAskedIsGone) {
  const auto num_threads = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  const auto set_num_threads =
      reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  if (num_threads == nullptr || set_num_threads == nullptr) GTEST_SKIP() << "no OpenBLAS";
  const int before = num_threads();
  set_num_threads(2);
  const int several = num_threads();  // as many as it was built for
  std::optional<SingleThreadedBlas> first(std::in_place), second(std::in_place);
  EXPECT_EQ(num_threads(), 1);
  first.reset();
  EXPECT_EQ(num_threads(), 1);
  first.emplace();
  second.reset();
  EXPECT_EQ(num_threads(), 1);
  first.reset();
  EXPECT_EQ(num_threads(), several);
  set_num_threads(before);
}

}  // namespace
}  // namespace resilin::testing
