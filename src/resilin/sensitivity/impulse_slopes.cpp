#include "resilin/sensitivity/impulse_slopes.hpp"

namespace resilin {

ImpulseSlopes::ImpulseSlopes(const World& world, const Potential& potential, const StageReplay& stage)
    : world_(world), potential_(potential), stage_(stage) {}

const BlockMatrix& ImpulseSlopes::hessian() const {
  if (hessian_) return *hessian_;
  hessian_.emplace(world_.dimension, world_.pattern);
  for (const Energy* term : potential_.terms())
    if (acts_as_impulse(term->properties().category))
      term->add_hessian(stage_.motion.positions, potential_.conditions(), Projection::none, *hessian_);
  return *hessian_;
}

StageTerms ImpulseSlopes::terms() const {
  StageTerms all(world_, potential_);
  all.are_impulses = true;
  return all;
}

VectorX ImpulseSlopes::by_place(const VectorX& p, bool is_transposed) const {
  const VectorX& x = stage_.motion.positions;
  VectorX product;
  multiply(hessian(), p, product);
  for (const Energy* term : potential_.terms()) {
    if (term->properties().category != EnergyCategory::friction) continue;
    if (is_transposed)
      term->add_parameter_slopes("lag", x, p, potential_.conditions(), product);
    else
      term->add_parameter_forces("lag", x, p, potential_.conditions(), product);
  }
  return product;
}

VectorX ImpulseSlopes::change(const VectorX& dx, const Stage& of_stage, const TermChanges& of_terms) const {
  VectorX found = by_place(dx, false);
  add_stage_forces(terms(), stage_.motion.positions, of_terms, of_stage, found);
  if (stage_.stage.is_mean) found += by_base(of_stage.base_positions, false);
  return found;
}

VectorX ImpulseSlopes::add_slopes(const VectorX& w, Stage& by_stage, TermChanges& by_terms) const {
  add_stage_slopes(terms(), stage_.motion.positions, w, by_terms, by_stage);
  if (stage_.stage.is_mean) by_stage.base_positions += by_base(w, true);
  return by_place(w, true);
}

}  // namespace resilin
