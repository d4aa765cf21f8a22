#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resilin/contact/mollified_slip.hpp"
#include "resilin/core/relaxation.hpp"
#include "resilin/energy/cable.hpp"
#include "resilin/energy/lagged_term.hpp"
#include "resilin/energy/stage_term.hpp"

namespace resilin {

/// The friction of a cable at its guides. At each one the tension falls in the direction of sliding,
///
///   T_behind = T_before exp(-mu theta sigma(s)),   sigma(s) = +-f1(|s|) (MollifiedSlip)
///
/// with the angle theta between the pieces and the slip s towards the first point, by which all pieces behind
/// the guide get shorter. The first piece has the tension of the cable itself. In a stage that is an energy
///
///   D = sum over guides of integral T_before (1 - exp(-mu theta sigma)) ds
///
/// with T_before and theta of a shape that is known (`form_lag`). Theory: docs/theory/friction.md.
class CableFriction final : public StageTerm {
 public:
  /// @param coefficient  mu
  /// @param speed        below which the cable sticks [m/s]
  CableFriction(std::shared_ptr<const Cable> cable, double coefficient, double speed)
      : name_(std::string(cable->name()) + ": friction"),
        cable_(std::move(cable)),
        coefficient_(coefficient),
        speed_(speed) {}

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::friction}; }
  void add_pattern(BlockPatternBuilder& builder) const override { cable_->add_pattern(builder); }
  /// Null where no time passes.
  std::unique_ptr<Energy> begin_stage(const Stage& stage) const override;

  const Cable& cable() const { return *cable_; }
  double coefficient() const { return coefficient_; }
  double speed() const { return speed_; }

 private:
  std::string name_;
  std::shared_ptr<const Cable> cable_;
  double coefficient_, speed_;
};

/// The friction of a cable in one stage.
class LaggedCableFriction final : public BasicEnergy, public LaggedTerm {
 public:
  /// @param friction  kept by reference
  LaggedCableFriction(const CableFriction& friction, const Stage& stage);

  std::string_view name() const override { return friction_.name(); }
  EnergyProperties properties() const override { return friction_.properties(); }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  /// Heat: the steps of the tension at `to` times the ways that the cable slips, turned back or not.
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override;

  LaggedTerm* lagged_term() override { return this; }
  void see(std::span<const Energy* const>) override {}
  bool form_lag(const VectorX& x, const Conditions& c) override;
  bool relax_lag() override;
  void couple_lag(bool is_coupled) override;
  void follow(const VectorX& x, const VectorX& p, double t) override;

  /// Tension of each piece, with all that lags formed at x [N].
  std::vector<double> tensions(const VectorX& x, const Conditions& c) const;

 private:
  /// Kept numbers of a guide.
  struct Guide {
    double tension = 0;   ///< T of the piece before it [N]
    double exponent = 0;  ///< mu theta
    double offset = 0;    ///< slip beside the shortening since `still_` [m]
  };

  const CablePath& path() const { return friction_.cable().path(); }
  std::vector<Guide> guides_at(const VectorX& x, const Conditions& c) const;
  /// Shortening of all pieces behind each guide since `still_` [m].
  std::vector<double> shortening(const VectorX& x) const;
  double sigma(double slip) const;
  /// dsigma/ds, by sigma as the Hessian sees it [1/m].
  double sigma_slope(double slip, double sigma) const;
  /// Step of the tension at a guide [N].
  double step_of(const Guide& guide, double slip) const;
  /// The energy of a guide between two slips [J].
  double energy(const Guide& guide, double from, double change) const;
  /// Derivatives of the energy by the length of each piece [N].
  std::vector<double> factors(const std::vector<Guide>& guides, const VectorX& x, double weight) const;

  const CableFriction& friction_;
  VectorX still_;  ///< where the stage would end that bodies end without velocity
  double time_;    ///< duration of the slip [s]
  bool is_static_;
  MollifiedSlip slip_;
  std::vector<Guide> guides_{}, before_{};
  std::optional<std::vector<Guide>> coupled_{};  ///< guides that the Hessian sees while the lag is coupled
  std::vector<double> followed_{};  ///< sigma at each guide as it followed the search; empty: that of x
  Relaxation relaxation_{};
};

}  // namespace resilin
