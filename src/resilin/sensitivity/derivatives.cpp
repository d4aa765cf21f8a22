#include "resilin/sensitivity/derivatives.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "resilin/world/support_phase.hpp"
#include "resilin/world/viscoelastic_material.hpp"

namespace resilin {
namespace {

/// Throws InputError for what has no derivatives yet.
void check_is_differentiable(const Description& description) {
  const std::string place = description.place;
  const auto refuse = [&](const std::string& expected, const std::string& got, const std::string& cure) {
    throw InputError(place + ": derivatives", expected, got, cure);
  };
  if (description.modes) refuse("a static or dynamic scene", "modal analysis", "leave simulation.modes out");
  if (description.adaptive && description.is_dynamic)
    refuse("constant time steps", "adaptive time steps", "leave simulation.adaptive out");
  if (!description.is_dynamic && description.load_control == LoadControlKind::arc_length)
    refuse("equilibria at given loads", "simulation.load_control = \"arc_length\"",
           "take load_control = \"load\"");
  refuse_releases(description, "derivatives");
  const auto rubs_at_times = [](const auto& entry) { return !entry.friction_factor.is_constant(); };
  if (rubs_at_times(description.contact) || std::ranges::any_of(description.colliders, rubs_at_times))
    refuse("friction that is the same in all steps", "friction that a step switches",
           "leave it out of [[step]]");
  if (is_axisymmetric(description))
    refuse("a scene in 2D or 3D", "an axisymmetric one", "take a slice in 3D");
  if (description.thickness != 1)
    refuse("a thickness of 1 m", format_number(description.thickness) + " m",
           "leave simulation.thickness out: forces are those of each metre then");
  if (const auto history = find_history(description))
    throw InputError(history->place, "elastic materials where derivatives are asked for", history->kind,
                     history->cure);
  for (const CableDescription& cable : description.cables)
    if (cable.friction != 0)
      throw InputError(cable.place + ".friction", "no friction of a cable where derivatives are asked for",
                       format_number(cable.friction), "leave it out");
  for (const JointDescription& joint : description.joints)
    if (joint.damping != 0)
      throw InputError(joint.place + ".damping", "no damper of a joint where derivatives are asked for",
                       format_number(joint.damping), "leave it out; body.damping has derivatives");
}

}  // namespace

Derivatives::Derivatives(Description description, const std::vector<std::string>& wrt,
                         const DerivativeOptions& options)
    : options_(options),
      simulation_(World(std::move(description)), options.analyses),
      links_(simulation_.world()) {
  for (const std::string& name : wrt) parameters_.push_back(find_parameter(world(), name));
  if (const std::string kink = kink_of_barrier(world(), asked()); !kink.empty()) warnings_.push_back(kink);
  frames_.push_back(simulation_.frame());
}

std::unique_ptr<Derivatives> Derivatives::run(Description description, const std::vector<std::string>& wrt,
                                              const DerivativeOptions& options) {
  check_is_differentiable(description);
  return description.is_dynamic ? differentiate_motion(std::move(description), wrt, options)
                                : differentiate_statics(std::move(description), wrt, options);
}

std::vector<int> Derivatives::asked_frames() const {
  std::vector<int> asked;
  for (int frame = 0; frame < num_frames(); ++frame) {
    const double steps = frames_[static_cast<std::size_t>(frame)].load * world().load_steps;
    if (world().is_dynamic || std::abs(steps - std::round(steps)) < 1e-9) asked.push_back(frame);
  }
  return asked;
}

std::vector<FrameChange> Derivatives::forward(const std::vector<VectorX>& changes) {
  const std::vector<bool> all_frames(frames_.size(), true);
  return forward_all({changes}, all_frames).front();
}

void Derivatives::check_goes_on() const {
  if (options_.goes_on && !options_.goes_on()) throw Interrupted();
}

StepReport Derivatives::step() {
  check_goes_on();
  const StepReport report =
      simulation_.step([this](const NewtonReport&) { return !options_.goes_on || options_.goes_on(); });
  if (report.status == StepReport::Status::interrupted) throw Interrupted();
  if (report.status == StepReport::Status::not_converged)
    throw InputError(world().place + ": derivatives", "a run whose steps converge",
                     "step " + std::to_string(simulation_.state().step) + " that did not: " + report.reason,
                     "a gradient needs a converged run");
  return report;
}

WorldChange Derivatives::asked() const {
  WorldChange change(world());
  for (const Parameter& parameter : parameters_) parameter.ask(change);
  return change;
}

WorldChange Derivatives::spread(const std::vector<VectorX>& changes) const {
  WorldChange change = asked();
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (changes.size() != parameters_.size() || changes[i].size() != parameters_[i].value.size())
      throw InputError(parameters_[i].name,
                       "a change of " + std::to_string(parameters_[i].value.size()) + " numbers",
                       changes.size() != parameters_.size() ? "none" : std::to_string(changes[i].size()));
    parameters_[i].spread(changes[i], change);
  }
  return change;
}

std::vector<VectorX> Derivatives::gathered(const TermChanges& terms, WorldChange slopes) const {
  links_.gather(terms, slopes);
  return by_parameters(slopes);
}

std::vector<VectorX> Derivatives::by_parameters(const WorldChange& slopes) const {
  std::vector<VectorX> all;
  for (const Parameter& parameter : parameters_) {
    all.push_back(VectorX::Zero(parameter.value.size()));
    parameter.gather(slopes, all.back());
  }
  return all;
}

std::vector<VectorX> Derivatives::by_parameters_of_term(std::size_t number, const Energy& term,
                                                        const VectorX& x, const VectorX& w,
                                                        const Conditions& c) const {
  WorldChange slopes = asked();
  TermChanges terms = links_.zero(slopes);
  for (auto& [name, of_term] : terms[number]) term.add_parameter_slopes(name, x, w, c, of_term);
  return gathered(terms, std::move(slopes));
}

VectorX Derivatives::weights_of(const std::vector<Vector3>& reactions) const {
  const int dim = world().dimension;
  VectorX weights = VectorX::Zero(world().rest_positions.size());
  if (reactions.empty()) return weights;
  for (std::size_t i = 0; i < world().support_of.size(); ++i)
    if (const std::int32_t support = world().support_of[i]; support >= 0)
      weights[static_cast<Eigen::Index>(i)] =
          reactions[static_cast<std::size_t>(support)][static_cast<int>(i) % dim];
  if (world().constraints) world().dependents()->follow(weights);  // they pass their forces on to supports
  return weights;
}

std::vector<Vector3> Derivatives::reactions_of(VectorX gradient) const {
  const int dim = world().dimension;
  if (world().constraints) world().dependents()->add_forces(gradient);
  std::vector<Vector3> reactions(world().supports.size(), Vector3::Zero());
  for (std::size_t i = 0; i < world().support_of.size(); ++i)
    if (const std::int32_t support = world().support_of[i]; support >= 0)
      reactions[static_cast<std::size_t>(support)][static_cast<int>(i) % dim] +=
          gradient[static_cast<Eigen::Index>(i)];
  return reactions;
}

}  // namespace resilin
