#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/energy/history_material.hpp"
#include "resilin/energy/viscoelastic_form.hpp"

namespace resilin {

/// A branch of two Prony series: g(t) = 1 - sum_i g_i (1 - exp(-t / tau_i)), and k(t) likewise.
struct PronyBranch {
  double share;             ///< g_i, of the instantaneous shear moduli
  double time;              ///< tau_i [s]
  double volume_share = 0;  ///< k_i, of the instantaneous bulk modulus; not for ViscoelasticForm::whole
};

/// Shares of the instantaneous moduli that are left.
struct RemainingShares {
  double shape = 1;   ///< shear moduli, such as g_inf; in ViscoelasticForm::whole all
  double volume = 1;  ///< bulk modulus, such as k_inf

  friend bool operator==(const RemainingShares&, const RemainingShares&) = default;
};

/// True for a law Psi = Psi_iso(J^(-1/3) F) + U(J) with a bulk modulus of its own in U.
bool has_isochoric_split(const LawInfo& law);

/// Factors of a law's constants that scale the energy that relaxes: all of Psi, or Psi_iso and U by
/// themselves.
std::vector<double> relaxing_factors(const LawInfo& law, ViscoelasticForm form,
                                     const RemainingShares& shares);

/// Strain energy of a viscoelastic body at finite strain. For `ViscoelasticForm::simo`
///
///   S(t) = int k(t - s) d/ds Y(s) ds C^-1 + J^(-2/3) DEV[ int g(t - s) d/ds X(s) ds ]
///   Y = J U',   X = DEV[2 dPsi_iso/dC_bar]
///
/// with DEV[A] = A - (A:C) C^-1 / 3 at the present C. Internal variables of a quadrature point are X and the
/// h_i of the branches, by the increments of X that are linear in time; then Y and its branches likewise if
/// the pressure relaxes:
///
///   h_i <- e_i h_i + c_i (X - X_n),   e_i = exp(-dt/tau_i),   c_i = (1 - e_i) / (dt/tau_i)
///
/// A stage minimises (k_inf + sum_i k_i c_i) U + (g_inf + sum_i g_i c_i) Psi_iso + J^(-2/3) C:H / 2 + q ln J,
/// H = sum_i g_i (e_i h_i - c_i X_n), q likewise. The other two follow S_iso or S itself: X is that stress,
/// J^(-2/3) is left out, and `whole` scales U as Psi_iso. Sources: Simo 1987; Simo & Hughes 1998, ch. 10;
/// Holzapfel 2000, ch. 6; Puso & Weiss 1998. Theory: docs/theory/viscoelasticity.md.
class ViscoelasticEnergy final : public BasicEnergy, public HistoryMaterial {
 public:
  /// @param instantaneous  with its constants under sudden load; of a law with an isochoric split unless all
  /// of
  ///                       the stress relaxes
  /// @param branches       whose shares sum to less than one, those of the volume as well
  ViscoelasticEnergy(std::shared_ptr<ElasticEnergy> instantaneous, std::vector<PronyBranch> branches,
                     ViscoelasticForm form = ViscoelasticForm::simo);
  ~ViscoelasticEnergy() override;

  std::string_view name() const override { return instantaneous_->name(); }
  EnergyProperties properties() const override { return instantaneous_->properties(); }

  // ---- as the term itself: the response to a sudden load from the reference configuration
  double value(const VectorX& x, const Conditions& c) const override { return instantaneous_->value(x, c); }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override {
    return instantaneous_->difference(from, to, c);
  }
  double magnitude(const VectorX& x, const Conditions& c) const override {
    return instantaneous_->magnitude(x, c);
  }
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override {
    instantaneous_->add_gradient(x, c, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override {
    instantaneous_->add_gradient_magnitude(x, c, magnitude);
  }
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override {
    instantaneous_->add_hessian(x, c, projection, hessian);
  }
  void add_pattern(BlockPatternBuilder& builder) const override { instantaneous_->add_pattern(builder); }
  void bind(const BlockPattern& pattern) override;
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override {
    return instantaneous_->max_step(x, p, c);
  }

  // ---- history
  const HistoryTerm* history_term() const override { return this; }
  Eigen::Index num_history_values() const override;
  std::unique_ptr<Energy> begin_stage_after(const VectorX& history, const Stage& stage) const override;
  /// Its heat is the work against the stresses of the branches, by the trapezoidal rule. A branch gives some
  /// of it back while it relaxes.
  Advance advance(const VectorX& history, const VectorX& from, const VectorX& to,
                  double duration) const override;
  /// Stored energy of the long-term moduli, such as k_inf U + g_inf Psi_iso.
  double stored_energy(const VectorX& x) const override;
  double stored_difference(const VectorX& from, const VectorX& to) const override;

  std::vector<Matrix<3>> cauchy_stresses(const VectorX& x, const VectorX& history) const override;
  std::vector<double> energy_densities(const VectorX& x) const override;

  const std::vector<PronyBranch>& branches() const { return branches_; }
  double long_term_share() const { return long_term_.shape; }  ///< g_inf

 private:
  struct Scaled;
  /// The elastic body with the relaxing parts of its energy times these shares.
  std::shared_ptr<const ElasticEnergy> with_shares(const RemainingShares& shares) const;
  Eigen::Index values_per_point() const;
  /// Kirchhoff stress of the pressure of all branches, from the values of a point.
  double pressure_pull(const double* values) const;

  std::shared_ptr<ElasticEnergy> instantaneous_;
  std::vector<PronyBranch> branches_;
  ViscoelasticForm form_;
  RemainingShares long_term_;
  std::unique_ptr<Scaled> scaled_;
};

}  // namespace resilin
