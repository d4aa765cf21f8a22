#pragma once

#include "scenes.hpp"

namespace resilin::bench {

/// Two bodies 0.3 of the activation distance (a thousandth of the diagonal of both) apart, of 12 n^2
/// triangles each: cubes face to face, balls, and balls of which one goes past the other. Medians of wall
/// times: finding candidates at rest and on the way (trees refitted) [ms], all times of collision and squared
/// distances [ns for each candidate], gradient and projected Hessian of the barrier with its distance [ns for
/// each active pair].
std::vector<Measurement> measure_collision(int n);

}  // namespace resilin::bench
