#pragma once

#include "resilin/sensitivity/term_changes.hpp"
#include "resilin/simulation/potential.hpp"

/// Derivatives of the forces of one stage of a step by everything but the places themselves: by the numbers
/// of its terms and by what the stage starts from.
namespace resilin {

/// The terms of a potential and their numbers in the world.
struct StageTerms {
  const Potential& potential;
  std::vector<std::size_t> numbers;
  bool are_impulses = false;  ///< for contact and friction alone

  /// All terms of the world.
  StageTerms(const World& world, const Potential& of);
  StageTerms(const Potential& of, std::vector<std::size_t> which)
      : potential(of), numbers(std::move(which)) {}

  /// Calls `visit(term, its number in the world)`.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t t = 0; t < numbers.size(); ++t) {
      const Energy& term = *potential.terms()[t];
      if (!are_impulses || acts_as_impulse(term.properties().category)) visit(term, numbers[t]);
    }
  }
};

/// gradient += what changes of the terms and of the stage do to dE/dx at x to first order.
/// @param stage  changes of base_positions, base_velocities and shape, which may be empty; its duration is
///               that of the stage
void add_stage_forces(const StageTerms& terms, const VectorX& x, const TermChanges& changes,
                      const Stage& stage, VectorX& gradient);

/// The slopes of w . dE/dx: adds those by what `slopes` has, and those by what the stage starts from where
/// `stage` has room for them.
void add_stage_slopes(const StageTerms& terms, const VectorX& x, const VectorX& w, TermChanges& slopes,
                      Stage& stage);

}  // namespace resilin
