#include "resilin/sensitivity/stage_slopes.hpp"

#include <numeric>

namespace resilin {

StageTerms::StageTerms(const World& world, const Potential& of) : potential(of), numbers(world.terms.size()) {
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
}

void add_stage_forces(const StageTerms& terms, const VectorX& x, const TermChanges& changes,
                      const Stage& stage, VectorX& gradient) {
  const Conditions& c = terms.potential.conditions();
  terms.for_each([&](const Energy& term, std::size_t number) {
    for (const EnergyParameter& parameter : term.parameters()) {
      const auto add = [&](const VectorX& change) {
        if (change.size() > 0) term.add_parameter_forces(parameter.name, x, change, c, gradient);
      };
      if (parameter.name == "base_positions") {
        add(stage.base_positions);
      } else if (parameter.name == "target") {
        if (stage.base_positions.size() > 0) add(stage.target());
      } else if (parameter.name == "shape") {
        add(stage.shape);
      } else {
        const auto& of_term = changes[number];
        if (const auto found = of_term.find(parameter.name); found != of_term.end()) add(found->second);
      }
    }
  });
}

void add_stage_slopes(const StageTerms& terms, const VectorX& x, const VectorX& w, TermChanges& slopes,
                      Stage& stage) {
  const Conditions& c = terms.potential.conditions();
  terms.for_each([&](const Energy& term, std::size_t number) {
    for (const EnergyParameter& parameter : term.parameters()) {
      const auto add = [&](VectorX& to) {
        if (to.size() > 0) term.add_parameter_slopes(parameter.name, x, w, c, to);
      };
      if (parameter.name == "base_positions") {
        add(stage.base_positions);
      } else if (parameter.name == "target") {
        VectorX by_target = VectorX::Zero(stage.base_positions.size());
        add(by_target);
        if (by_target.size() == 0) continue;
        stage.base_positions += by_target;
        stage.base_velocities += stage.duration * by_target;
      } else if (parameter.name == "shape") {
        add(stage.shape);
      } else {
        auto& of_term = slopes[number];
        if (const auto found = of_term.find(parameter.name); found != of_term.end()) add(found->second);
      }
    }
  });
}

}  // namespace resilin
