#pragma once

#include "resilin/io/vtu.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// A frame with the skins of bodies, as triangles, in the place of the cells that carry them: what a picture
/// shows of fields on points. Values on a skin keep within those of its body's nodes, as on the page. Of
/// cell data the number of the body is kept.
/// @param frame  of `frame_content`, with all its bodies
VtuContent with_skins(const World& world, const State& state, const VtuContent& frame);

}  // namespace resilin
