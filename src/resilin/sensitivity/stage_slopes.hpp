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

  /// All terms of the world.
  StageTerms(const World& world, const Potential& of);
  StageTerms(const Potential& of, std::vector<std::size_t> which)
      : potential(of), numbers(std::move(which)) {}
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
