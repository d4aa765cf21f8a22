#pragma once

#include <span>
#include <string>
#include <string_view>

/// The page in the browser (apps/viewer/web), one HTML file that loads nothing from elsewhere.
namespace resilin {

/// The file apps/viewer/web/dist/page.html as it was when this library was built.
std::span<const unsigned char> page_bytes();

/// The page with another source than a live scene.
/// @param source  what takes the place of `<script id="source" ...>`: docs/view_protocol.md, "Addresses"
/// @param nonce   of the page's program, for a server that lets no other script run; empty: none
std::string page_with(std::string_view source, std::string_view nonce);

/// `<script id="source" ...>` of this kind: "live" or "recorded".
std::string source_script(std::string_view kind);

}  // namespace resilin
