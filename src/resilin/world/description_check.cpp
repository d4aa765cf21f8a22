#include "resilin/world/description_check.hpp"

#include <cmath>

#include "resilin/integrator/integrator.hpp"
#include "resilin/linear/linear_solver.hpp"

namespace resilin {
namespace {

void require_positive(double value, const std::string& place) {
  if (value > 0 && std::isfinite(value)) return;
  throw InputError(place, "a finite number > 0", format_number(value));
}

void require_at_least_one(int value, const std::string& place) {
  if (value < 1) throw InputError(place, "a whole number >= 1", std::to_string(value));
}

void check_simulation(const Description& d, const std::string& place) {
  if (d.dimension != 2 && d.dimension != 3)
    throw InputError(place + "dimension", "2 or 3", std::to_string(d.dimension));
  if (!d.gravity.allFinite()) throw InputError(place + "gravity", "finite numbers", "inf or nan");
  require_positive(d.time_step, place + "time_step");
  require_positive(d.end_time, place + "end_time");
  require_at_least_one(d.load_steps, place + "load_steps");
  require_at_least_one(d.max_steps, place + "max_steps");
  require_known(d.load_control, place + "load_control");
  require_known(d.unstable_modes, place + "unstable_modes");
  make_integrator(d.integrator, place + "integrator");
  if (!d.adaptive) return;
  require_positive(d.adaptive->tolerance, place + "adaptive.tolerance");
  if (d.adaptive->min_step) require_positive(*d.adaptive->min_step, place + "adaptive.min_step");
  if (d.adaptive->max_step) require_positive(*d.adaptive->max_step, place + "adaptive.max_step");
}

void check_numerics(const Description& d) {
  const std::string newton = d.place + ": newton.";
  require_positive(d.newton.tolerance, newton + "tolerance");
  require_at_least_one(d.newton.max_iterations, newton + "max_iterations");
  require_known(d.newton.projection, newton + "projection");
  require_known(d.newton.inversion_bound, newton + "inversion_bound");
  require_linear_solver(d.solver.kind, d.place + ": solver.kind");
  require_at_least_one(d.solver.max_iterations, d.place + ": solver.max_iterations");
}

}  // namespace

void check_description(const Description& description) {
  check_simulation(description, description.place + ": simulation.");
  check_numerics(description);
  require_at_least_one(description.output.every, description.place + ": output.every");
  for (const OutputFormat format : description.output.formats)
    require_known(format, description.place + ": output.formats");
  for (const BodyDescription& body : description.bodies) {
    require_known(body.mass, body.place + ".mass");
    require_positive(body.scale, body.place + ".scale");
  }
}

}  // namespace resilin
