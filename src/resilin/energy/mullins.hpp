#pragma once

#include <memory>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/energy/history_material.hpp"
#include "resilin/energy/softening.hpp"

namespace resilin {

/// Strain energy of a body with Mullins softening: E = sum_cells V (phi(W; W_max) + U(J)), W the isochoric
/// energy density and phi that of Softening. The internal variable of a quadrature point is W_max, which is
/// known when a step begins: each step minimises an energy. It holds for steps of any length in which W rises
/// or falls all the time. Theory: docs/theory/mullins.md.
class MullinsEnergy final : public BasicEnergy, public HistoryMaterial {
 public:
  /// @param first  the body at its first loading, of a law with an isochoric split
  MullinsEnergy(std::shared_ptr<ElasticEnergy> first, const Softening& softening);

  std::string_view name() const override { return first_->name(); }
  EnergyProperties properties() const override { return first_->properties(); }

  // ---- as the term itself: the first loading
  double value(const VectorX& x, const Conditions& c) const override { return first_->value(x, c); }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override {
    return first_->difference(from, to, c);
  }
  double magnitude(const VectorX& x, const Conditions& c) const override { return first_->magnitude(x, c); }
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override {
    first_->add_gradient(x, c, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override {
    first_->add_gradient_magnitude(x, c, magnitude);
  }
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override {
    first_->add_hessian(x, c, projection, hessian);
  }
  void add_pattern(BlockPatternBuilder& builder) const override { first_->add_pattern(builder); }
  void bind(const BlockPattern& pattern) override { first_->bind(pattern); }
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override {
    return first_->max_step(x, p, c);
  }

  // ---- history
  const HistoryTerm* history_term() const override { return this; }
  Eigen::Index num_history_values() const override;
  std::unique_ptr<Energy> begin_stage_after(const VectorX& history, const Stage& stage) const override;
  /// Its heat is the work done less the change of W: the area of a loop once the body is back. It falls while
  /// a softened body is loaded again, which takes up less than W.
  Advance advance(const VectorX& history, const VectorX& from, const VectorX& to,
                  double duration) const override;
  /// Energy of the first loading, W + U.
  double stored_energy(const VectorX& x) const override { return first_->value(x, {}); }
  double stored_difference(const VectorX& from, const VectorX& to) const override {
    return first_->difference(from, to, {});
  }

  std::vector<Matrix<3>> cauchy_stresses(const VectorX& x, const VectorX& history) const override;
  std::vector<double> energy_densities(const VectorX& x) const override {
    return first_->energy_densities(x);
  }

 private:
  std::shared_ptr<ElasticEnergy> first_;
  ElasticEnergy isochoric_;  ///< without its bulk modulus
  Softening softening_;
};

}  // namespace resilin
