#include "resilin/world/description_check.hpp"

#include <cmath>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/integrator/integrator.hpp"
#include "resilin/linear/linear_solver.hpp"

namespace resilin {
namespace {

void require_at_least_one(int value, const std::string& place) {
  if (value < 1) throw InputError(place, "a whole number >= 1", std::to_string(value));
}

/// Squares and inverse squares of times, times stiffnesses and masses, stay numbers within these [s].
constexpr double shortest_time = 1e-30, longest_time = 1e30;
constexpr double most_steps = 1e9;  ///< a counter holds them, whatever is added
/// Share of the end time: a shorter step is lost when the time is added to it.
constexpr double finest_step = 1e-15;

void require_time(double value, const std::string& place) {
  require_positive(value, place);
  if (value >= shortest_time && value <= longest_time) return;
  throw InputError(place,
                   "from " + format_number(shortest_time) + " to " + format_number(longest_time) + " s",
                   format_number(value));
}

void check_times(const Description& d, const std::string& place) {
  require_time(d.time_step, place + "time_step");
  require_time(d.end_time, place + "end_time");
  if (!d.is_dynamic) return;
  if (d.time_step > d.end_time) {
    throw InputError(place + "time_step", "at most simulation.end_time, " + format_number(d.end_time) + " s",
                     format_number(d.time_step), "shorten the step or set a later end");
  }
  if (d.end_time / d.time_step > most_steps) {
    throw InputError(place + "time_step", "at most " + format_number(most_steps) + " steps until the end",
                     format_short(d.end_time / d.time_step) + " of " + format_number(d.time_step) +
                         " s until " + format_number(d.end_time) + " s");
  }
  if (!d.adaptive) return;
  require_positive(d.adaptive->tolerance, place + "adaptive.tolerance");
  const double finest = finest_step * d.end_time;
  for (const auto& [step, name] : {std::pair{d.adaptive->min_step, "adaptive.min_step"},
                                   std::pair{d.adaptive->max_step, "adaptive.max_step"}}) {
    if (!step) continue;
    require_positive(*step, place + name);
    if (*step < finest) {
      throw InputError(place + name,
                       "at least " + format_short(finest) + " s, which still advances the time at the end",
                       format_number(*step));
    }
  }
}

void check_simulation(const Description& d, const std::string& place) {
  if (d.dimension != 2 && d.dimension != 3)
    throw InputError(place + "dimension", "2 or 3", std::to_string(d.dimension));
  require_positive(d.thickness, place + "thickness");
  if (d.dimension == 3 && d.thickness != 1)
    throw InputError(place + "thickness", "a scene in 2D (simulation.dimension)", "one in 3D",
                     "leave it out");
  if (!d.gravity.allFinite()) throw InputError(place + "gravity", "finite numbers", "inf or nan");
  check_times(d, place);
  require_at_least_one(d.load_steps, place + "load_steps");
  require_at_least_one(d.max_steps, place + "max_steps");
  require_known(d.load_control, place + "load_control");
  require_known(d.unstable_modes, place + "unstable_modes");
  require_known(d.on_jump, place + "on_jump");
  make_integrator(d.integrator, place + "integrator");
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

void require_positive(double value, const std::string& place) {
  if (value > 0 && std::isfinite(value)) return;
  throw InputError(place, "a finite number > 0", format_number(value));
}

void require_axis(int axis, int dim, const std::string& place) {
  if (axis >= 0 && axis < dim) return;
  throw InputError(place, dim == 3 ? "x, y or z (0, 1 or 2)" : "x or y (0 or 1)", std::to_string(axis));
}

void check_description(const Description& description) {
  check_simulation(description, description.place + ": simulation.");
  check_numerics(description);
  require_at_least_one(description.output.every, description.place + ": output.every");
  for (const OutputFormat format : description.output.formats)
    require_known(format, description.place + ": output.formats");
  for (const BodyDescription& body : description.bodies) {
    require_known(body.mass, body.place + ".mass");
    require_known(body.contact_surface, body.place + ".contact_surface");
    if (body.contact_surface == MeetingSurface::skin && !body.skin)
      throw InputError(body.place + ".contact_surface", "\"boundary\" for a body without a skin", "\"skin\"",
                       "give the body a skin (skin = \"surface.obj\")");
    require_positive(body.scale, body.place + ".scale");
  }
}

}  // namespace resilin
