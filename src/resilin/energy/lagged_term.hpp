#pragma once

#include <span>

#include "resilin/core/types.hpp"

namespace resilin {

class Energy;
struct Conditions;

/// The capability of a stage's own term that keeps something of a shape that is known, such as the normal
/// forces of friction: lagged iterations form it again until it settles. `Energy::lagged_term` tells who has
/// it.
class LaggedTerm {
 public:
  virtual ~LaggedTerm() = default;

  /// Shows all terms of the stage, in order: the term may use what they have found.
  virtual void see(std::span<const Energy* const> terms) = 0;
  /// Forms what is kept at x, by which the energy becomes another one. Before the first time there is none
  /// of it. @return whether that may have changed forces
  virtual bool form_lag(const VectorX& x, const Conditions& c) = 0;
  /// Takes as much of what was formed last as makes such iterations settle (Relaxation); the rest is what was
  /// in use before. @return whether that changed anything
  virtual bool relax_lag() = 0;
  /// From now on the forces at any x are those with what is kept formed there, and the Hessian is that with
  /// what was formed last; or again all as before.
  virtual void couple_lag(bool is_coupled) = 0;
  /// Tells that the line search goes from x to x + t p: what is kept for the Hessian may follow.
  virtual void follow(const VectorX& x, const VectorX& p, double t) = 0;
};

}  // namespace resilin
