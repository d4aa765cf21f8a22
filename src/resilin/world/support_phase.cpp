#include "resilin/world/support_phase.hpp"

#include <algorithm>
#include <set>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/contact.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/rigid_region.hpp"

namespace resilin {
namespace {

/// When a phase that is not the first one begins [s].
double begin_of(const World& world, int phase) {
  return world.switch_times[static_cast<std::size_t>(phase - 1)];
}

std::vector<std::int32_t> owners_in(World& world, int phase) {
  for (Support& support : world.supports)
    support.holds = phase == 0 || support.holds_after(begin_of(world, phase));
  return supports_of_unknowns(world.dimension, world.num_nodes(), world.supports);
}

/// dE/dx of contact between bodies and of friction [N].
VectorX contact_gradient(const World& world, const State& state) {
  VectorX gradient = VectorX::Zero(state.positions.size());
  if (world.contact_of_phases.empty()) return gradient;
  world.contact->add_gradient(state.positions, conditions_of(state), gradient);
  add_friction_forces(world, state, gradient);
  return gradient;
}

/// The step that begins with a phase; null: none does.
const StepDescription* step_that_begins(const World& world, int phase) {
  if (phase == 0) return nullptr;
  const double begin = begin_of(world, phase);
  const auto found = std::ranges::find_if(
      world.steps, [&](const StepDescription& step) { return step.end > begin + time_slack(begin); });
  return found == world.steps.end() ? nullptr : &*found;
}

/// Forces that supports exert where they let go.
void renew_fading_forces(World& world, int phase, const VectorX& forces) {
  const std::optional<std::size_t> number = world.find_term({TermOrigin::Kind::release});
  if (!number) return;
  ActiveTime fading;
  if (forces.size() > 0) {
    const StepDescription* step = step_that_begins(world, phase);
    fading.function.form = TimeFunction::Table{
        .times = {begin_of(world, phase), step == nullptr ? world.end_time : step->end}, .values = {1, 0}};
  }
  VectorX own = forces.size() > 0 ? forces : VectorX::Zero(world.rest_positions.size());
  for (Index node = 0; node < world.num_nodes(); ++node)
    if (!world.share.owns(node)) own.segment(Eigen::Index{node} * world.dimension, world.dimension).setZero();
  world.terms[*number] =
      std::make_shared<DeadLoad>("release", std::move(own), world.rest_positions, std::move(fading));
}

}  // namespace

std::vector<double> switch_times(const std::vector<Support>& supports, const ContactDescription& contact) {
  std::set<double> times;
  for (const ContactPairDescription& pair : contact.pairs)
    times.insert(pair.switches.begin(), pair.switches.end());
  for (const Support& support : supports) times.insert(support.switches.begin(), support.switches.end());
  return {times.begin(), times.end()};
}

int phase_at(const World& world, double time) {
  const auto is_past = [time](double at) { return at <= time + 2 * time_slack(time); };
  return static_cast<int>(std::ranges::count_if(world.switch_times, is_past));
}

void enter_phase(World& world, int phase, const VectorX& forces, const VectorX& places) {
  if (world.switch_times.empty()) return;
  world.released_from.assign(world.is_fixed.size(), -1);
  const std::vector<std::int32_t> before =
      phase > 0 && forces.size() > 0 ? owners_in(world, phase - 1) : std::vector<std::int32_t>();
  world.support_of = owners_in(world, phase);
  for (std::size_t i = 0; i < world.is_fixed.size(); ++i) {
    world.is_fixed[i] = world.is_fixed_otherwise[i] != 0 || world.support_of[i] >= 0 ? 1 : 0;
    if (!before.empty() && world.is_fixed[i] == 0) world.released_from[i] = before[i];
  }
  world.support_places = places;
  renew_fading_forces(world, phase, forces);
  if (!world.contact_of_phases.empty())
    use_contact(world, world.contact_of_phases[static_cast<std::size_t>(phase)]);
}

std::string switch_supports(World& world, State& state, int phase, const VectorX& gradient) {
  while (state.phase < phase) {
    const std::vector<std::int32_t> before = world.support_of;
    const std::shared_ptr<const SurfaceContact> contact = world.contact;
    const VectorX touch = gradient.size() > 0 ? contact_gradient(world, state) : VectorX();
    ++state.phase;
    enter_phase(world, state.phase, {}, state.support_places);
    VectorX& forces = state.released_forces;
    if (world.contact != contact) {
      const std::string overlap = overlap_of_begun_contact(world, *contact, state.positions);
      if (!overlap.empty()) {
        enter_phase(world, --state.phase, forces, state.support_places);
        return overlap;
      }
    }
    forces.resize(0);
    if (world.contact != contact) {
      // The change of contact forces is taken up, and fades.
      if (gradient.size() > 0) forces = contact_gradient(world, state) - touch;
      if (forces.isZero(0)) forces.resize(0);
    }
    for (std::size_t i = 0; i < before.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const std::int32_t owner = world.support_of[i];
      if (owner < 0) {
        if (before[i] < 0 || world.is_fixed[i] != 0 || gradient.size() == 0) continue;
        if (forces.size() == 0) forces = VectorX::Zero(gradient.size());
        forces[k] += gradient[k];
        continue;
      }
      if (owner == before[i]) continue;
      const Support& support = world.supports[static_cast<std::size_t>(owner)];
      if (state.support_places.size() == 0) state.support_places = world.rest_positions;
      state.support_places[k] = support.switches.empty() ? world.rest_positions[k] : state.positions[k];
      if (world.is_dynamic && before[i] < 0) state.velocities[k] = 0;
    }
    // All processes have them, or none.
    if (world.share.any(forces.size() > 0) && forces.size() == 0)
      forces = VectorX::Zero(state.positions.size());
    if (world.share.any(state.support_places.size() > 0) && state.support_places.size() == 0)
      state.support_places = world.rest_positions;
    enter_phase(world, state.phase, forces, state.support_places);
  }
  return "";
}

void check_releases(const Description& description, World& world) {
  if (world.switch_times.empty()) return;
  const auto refuse_beside = [&](const auto& list, const char* what) {
    if (list.empty()) return;
    for (const Support& support : world.supports)
      if (!support.switches.empty())
        throw InputError(support.place, "no step that releases it beside a " + std::string(what),
                         "one at " + format_short(support.switches.front()) + " s",
                         "leave the release, or the " + std::string(what) + ", out");
  };
  refuse_beside(description.ties, "tie");
  refuse_beside(description.constraints, "constraint");
  refuse_beside(description.joints, "joint");
  refuse_beside(place_of_rigid_region(description), "rigid region");
  if (world.is_dynamic) return;
  for (int phase = phase_at(world, 0); phase <= static_cast<int>(world.switch_times.size()); ++phase) {
    // Later contact may hold what nothing else does.
    if (phase > phase_at(world, 0) &&
        (world.contact || !world.colliders.empty() || !world.mesh_colliders.empty()))
      break;
    enter_phase(world, phase, {}, {});
    const StepDescription* step = step_that_begins(world, phase);
    try {
      check_is_held(world);
    } catch (const InputError& error) {
      if (step == nullptr) throw;
      throw InputError("step \"" + step->name + "\"", error.what());
    }
  }
  enter_phase(world, 0, {}, {});
}

std::string step_name_at(const World& world, double time) {
  for (const StepDescription& step : world.steps)
    if (time <= step.end + time_slack(time)) return step.name;
  return world.steps.empty() ? "" : world.steps.back().name;
}

void refuse_releases(const Description& description, const std::string& asked_for) {
  for (const FixDescription& fix : description.fixes)
    if (!fix.switches.empty())
      throw InputError(fix.place, "a support that holds in all steps, for " + asked_for,
                       "one that a step releases", "leave the release out");
  for (const ContactPairDescription& pair : description.contact.pairs)
    if (!pair.switches.empty())
      throw InputError(pair.place, "a contact pair that is the same in all steps, for " + asked_for,
                       "one that a step switches", "leave it out of the steps");
}

}  // namespace resilin
