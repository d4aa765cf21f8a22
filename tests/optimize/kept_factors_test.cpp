#include "resilin/optimize/kept_factors.hpp"

#include <gtest/gtest.h>

namespace resilin {
namespace {

TEST(KeptFactors, ServeOnceTheyAreMade) {
  KeptFactors factors;
  EXPECT_FALSE(factors.may_serve());
  factors.made(5, 0.1);
  EXPECT_TRUE(factors.may_serve());
  factors.leave();
  EXPECT_FALSE(factors.may_serve());
}

TEST(KeptFactors, ServeWhileTheySolveInFewMoreIterationsPerDigit) {
  KeptFactors factors;
  factors.made(5, 0.1);
  factors.tried(true, 11, 0.1);
  EXPECT_TRUE(factors.may_serve());
  factors.tried(true, 12, 0.1);
  EXPECT_FALSE(factors.may_serve());
  factors.made(5, 0.1);
  factors.tried(true, 16, 0.01);
  EXPECT_TRUE(factors.may_serve());
}

TEST(KeptFactors, ServeOnlySoManyMatrices) {
  KeptFactors factors;
  factors.made(10, 0.1);
  int count = 0;
  for (; factors.may_serve() && count < 100; ++count) factors.tried(true, 10, 0.1);
  EXPECT_EQ(count, 4);
}

TEST(KeptFactors, DoNotServeASearchInWhichTheyHaveFailed) {
  KeptFactors factors;
  factors.made(5, 0.1);
  factors.tried(false, 80, 0.1);
  EXPECT_FALSE(factors.may_serve());
  factors.made(5, 0.1);
  EXPECT_FALSE(factors.may_serve());
}

}  // namespace
}  // namespace resilin
