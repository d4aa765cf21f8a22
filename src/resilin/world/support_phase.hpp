#pragma once

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// Supports and contact pairs that the steps of a scene release and activate again. A phase lies between two
/// such times.
namespace resilin {

/// When any support lets go of its vertices or takes hold of them, or contact of a pair ends or begins,
/// rising [s].
std::vector<double> switch_times(const std::vector<Support>& supports, const ContactDescription& contact);

/// The phase in which a step lies that begins at `time` [s].
int phase_at(const World& world, double time);

/// Lets those supports hold and those contact pairs act that do in a phase. In statics the forces of those
/// that it releases decrease evenly until the step of the scene ends.
/// @param forces  of supports and contact at the release [N]; empty: none
/// @param places  from which supports move their vertices [m]; empty: rest positions
void enter_phase(World& world, int phase, const VectorX& forces, const VectorX& places);

/// Leads a state and its world into a phase.
/// @param gradient  dE/dx there in statics: reactions follow from it; else empty
/// @return          bodies whose contact begins and that overlap or touch, in words; empty: none
std::string switch_supports(World& world, State& state, int phase, const VectorX& gradient);

/// Throws InputError where a support may not be released: by what follows its vertices, or, as far as that
/// can be known before the run, because a body would then be loose in statics.
void check_releases(const Description& description, World& world);

/// The name of the step in which a time lies, its end included; empty where a scene has none.
std::string step_name_at(const World& world, double time);

/// Throws InputError where a step releases a support or switches a contact pair.
/// @param asked_for  what cannot be had then: "derivatives"
void refuse_releases(const Description& description, const std::string& asked_for);

}  // namespace resilin
