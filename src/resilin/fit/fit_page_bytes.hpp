#pragma once

#include <span>

namespace resilin {

/// The file fit_page.html beside this header: the page around what fit_page.cpp draws.
std::span<const unsigned char> fit_page_bytes();

}  // namespace resilin
