#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin::bench {

/// A measured quantity, such as {"milliseconds_per_step", 4.5}.
using Measurement = std::pair<std::string, double>;

/// A bar of 4 x 1 x 1 m clamped at x = 0, 6 Kuhn tetrahedra in each of 4n x n x n cubes, neo-Hookean with E =
/// 1 MPa, nu = 0.4. Static: -3000 N/m^3 along z in one load step ("S1"). Dynamic: 50 steps of 0.01 s under
/// its weight with consistent mass ("D1"). With an element of degree 2, nu = 0.49 ("S2"). Stops at a force
/// residual of 1e-8 of the load.
Description bar(int n, bool is_dynamic, const std::string& element);

/// A cube of 0.4 m with one side face clamped, n^3 cells of five tetrahedra, E = 0.1 MPa, nu = 0.4, 1000
/// kg/m^3, that falls under its weight for one second in steps of 1/60 s. Stops at 1e-6 of the weight.
Description cube(int n);

/// The same cube, free, 5 cm above the ground.
Description dropped_cube(int n);

/// Two such cubes: the lower falls on the ground, the upper, 5 cm above it, on the lower; beside it by 5 and
/// 3 cm or in line with it.
Description two_cubes(int n, bool is_aligned);
/// The same, everything rubbing on everything.
Description with_friction(double coefficient, Description scene);

/// The armadillo that its first author let people drag: 627 tetrahedra, springs of 1e5 N/m pull one ear aside
/// for a second and let go; steps of 0.01 s, each converged. @param mesh  armadillo_coarse.node
Description seed001(const std::filesystem::path& mesh);

/// Where a mesh would be that may not be shipped: below $RESILIN_SHARED.
std::filesystem::path shared_mesh(const std::string& name);

std::vector<Measurement> measure_bar(int n, bool is_dynamic, const std::string& element);
std::vector<Measurement> measure_cube(int n);
/// One cube that falls on the ground and two that fall on each other.
std::vector<Measurement> measure_contact(int n);
/// Needs $RESILIN_SHARED: the mesh may not be shipped. @throws InputError saying so
std::vector<Measurement> measure_seed001();

}  // namespace resilin::bench
