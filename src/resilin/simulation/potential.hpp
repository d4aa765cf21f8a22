#pragma once

#include <memory>
#include <span>
#include <vector>

#include "resilin/energy/inertia.hpp"
#include "resilin/optimize/objective.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The sum of a world's energies at given conditions, with the inertia and the damping of a time step when
/// there are such.
class Potential final : public Objective {
 public:
  /// @param world, inertia, more_terms  kept by reference; `inertia` may be null
  Potential(const World& world, const Conditions& conditions, const Inertia* inertia,
            std::span<const std::unique_ptr<Energy>> more_terms = {});

  double difference(const VectorX& from, const VectorX& to) const override;
  double magnitude(const VectorX& x) const override;
  void gradient(const VectorX& x, VectorX& gradient) const override;
  void gradient_magnitude(const VectorX& x, VectorX& magnitude) const override;
  void hessian(const VectorX& x, Projection projection, BlockMatrix& hessian) const override;
  VectorX internal_values(const VectorX& x) const override;
  VectorX predicted_internal_values(const VectorX& x, const VectorX& p, double t) const override;
  void hessian_at(const VectorX& internal, const VectorX& x, Projection projection,
                  BlockMatrix& hessian) const override;
  /// No where a pressure follows an open surface whose edge is free: its tangent is then not symmetric.
  bool has_potential(const VectorX& x) const override;
  double max_step(const VectorX& x, const VectorX& p) const override;

  /// The largest of: the loads, the reactions, the inertia force; each as the norm over all unknowns [N].
  double force_scale(const VectorX& x, const VectorX& gradient) const override;

 private:
  template <class Function>
  void for_each_term(const Function& function) const;

  const World& world_;
  Conditions conditions_;
  const Inertia* inertia_;
  std::span<const std::unique_ptr<Energy>> more_terms_;
};

}  // namespace resilin
