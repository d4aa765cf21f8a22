#include "resilin/simulation/potential.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace resilin {
namespace {

/// Something that moves by itself and is not in the way of bodies at some times.
class Mover final : public BasicEnergy {
 public:
  struct Clear {
    double from, until;  ///< [s]
  };
  explicit Mover(std::vector<Clear> clear) : clear_(std::move(clear)) {}

  std::string_view name() const override { return "mover"; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::contact}; }
  double value(const VectorX&, const Conditions&) const override { return 0; }
  double difference(const VectorX&, const VectorX&, const Conditions&) const override { return 0; }
  void add_gradient(const VectorX&, const Conditions&, VectorX&) const override {}
  void add_gradient_magnitude(const VectorX&, const Conditions&, VectorX&) const override {}
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix&) const override {}
  /// As far as the whole way, or a part of it that is shorter and shorter, ends where it is clear.
  double least_delay(const VectorX&, const Conditions& c) const override {
    for (double part = 1; part > 1e-3; part *= 0.8)
      if (is_clear(c.time - (1 - part) * c.delay)) return (1 - part) * c.delay;
    return c.delay;
  }
  bool is_clear(double time) const {
    for (const Clear& clear : clear_)
      if (time >= clear.from && time <= clear.until) return true;
    return false;
  }

 private:
  std::vector<Clear> clear_;
};

/// One may swing to its end but not stop on the way, where another has to.
TEST(TheDelayOfAll, IsOneAtWhichNothingIsInTheWay) {
  const std::vector<std::vector<Mover::Clear>> swings = {
      {{0, 0.1}, {0.9, 1}}, {{0, 0.1}, {0.4, 0.6}, {0.95, 1}}, {{0, 0.3}, {0.7, 1}}};
  for (const auto& swing : swings)
    for (const double stop : {0.05, 0.25, 0.35, 0.5, 0.8, 1.0}) {
      const auto first = std::make_shared<const Mover>(std::vector<Mover::Clear>{{0, stop}}),
                 second = std::make_shared<const Mover>(swing);
      const std::vector<std::shared_ptr<const Energy>> terms = {first, second};
      const std::vector<std::uint8_t> is_fixed(3, 0);
      const VectorX x = VectorX::Zero(3);
      const Conditions conditions{.time = 1, .delay = 1};
      const Potential potential(terms, is_fixed, conditions, {.base_positions = x, .duration = 1});
      const double delay = potential.least_delay(x);
      EXPECT_TRUE(first->is_clear(1 - delay)) << stop << ", " << delay;
      EXPECT_TRUE(second->is_clear(1 - delay)) << stop << ", " << delay;
      if (stop == 1) {
        EXPECT_EQ(delay, 0);
      }
    }
}

}  // namespace
}  // namespace resilin
