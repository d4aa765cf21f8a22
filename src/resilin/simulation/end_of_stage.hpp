#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/energy/energy.hpp"
#include "resilin/energy/lagged_term.hpp"

namespace resilin {

/// A term of contact or friction in a stage of a step: taken at the positions where the stage ends, not at
/// its unknown x, and as often as the stage says, so that the whole impulse acts at the end
/// (docs/theory/integrators.md, I.4).
///
/// With the end y(x) and the weight w, the term is w E(y(x)): each derivative by x has one more factor y'.
class EndOfStage final : public Energy, public LaggedTerm {
 public:
  /// @param term  kept by reference, unless `own` is the same
  EndOfStage(const Energy& term, std::unique_ptr<Energy> own, const Stage& stage)
      : term_(term),
        own_(std::move(own)),
        is_mean_(stage.is_mean),
        weight_(stage.contact_weight),
        slope_(stage.end_slope()),
        time_to_end_(stage.time_to_end()) {
    if (is_mean_) start_ = stage.base_positions;
  }

  /// Whether a stage takes terms of contact in another way than all others.
  static bool is_needed(const Stage& stage) { return stage.is_mean || stage.contact_weight != 1; }

  std::string_view name() const override { return term_.name(); }
  EnergyProperties properties() const override { return term_.properties(); }
  double value(const VectorX& x, const Conditions& c) const override {
    VectorX room;
    return term_.value(end_of(x, room), at_end(c, weight_));
  }
  double magnitude(const VectorX& x, const Conditions& c) const override {
    VectorX room;
    return term_.magnitude(end_of(x, room), at_end(c, weight_));
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override {
    VectorX room, more_room;
    return term_.difference(end_of(from, room), end_of(to, more_room), at_end(c, weight_));
  }
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override {
    VectorX room;
    term_.add_gradient(end_of(x, room), at_end(c, weight_ * slope_), gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override {
    VectorX room;
    term_.add_gradient_magnitude(end_of(x, room), at_end(c, weight_ * slope_), magnitude);
  }
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override {
    VectorX room;
    term_.add_hessian(end_of(x, room), at_end(c, weight_ * slope_ * slope_), projection, hessian);
  }
  void add_pattern(BlockPatternBuilder& builder) const override { term_.add_pattern(builder); }
  void bind(const BlockPattern& pattern) override {
    if (own_) own_->bind(pattern);
  }
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override {
    VectorX room;
    return term_.max_step(end_of(x, room), slope_ * p, at_end(c, weight_));
  }
  /// The stage has begun.
  std::unique_ptr<Energy> begin_stage(const Stage&) const override { return nullptr; }
  const HistoryTerm* history_term() const override { return nullptr; }
  /// None: matrices that a body adds would not be those of the end.
  const CellTerm* cell_term() const override { return nullptr; }
  const CellMatrices* cell_matrices() const override { return nullptr; }
  LaggedTerm* lagged_term() override { return own_lag() == nullptr ? nullptr : this; }
  const FrictionSource* friction_source() const override { return term_.friction_source(); }
  /// The Hessian by x of the term brings the step by x that the end needs.
  bool add_second_order_forces(const VectorX& x, const VectorX& p, const Conditions& c,
                               VectorX& forces) const override {
    VectorX room;
    return term_.add_second_order_forces(end_of(x, room), slope_ * p, at_end(c, weight_ * slope_), forces);
  }
  void prepare(const VectorX& x, const VectorX& p, const Conditions& c) override {
    VectorX room;
    if (own_) own_->prepare(end_of(x, room), slope_ * p, at_end(c, weight_));
  }
  void see(std::span<const Energy* const> terms) override { own_lag()->see(terms); }
  bool form_lag(const VectorX& x, const Conditions& c) override {
    VectorX room;
    return own_lag()->form_lag(end_of(x, room), at_end(c, weight_));
  }
  bool relax_lag() override { return own_lag()->relax_lag(); }
  void couple_lag(bool is_coupled) override { own_lag()->couple_lag(is_coupled); }
  void follow(const VectorX& x, const VectorX& p, double t) override {
    VectorX room;
    own_lag()->follow(end_of(x, room), slope_ * p, t);
  }
  /// Those of the term. What lags is formed at the end, twice as far as x where x is a mean.
  std::vector<EnergyParameter> parameters() const override { return term_.parameters(); }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override {
    VectorX room, found = VectorX::Zero(slopes.size());
    term_.add_parameter_slopes(name, end_of(x, room), w, at_end(c, weight_ * slope_), found);
    slopes += (name == "lag" ? slope_ : 1) * found;
  }
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override {
    VectorX room;
    term_.add_parameter_forces(name, end_of(x, room), (name == "lag" ? slope_ : 1) * change,
                               at_end(c, weight_ * slope_), gradient);
  }
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override {
    VectorX room, more_room;
    return term_.driven_work(end_of(from, room), at_end(before, weight_), end_of(to, more_room),
                             at_end(after, weight_));
  }
  /// The force at the end, as often as the stage counts it.
  std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const override {
    VectorX room;
    return term_.reaction(end_of(x, room), at_end(c, weight_ * slope_));
  }
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override {
    VectorX room;
    term_.add_held_directions(end_of(x, room), held);
  }
  /// @param from  where the stage before ended
  double dissipation(const VectorX& from, const VectorX& x, double duration) const override {
    VectorX room;
    return own_ ? own_->dissipation(from, end_of(x, room), duration) : 0;
  }
  double least_delay(const VectorX& x, const Conditions& c) const override {
    VectorX room;
    return term_.least_delay(end_of(x, room), at_end(c, weight_));
  }

 private:
  LaggedTerm* own_lag() { return own_ ? own_->lagged_term() : nullptr; }
  /// The place of the end; `room` holds it where it is not x.
  const VectorX& end_of(const VectorX& x, VectorX& room) const {
    if (!is_mean_) return x;
    room = 2 * x - start_;
    return room;
  }
  Conditions at_end(Conditions c, double weight) const {
    c.time += time_to_end_;
    c.weight *= weight;
    return c;
  }

  const Energy& term_;
  std::unique_ptr<Energy> own_;
  bool is_mean_;
  double weight_, slope_, time_to_end_;
  VectorX start_{};
};

}  // namespace resilin
