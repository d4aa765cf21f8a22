#pragma once

#include <string>

namespace resilin::testing {

/// A jelly cube that falls: little to compute.
inline const std::string jelly = R"([simulation]
kind = "dynamic"
gravity = [0, 0, -9.81]
time_step = 0.01
end_time = 1
[[body]]
name = "jelly"
element = "P1"
mesh = { box = { size = [1, 1, 1], cells = [2, 2, 2] } }
material = { law = "stable_neo_hookean", youngs_modulus = 1e4, poissons_ratio = 0.3, density = 1000 }
[[fix]]
where = { plane = { axis = "z", at = 0 } }
)";

}  // namespace resilin::testing
