#pragma once

#include <filesystem>

#include "resilin/picture/picture.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Draws a frame that a run has left.
///
/// Label and unit of the colour bar are those of the field. A field that the frame does not hold is computed
/// from it and from the scene that the run has kept (`saved_world`); where there is none it is refused with
/// those that the frame holds. An empty field means nodal_von_mises, which is what the page shows, and
/// von_mises or displacement where that is not to be had. Where the scene is there, gravity says what is up,
/// and what is known at the nodes is drawn on the skin of a body that has one.
/// @param place  the folder of a run, or one .vtu file
/// @param frame  from 0, or from the end: -1 is the last
/// @throws InputError
Image draw_result(const std::filesystem::path& place, int frame, PictureOptions options);

/// The same for a state; it may be coloured by any field of fields/catalog.hpp.
Image draw_state(const World& world, const State& state, PictureOptions options);

}  // namespace resilin
