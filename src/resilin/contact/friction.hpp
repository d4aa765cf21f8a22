#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "resilin/contact/friction_contact.hpp"
#include "resilin/contact/mollified_slip.hpp"
#include "resilin/core/relaxation.hpp"
#include "resilin/energy/lagged_term.hpp"
#include "resilin/energy/stage_term.hpp"
#include "resilin/energy/time_function.hpp"

namespace resilin {

/// Coulomb's friction at all contacts of a scene, as an energy of the slip u in a stage of a step:
///
///   D = sum mu lambda f0(|u|),   f0' = f1(y) = 2 y/eps - (y/eps)^2 for y < eps, 1 beyond
///
/// with f0(0) = 0, normal forces lambda and normals of a shape that is known (`form_lag`), and eps the way in
/// the stage at the speed below which contacts stick. In motion the slip is the velocity at the end of the
/// stage times its duration, so that the force follows from how bodies then move; in statics it is the way
/// since the equilibrium before. Source: Li et al. 2020, "Incremental Potential Contact", 3.4 and 5.4.
/// Theory: docs/theory/friction.md.
class Friction final : public StageTerm {
 public:
  /// @param speed    below which contacts stick [m/s]
  /// @param factors  on the coefficients of each source; constant ones are 1, as are all without any
  Friction(int dim, std::vector<std::shared_ptr<const FrictionSource>> sources, double speed,
           std::vector<TimeFunction> factors = {})
      : dim_(dim), sources_(std::move(sources)), speed_(speed), factors_(std::move(factors)) {
    factors_.resize(sources_.size());
  }

  std::string_view name() const override { return "friction"; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::friction}; }
  /// Null where no time passes.
  std::unique_ptr<Energy> begin_stage(const Stage& stage) const override;

  /// Bounds of the work that obstacles which move along their surfaces may do on bodies: the limits of the
  /// friction times their way, at the one end or the other.
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  /// Along the surfaces, the nodes that something presses against.
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;

  int dim() const { return dim_; }
  double speed() const { return speed_; }
  const std::vector<std::shared_ptr<const FrictionSource>>& sources() const { return sources_; }
  FrictionContacts contacts(const VectorX& x, const Conditions& c) const;
  const std::vector<TimeFunction>& factors() const { return factors_; }

 private:
  int dim_;
  std::vector<std::shared_ptr<const FrictionSource>> sources_;
  double speed_;
  std::vector<TimeFunction> factors_;
};

class FrictionSlopes;

/// The friction of one stage.
class LaggedFriction final : public BasicEnergy, public LaggedTerm {
 public:
  /// @param friction  kept by reference
  LaggedFriction(const Friction& friction, const Stage& stage);

  std::string_view name() const override { return friction_.name(); }
  EnergyProperties properties() const override { return friction_.properties(); }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  /// Never negative, whatever the projection.
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;

  LaggedTerm* lagged_term() override { return this; }
  /// Takes the sources' own terms of the stage, which know what is near.
  void see(std::span<const Energy* const> terms) override;
  bool form_lag(const VectorX& x, const Conditions& c) override;
  bool relax_lag() override;
  void couple_lag(bool is_coupled) override;
  void follow(const VectorX& x, const VectorX& p, double t) override;

  /// With everything formed at x itself, as where a stage ends:
  ///   "lag"                 the place that contacts are formed at; what slips is at x
  ///   "base_positions", "target"    of the stage: where facets were, and where slip is counted from
  ///   "coefficients"        of the sources, one after the other, as the following
  ///   "barrier_stiffness"   as those of the sources themselves
  ///   "place", "velocity", "displacement"    of what moves by itself, three numbers each
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

  /// Calls `visit(entry, force)` for each contact when bodies stand at x, `force` on its nodes, each by its
  /// weight, along its surface [N].
  template <class Visit>
  void for_each_force(const VectorX& x, const Visit& visit) const {
    for (std::size_t i = 0; i < contacts_.size(); ++i) visit(contacts_[i], force(contacts_[i], x));
  }
  /// Heat: the sizes of the forces at `to` times the ways that contacts slip, turned back or not.
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override;

 private:
  /// sum_k weight_k (way of node_k) [m].
  Vector3 way(const FrictionContacts::Entry& entry, const VectorX& from, const VectorX& to) const;
  /// Along two tangents T of the surface [m].
  Eigen::Vector2d slip(const FrictionContacts::Entry& entry, const Eigen::Matrix<double, 3, 2>& T,
                       const VectorX& x) const;
  Vector3 force(const FrictionContacts::Entry& entry, const VectorX& x) const;
  void add_gradient_of(const FrictionContacts& contacts, const VectorX& x, const Conditions& c,
                       VectorX& gradient) const;
  /// By forming contacts the last time: of the limit between each of those that met in this stage [N].
  std::vector<double> change_of_limits();
  /// Direction of one contact of the Hessian, along T.
  Eigen::Vector2d direction(std::size_t contact, const Eigen::Matrix<double, 3, 2>& T,
                            const Eigen::Vector2d& slip) const;

  /// Derivatives of the forces at x.
  const FrictionSlopes& slopes_at(const VectorX& x, const Conditions& c) const;

  /// The source and the nodes of a contact.
  using Parties = std::pair<std::size_t, std::vector<Index>>;
  /// Contacts in use before they were formed the last time.
  struct Before {
    FrictionContacts contacts{};
    std::vector<Vector3> directions{};
    std::vector<std::optional<std::size_t>>
        of_contact{};  ///< index of each contact among the earlier ones, if it was there
  };

  const Friction& friction_;
  std::vector<const FrictionSource*> sources_{};
  VectorX start_;  ///< about where bodies stood when it began
  VectorX still_;  ///< where the stage would end that bodies end without velocity
  double time_;    ///< duration of the slip [s]
  MollifiedSlip slip_;
  bool is_mean_;  ///< for the stage: slip is counted from its target
  FrictionContacts contacts_{};
  /// For each contact the force over its limit, less its sign, as the Hessian sees it: as it followed the
  /// search. Empty: those of x.
  std::vector<Vector3> directions_{};
  Before before_{};
  Relaxation relaxation_{};
  std::map<Parties, std::size_t> numbers_{};   ///< numbers of the parties that met in this stage
  std::optional<FrictionContacts> coupled_{};  ///< contacts that the Hessian sees while the lag is coupled
  /// Found last, and where: changes no bit of a result.
  mutable std::shared_ptr<const FrictionSlopes> slopes_{};
  mutable VectorX slopes_at_{};
  mutable double slopes_time_ = 0;
};

}  // namespace resilin
