#pragma once

#include <optional>

#include "resilin/sensitivity/replay.hpp"
#include "resilin/sensitivity/stage_slopes.hpp"

namespace resilin {

/// How the forces of contact and of friction in a stage change, their gradient C as the balance of forces
/// counts it: schemes that look back take it apart from all other forces (docs/theory/gradients.md, G.7).
class ImpulseSlopes {
 public:
  /// @param potential  of the stage; to outlive this
  ImpulseSlopes(const World& world, const Potential& potential, const StageReplay& stage);

  /// dC/dx p, or its transpose times p.
  VectorX by_place(const VectorX& p, bool is_transposed) const;
  /// The same of the base x_0 of a stage whose unknown x is a mean, where forces are those at 2 x - x_0.
  VectorX by_base(const VectorX& p, bool is_transposed) const { return -0.5 * by_place(p, is_transposed); }

  /// dC by a change of x, of the stage and of the terms.
  VectorX change(const VectorX& dx, const Stage& of_stage, const TermChanges& of_terms) const;
  /// Adds the slopes of w . C. @return those by x
  VectorX add_slopes(const VectorX& w, Stage& by_stage, TermChanges& by_terms) const;

 private:
  StageTerms terms() const;
  /// d2/dx2 of their energies; of friction that by what slips.
  const BlockMatrix& hessian() const;

  const World& world_;
  const Potential& potential_;
  const StageReplay& stage_;
  mutable std::optional<BlockMatrix> hessian_;  ///< once it is asked for
};

}  // namespace resilin
