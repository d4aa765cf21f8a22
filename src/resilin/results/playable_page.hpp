#pragma once

#include <nlohmann/json_fwd.hpp>
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

/// Scripts of such a page beside its source: the module, the scene and its warnings, each in a script.
std::string solver_scripts(std::string_view engine, const Description& scene,
                           std::span<const std::string> warnings);

/// Bytes in a script of a page, as a zlib stream in base64.
std::string packed_script(std::string_view id, std::string_view bytes);
/// Values in a script of a page.
std::string json_script(std::string_view id, const nlohmann::json& value);

}  // namespace resilin
