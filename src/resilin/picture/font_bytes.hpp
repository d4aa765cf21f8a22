#pragma once

#include <span>

namespace resilin {

/// The file DejaVuSans.ttf beside this header; its licence is in DejaVuSans.LICENSE.
std::span<const unsigned char> font_bytes();

}  // namespace resilin
