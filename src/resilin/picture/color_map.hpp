#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "resilin/picture/image.hpp"

namespace resilin {

/// Names of the colour maps: "viridis" for what goes from less to more, "diverging" for what has two signs.
std::vector<std::string> color_map_names();

/// The colour of t in [0, 1]; equal steps of t look equally large. The name must be one of the above.
Color map_color(std::string_view name, double t);

}  // namespace resilin
