#include "resilin/optimize/lag.hpp"

#include <gtest/gtest.h>

#include "chain.hpp"

namespace resilin {
namespace {

/// Counts how often what lags is formed and relaxed; its gradient is that number.
class Counter final : public Objective {
 public:
  bool form_lag(const VectorX&) override {
    ++formed;
    return is_changed;
  }
  bool relax_lag() override {
    ++relaxed;
    return is_changed;
  }
  double difference(const VectorX&, const VectorX&) const override { return 0; }
  double magnitude(const VectorX&) const override { return 0; }
  void gradient(const VectorX& x, VectorX& g) const override { g.setConstant(x.size(), formed); }
  void gradient_magnitude(const VectorX& x, VectorX& m) const override { m.setZero(x.size()); }
  void hessian(const VectorX&, Projection, BlockMatrix&) const override {}
  double max_step(const VectorX&, const VectorX&) const override { return 1; }
  VectorX force_scales(const VectorX&, const VectorX&, const ConnectedComponents&) const override {
    return VectorX::Ones(1);
  }
  VectorX distinct_acting_scales(const VectorX&, const VectorX&, const ConnectedComponents&) const override {
    return VectorX::Ones(1);
  }

  int formed = 0, relaxed = 0;
  bool is_changed = true;
};

TEST(Lag, IsFormedOncePerPlace) {
  Counter objective;
  Lag lag(objective, 3);
  const VectorX x = VectorX::Zero(2);
  VectorX gradient = x;
  EXPECT_TRUE(lag.form(x, gradient));
  EXPECT_EQ(gradient[0], 1);
  EXPECT_FALSE(lag.form(x, gradient)) << "the search has not moved";
  lag.leave();
  EXPECT_TRUE(lag.form(x, gradient));
  EXPECT_EQ(objective.formed, 2);
  lag.leave();
  objective.is_changed = false;
  gradient.setZero();
  EXPECT_FALSE(lag.form(x, gradient));
  EXPECT_EQ(gradient[0], 0) << "forces are the same";
}

TEST(Lag, IsDueOnceATenthIsLeft) {
  Counter objective;
  Lag lag(objective, 2);
  VectorX x = VectorX::Zero(2), gradient = x;
  EXPECT_FALSE(lag.is_due(1, 0.2)) << "the first time by the forces that act";
  EXPECT_TRUE(lag.is_due(1, 0.1));
  lag.form(x, gradient);
  EXPECT_FALSE(lag.is_due(1, 0)) << "it is that of this place";
  lag.begin_round(x, gradient);
  lag.set_first_residual(5);
  lag.leave();
  EXPECT_FALSE(lag.is_due(0.6, 0)) << "later by the residual of the round";
  EXPECT_TRUE(lag.is_due(0.5, 1));
  lag.begin_round(x, gradient);
  lag.leave();
  EXPECT_TRUE(lag.is_over());
  EXPECT_FALSE(lag.is_due(0, 0));
}

TEST(Lag, IsRelaxedFromTheSecondRoundOn) {
  Counter objective;
  Lag lag(objective, 9);
  VectorX x = VectorX::Zero(2), gradient = x;
  EXPECT_FALSE(lag.begin_round(x, gradient));
  EXPECT_EQ(objective.relaxed, 0);
  EXPECT_TRUE(lag.begin_round(x, gradient));
  EXPECT_EQ(objective.relaxed, 1);
  EXPECT_TRUE(lag.form(x, gradient)) << "only a share of it is in use";
}

TEST(Lag, AsksForNoMoreDigitsThanARoundKeeps) {
  Counter objective;
  Lag lag(objective, 9);
  EXPECT_EQ(lag.first_forcing(1), Lag::forcing);
  lag.set_share_of_change(0);
  EXPECT_EQ(lag.first_forcing(0), 1e-3);
  EXPECT_DOUBLE_EQ(lag.first_forcing(0.1), 0.9 * 0.01);
}

TEST(CoupledLag, WaitsForRoundsAndForASmallResidual) {
  CoupledLag coupling;
  EXPECT_FALSE(coupling.is_due(5, 0));
  EXPECT_FALSE(coupling.is_due(6, 0.3));
  EXPECT_TRUE(coupling.is_due(6, 0.2));
  coupling.begin(VectorX::Ones(2), 1, true, 6);
  EXPECT_TRUE(coupling.is_on());
  EXPECT_EQ(coupling.start()[1], 1);
  EXPECT_TRUE(coupling.had_potential());
  coupling.give_up();
  EXPECT_FALSE(coupling.is_on());
  EXPECT_FALSE(coupling.is_due(8, 0)) << "half as many rounds again";
  EXPECT_TRUE(coupling.is_due(9, 0));
}

TEST(CoupledLag, GivesUpWhereTheResidualDoesNotFall) {
  CoupledLag coupling;
  coupling.begin(VectorX::Ones(2), 1, true, 6);
  for (int step = 0; step < 3; ++step) EXPECT_FALSE(coupling.fails(1, 4)) << "free steps may raise it";
  EXPECT_FALSE(coupling.fails(1, 0.7));
  EXPECT_FALSE(coupling.fails(1, 0.49 * (1 - 1e-12)));
  EXPECT_TRUE(coupling.fails(1, 0.35));
  coupling.give_up();
  EXPECT_EQ(coupling.lost_steps(), 6);

  coupling.begin(VectorX::Ones(2), 1, true, 9);
  EXPECT_TRUE(coupling.fails(0.001, 0)) << "cut by contact";
  coupling.begin(VectorX::Ones(2), 1, true, 9);
  EXPECT_TRUE(coupling.fails(1, 4.1)) << "raises it too much";
}

}  // namespace
}  // namespace resilin
