#pragma once

#include "resilin/scene/value.hpp"
#include "served_live_scene.hpp"

namespace resilin::viewer {

/// The values of a scene as its page has changed them: held faces as supports of their own, loads, materials,
/// the damping by mass, gravity, the ground, contact, motors and cables where they are no longer as they
/// were. What belongs to playing alone (hand, ball, pins, speed, time step, tolerance) is left out.
void apply_changes(SceneValue& scene, const SceneChanges& changes);

/// The materials that were changed, written out, or those of all bodies.
void write_material(SceneValue& scene, const SceneChanges& changes, bool writes_all = false);

}  // namespace resilin::viewer
