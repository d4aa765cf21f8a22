#pragma once

#include <string>
#include <vector>

#include "resilin/io/vtu.hpp"

namespace resilin {

/// One number for each point or each cell of a frame.
struct PictureField {
  std::string name;       ///< name of the array
  std::string component;  ///< "x", "yz", "1"; empty for a scalar and for the length of a vector
  bool is_on_points = true;
  std::vector<double> values;
};

/// Picks "von_mises", "displacement" (its length), "displacement.z", "cauchy_stress.xy" or
/// "principal_stress.1" out of a frame. Throws InputError that lists the fields there are, or the components.
PictureField pick_field(const VtuContent& frame, const std::string& name, const std::string& place);

/// Names of the arrays that can be shown.
std::vector<std::string> picture_field_names(const VtuContent& frame);

}  // namespace resilin
