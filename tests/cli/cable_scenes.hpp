#pragma once

#include <string>

namespace resilin::testing {

/// A block on a foot that a cable through its top pulls to the side of x.
inline const std::string pulled_block = R"(
[[body]]
name = "block"
mesh = { box = { size = [0.1, 0.1, 0.3], cells = [2, 2, 6] } }
element = "P1"
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3 }

[[fix]]
name = "foot"
where = { group = "z_min" }

[[cable]]
name = "cable"
points = [{ at = [0.2, 0.05, 0] }, { body = "block", at = [0.1, 0.05, 0.15] }, { body = "block", at = [0.1, 0.05, 0.3] }]
tension = 5
)";

}  // namespace resilin::testing
