#pragma once

#include <string>
#include <utility>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin::bench {

/// A soft cube of 8^3 cells of six tetrahedra on its lower side, under a skin of 6 (n + 1)^2 vertices.
Description cube_with_skin(int n);

/// From the message that a hand has moved to the frame that shows it, through server, sockets and simulation,
/// for a page that does not draw; and how many frames come in a second. With skins of 10,086 and 99,846
/// vertices.
std::vector<std::pair<std::string, double>> measure_latency();

}  // namespace resilin::bench
