#pragma once

#include <span>
#include <string>
#include <string_view>

#include "resilin/world/description.hpp"

namespace resilin {

/// One page that plays with a scene without a server: the page, what simulates in it and the scene with its
/// meshes (docs/view_protocol.md, "Addresses"). It loads nothing from elsewhere.
///
/// @param engine    the WebAssembly module of the preset wasm (apps/play)
/// @param warnings  of the scene, one line each
std::string playable_page(std::string_view engine, const Description& scene,
                          std::span<const std::string> warnings);

}  // namespace resilin
