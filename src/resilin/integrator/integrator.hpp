#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Positions and velocities at one instant; what an integrator advances.
struct Motion {
  VectorX positions;   ///< [m], dim numbers per node
  VectorX velocities;  ///< [m/s]
};

/// One minimisation of an implicit step: min_x 1/(2 s) |x - x~|^2_M + sum of energies at `time_fraction`.
struct Stage {
  VectorX target;            ///< x~ [m]
  double scale = 0;          ///< s [s^2]
  double time_fraction = 1;  ///< of the step, where loads and moving supports are taken
};

/// A time stepping scheme as a list of stages (docs/theory/integrators.md).
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::string_view name() const = 0;
  virtual int num_stages() const = 0;

  /// The minimisation of stage `stage`. `solutions` holds the minimisers of the stages before it.
  virtual Stage begin_stage(int stage, const Motion& start, const std::vector<VectorX>& solutions,
                            double time_step) const = 0;

  /// The motion at the end of the step, from the minimisers of all stages.
  virtual Motion finish(const Motion& start, const std::vector<VectorX>& solutions,
                        double time_step) const = 0;
};

/// An integrator by name; throws InputError for an unknown one, `place` begins its message.
std::unique_ptr<Integrator> make_integrator(std::string_view name, const std::string& place);

/// Names of all integrators, in the order of the catalogue.
std::vector<std::string> integrator_names();

}  // namespace resilin
