#include "resilin/picture/picture_check.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/picture/color_map.hpp"

namespace resilin {

void check_picture(const PictureOptions& options) {
  for (const int size : {options.width, options.height})
    if (size < 64 || size > 8192) throw InputError("size", "64 to 8192 pixels", std::to_string(size));
  if (options.range && !((*options.range)[0] < (*options.range)[1]))
    throw InputError("range", "a smaller and a larger number",
                     format_number((*options.range)[0]) + " and " + format_number((*options.range)[1]));
  std::vector<std::string> maps = color_map_names();
  maps.insert(maps.begin(), "auto");
  if (std::ranges::find(maps, options.map) == maps.end())
    throw InputError("map", "one of " + join(maps), '"' + options.map + '"');
  if (options.edges != "auto" && options.edges != "on" && options.edges != "off")
    throw InputError("edges", "auto, on or off", '"' + options.edges + '"');
  if (!std::isfinite(options.scale)) throw InputError("scale", "a finite number", "another");
}

}  // namespace resilin
