#include "resilin/simulation/end_of_stage.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "every_integrator.hpp"
#include "resilin/contact/surface_contact.hpp"
#include "resilin/simulation/potential.hpp"
#include "slide_and_tilt.hpp"

namespace resilin::testing {
namespace {

constexpr double step_of_test = 0.01;  // [s]

/// The first stage of the second step of a scheme, whose end is at `end`.
Stage stage_that_ends_at(const VectorX& end, const std::string& integrator) {
  History start;
  start.now = {.positions = end,
               .velocities = VectorX::Constant(end.size(), 0.2),
               .accelerations = VectorX::Zero(end.size())};
  start.previous_positions = end;
  start.previous_velocities = start.now.velocities;
  start.previous_time_step = step_of_test;
  Stage stage = make_integrator(integrator, "test")->begin_stage(0, start, {}, step_of_test);
  stage.base_positions = end;  // base positions of a mean, too
  return stage;
}

struct EndOfStageOfEveryIntegrator : WithEveryIntegrator {};

/// An edge above another one tilts while it slides, so that it would run into it: the steps of every scheme
/// are led around it, by its own Hessian.
TEST_P(EndOfStageOfEveryIntegrator, LeadsAStepAroundWhatTurnsInItsWay) {
  constexpr double reach = 0.02, distance = 0.002;  // [m]
  const SlideAndTilt bad(Eigen::Quaterniond::Identity(), distance, 4 * distance);
  const VectorX& x = bad.positions;
  const Terms terms = {std::make_shared<SurfaceContact>("contact", make_contact_surface(3, bad.bodies, x),
                                                        BodyMeetings(2, false), reach, x)};
  const std::vector<std::uint8_t> is_fixed(24, 0);
  const Stage stage = stage_that_ends_at(x, integrator);
  Potential potential(terms, is_fixed, {}, stage);
  const VectorX p = bad.way / stage.end_slope();
  potential.prepare(x, p);
  EXPECT_LT(potential.max_step(x, p), 0.8);
  VectorX forces = VectorX::Zero(x.size());
  ASSERT_TRUE(potential.add_second_order_forces(x, p, forces));

  BlockMatrix hessian(3, std::make_shared<const BlockPattern>(BlockPatternBuilder(8).build()));
  potential.hessian(x, Projection::clamp, hessian);
  Eigen::MatrixXd H(24, 24);
  for (Eigen::Index k = 0; k < 24; ++k) {
    VectorX column;
    multiply(hessian, VectorX::Unit(24, k), column);
    H.col(k) = column;
  }
  H.diagonal().array() += 0.1 * H.diagonal().maxCoeff();
  const VectorX corrected = p + H.ldlt().solve(forces);
  potential.prepare(x, corrected);
  EXPECT_EQ(potential.max_step(x, corrected), 1);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EndOfStageOfEveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// A term with every capability, whose answers tell what it was asked with.
class Witness final : public Energy, public LaggedTerm {
 public:
  std::string_view name() const override { return "witness"; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::contact}; }
  double value(const VectorX& x, const Conditions& c) const override { return c.weight * x.sum() + c.time; }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override {
    return c.weight * (2 * to.sum() - from.sum()) + c.time;
  }
  double magnitude(const VectorX& x, const Conditions& c) const override { return 3 * value(x, c); }
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override {
    gradient += c.weight * x + VectorX::Constant(x.size(), c.time);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override {
    magnitude += 2 * c.weight * x;
  }
  void add_hessian(const VectorX& x, const Conditions& c, Projection, BlockMatrix& hessian) const override {
    hessian.values[0] += c.weight * x.sum();
  }
  void add_pattern(BlockPatternBuilder&) const override {}
  void bind(const BlockPattern& pattern) override { num_slots = pattern.num_slots(); }
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override {
    return x.sum() + 2 * p.sum() + c.time;
  }
  const CellTerm* cell_term() const override { return nullptr; }
  const CellMatrices* cell_matrices() const override { return nullptr; }
  LaggedTerm* lagged_term() override { return this; }
  bool add_second_order_forces(const VectorX& x, const VectorX& p, const Conditions& c,
                               VectorX& forces) const override {
    forces += c.weight * (x + 7 * p);
    return true;
  }
  std::unique_ptr<Energy> begin_stage(const Stage&) const override {
    return std::make_unique<Witness>();  // a term of the stage's own, so that it is told everything
  }
  const HistoryTerm* history_term() const override { return nullptr; }
  void prepare(const VectorX& x, const VectorX& p, const Conditions& c) override {
    told = x.sum() + 2 * p.sum() + c.time;
  }
  const FrictionSource* friction_source() const override { return nullptr; }
  void see(std::span<const Energy* const> terms) override { told = 10.0 * static_cast<double>(terms.size()); }
  bool form_lag(const VectorX& x, const Conditions& c) override {
    told = x.sum() + c.time;
    return true;
  }
  bool relax_lag() override { return true; }
  void couple_lag(bool is_coupled) override { told = is_coupled ? 1 : 2; }
  void follow(const VectorX& x, const VectorX& p, double t) override { told = x.sum() + t * p.sum(); }
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override {
    return before.weight * from.sum() + 2 * after.weight * to.sum() + before.time + 3 * after.time;
  }
  double least_delay(const VectorX& x, const Conditions& c) const override { return x.sum() + c.time; }
  std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const override {
    return Reaction{.force = c.weight * x, .torque = c.time * x};
  }
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override {
    held.push_back({.nodes = {}, .direction = x});
  }
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override {
    return (to - from).sum() / duration;
  }
  std::vector<EnergyParameter> parameters() const override { return {{"weight"}, {"lag", 3}}; }
  void add_parameter_slopes(std::string_view, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override {
    slopes.array() += c.weight * (x.sum() + w.sum());
  }
  void add_parameter_forces(std::string_view, const VectorX& x, const VectorX& change, const Conditions& c,
                            VectorX& gradient) const override {
    gradient.array() += c.weight * (x.sum() + change.sum());
  }

  double told = 0;
  Offset num_slots = 0;
};

/// Every function of a term, asked of the stage of a midpoint step (whose x is a mean) and of the term itself
/// at the end: with the same weight for energies, with one factor 2 more for each derivative by x.
TEST(EndOfStage, AnswersEveryFunctionOfATermAtTheEnd) {
  const VectorX start = Vector3(1, 2, 4), x = Vector3(1.5, 1.25, 5), p = Vector3(0.5, -0.25, 2);
  const VectorX end = 2 * x - start, elsewhere = Vector3(3, 0.5, 1), way = 2 * p;
  constexpr double weight = 0.5, duration = 0.125, time = 0.75;
  const Stage stage{.base_positions = start, .duration = duration, .is_mean = true, .contact_weight = weight};
  const Conditions c{.time = time};
  const auto at_end = [](double times) { return Conditions{.time = time + duration, .weight = times}; };
  const Conditions once = at_end(weight), twice = at_end(2 * weight), four_times = at_end(4 * weight);

  const Witness term;
  auto own = std::make_unique<Witness>();
  Witness& told = *own;
  const Energy& inner = told;
  EndOfStage ended(inner, std::move(own), stage);
  const auto same = [](const auto& a, const auto& b) { EXPECT_EQ((a - b).norm(), 0); };
  const auto sum_of = [&](Eigen::Index size, const auto& add) {
    VectorX sum = VectorX::Zero(size);
    add(sum);
    return sum;
  };
  const auto entry_of = [](const auto& add) {
    BlockMatrix hessian(3, std::make_shared<const BlockPattern>(BlockPatternBuilder(1).build()));
    add(hessian);
    return hessian.values[0];
  };

  EXPECT_EQ(ended.name(), "witness");
  EXPECT_EQ(ended.properties().category, EnergyCategory::contact);
  EXPECT_EQ(ended.value(x, c), term.value(end, once));
  EXPECT_EQ(ended.difference(x, x + p, c), term.difference(end, end + way, once));
  EXPECT_EQ(ended.magnitude(x, c), term.magnitude(end, once));
  same(sum_of(3, [&](VectorX& sum) { ended.add_gradient(x, c, sum); }),
       sum_of(3, [&](VectorX& sum) { term.add_gradient(end, twice, sum); }));
  same(sum_of(3, [&](VectorX& sum) { ended.add_gradient_magnitude(x, c, sum); }),
       sum_of(3, [&](VectorX& sum) { term.add_gradient_magnitude(end, twice, sum); }));
  EXPECT_EQ(entry_of([&](BlockMatrix& H) { ended.add_hessian(x, c, Projection::none, H); }),
            entry_of([&](BlockMatrix& H) { term.add_hessian(end, four_times, Projection::none, H); }));
  ended.bind(BlockPatternBuilder(1).build());
  EXPECT_EQ(told.num_slots, 1);
  EXPECT_EQ(ended.max_step(x, p, c), term.max_step(end, way, once));
  EXPECT_EQ(ended.cell_term(), nullptr);
  EXPECT_EQ(ended.cell_matrices(), nullptr);
  VectorX forces = VectorX::Zero(3);
  EXPECT_TRUE(ended.add_second_order_forces(x, p, c, forces));
  same(forces, sum_of(3, [&](VectorX& sum) { term.add_second_order_forces(end, way, twice, sum); }));
  EXPECT_EQ(ended.begin_stage(stage), nullptr);

  ended.prepare(x, p, c);
  EXPECT_EQ(told.told, end.sum() + 2 * way.sum() + once.time);
  const std::vector<const Energy*> seen(4, &term);
  ASSERT_EQ(ended.lagged_term(), &ended);
  ended.see(seen);
  EXPECT_EQ(told.told, 40);
  EXPECT_TRUE(ended.form_lag(x, c));
  EXPECT_EQ(told.told, end.sum() + once.time);
  EXPECT_TRUE(ended.relax_lag());
  ended.couple_lag(true);
  EXPECT_EQ(told.told, 1);
  ended.follow(x, p, 0.5);
  EXPECT_EQ(told.told, end.sum() + 0.5 * way.sum());

  EXPECT_EQ(ended.driven_work(x, c, x + p, c), term.driven_work(end, once, end + way, once));
  EXPECT_EQ(ended.least_delay(x, c), term.least_delay(end, once));
  same(ended.reaction(x, c)->force, term.reaction(end, twice)->force);
  same(ended.reaction(x, c)->torque, term.reaction(end, twice)->torque);
  std::vector<HeldDirection> held;
  ended.add_held_directions(x, held);
  ASSERT_EQ(held.size(), 1U);
  same(held[0].direction, Vector3(end));
  EXPECT_EQ(ended.dissipation(elsewhere, x, 0.5), term.dissipation(elsewhere, end, 0.5));

  EXPECT_EQ(ended.parameters().size(), 2U);
  for (const auto& [name, factor] : {std::pair("weight", 1.0), std::pair("lag", 2.0)}) {
    same(sum_of(3, [&](VectorX& sum) { ended.add_parameter_slopes(name, x, p, c, sum); }),
         factor * sum_of(3, [&](VectorX& sum) { term.add_parameter_slopes(name, end, p, twice, sum); }));
    same(sum_of(3, [&](VectorX& sum) { ended.add_parameter_forces(name, x, p, c, sum); }),
         sum_of(3, [&](VectorX& sum) { term.add_parameter_forces(name, end, factor * p, twice, sum); }));
  }
}

}  // namespace
}  // namespace resilin::testing
