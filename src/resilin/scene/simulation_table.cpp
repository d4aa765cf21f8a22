#include "resilin/fields/catalog.hpp"
#include "resilin/integrator/integrator.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {

Keys<Description> simulation_keys() {
  using D = Description;
  const D defaults;
  return {
      key<D>({"kind", one_of({"static", "dynamic", "modes"}), "", "\"static\"",
              "Equilibrium under the loads, motion in time, or free vibrations."},
             [](const SceneNode& node, D& d) {
               const std::string kind = read_choice(node, {"static", "dynamic", "modes"});
               d.is_dynamic = kind == "dynamic";
               if (kind == "modes") d.modes.emplace();
               node.context->is_dynamic = d.is_dynamic;
             }),
      key<D>({"dimension", "2 or 3", "", default_text(defaults.dimension),
              "3, or 2 for plane strain of unit thickness. It sets the length of every vector."},
             [](const SceneNode& node, D& d) {
               const int dimension = read_integer(node);
               if (dimension != 2 && dimension != 3) node.fail("2 or 3");
               d.dimension = node.context->dimension = dimension;
             }),
      vector_key("gravity", &D::gravity, "m/s^2", "Pulls every body in proportion to its density."),
      number_key("time_step", &D::time_step, "s", positive, "Length of a step in motion; at most end_time."),
      number_key(
          "end_time", &D::end_time, "s", positive,
          "Motion stops with the first step that reaches it. Static: the time at load factor 1, for what "
          "follows time."),
      choice_key("integrator", &D::integrator, integrator_names(), {}, "How motion steps through time."),
      key<D>({"adaptive", "[adaptive](#adaptive)", "", "none: equal steps",
              "In motion: steps as long as their error allows."},
             [](const SceneNode& node, D& d) { read_adaptive_steps(node, d.adaptive); }),
      key<D>({"modes", "[modes](#modes)", "", "see there", "Which vibrations are sought."},
             [](const SceneNode& node, D& d) { read_modes(node, d.modes); }),
      integer_key(
          "load_steps", &D::load_steps, at_least_one,
          "Static: number of equal steps that the loads are first tried in. A step that fails is halved."),
      choice_key(
          "load_control", &D::load_control,
          "Static: the load grows from step to step, or the path of equilibria is followed by arc length, "
          "also where the load falls (snap-through)."),
      integer_key("max_steps", &D::max_steps, at_least_one,
                  "Static, arc_length: the path ends at load factor 1 or after so many steps."),
      choice_key(
          "unstable_modes", &D::unstable_modes,
          "Static: whether each frame says how many unstable modes the equilibrium has (buckling). \"auto\" "
          "counts up to 10,000 free unknowns, beyond where a direct solver has shown that there are none."),
  };
}

Keys<NewtonOptions> newton_keys() {
  using N = NewtonOptions;
  return {
      number_key("tolerance", &N::tolerance, "", positive, "Largest residual force, relative to the loads."),
      integer_key(
          "max_iterations", &N::max_iterations, at_least_one,
          "Newton iterations of a load or time step, and some more for each time that friction is formed "
          "anew. A number below 100 truncates a time step, safely."),
      integer_key("max_failures", &N::max_failures, not_negative,
                  "Motion: the run ends after so many steps in a row for which no solution was found; those "
                  "that a max_iterations below 100 cuts short do not count. 0: it never does."),
      choice_key("projection", &N::projection,
                 "What is done to negative eigenvalues of the elements' matrices."),
      choice_key("inversion_bound", &N::inversion_bound,
                 "Where laws that need J > 0 keep it: at the quadrature points, or, shown by a bound, in the "
                 "whole of every cell."),
  };
}

Keys<SolverOptions> solver_keys() {
  using S = SolverOptions;
  std::vector<std::string> kinds = linear_solver_names();
  kinds.insert(kinds.begin(), "auto");
  return {
      key<S>(
          {"kind", "text", "", default_text(S{}.kind),
           "Linear solver: \"auto\" picks by kind and size of the problem; `resilin info` lists the others."},
          [kinds](const SceneNode& node, S& s) { s.kind = read_choice(node, kinds); }),
      integer_key("max_iterations", &S::max_iterations, at_least_one,
                  "Iterations of an iterative solver, for each solve."),
  };
}

Keys<OutputOptions> output_keys() {
  using O = OutputOptions;
  return {
      integer_key("every", &O::every, at_least_one, "A frame is written for each n-th step."),
      key<O>({"fields", "list of names", "", default_text(O{}.fields),
              "What a frame holds; [results.md](results.md#fields) lists the names. `averaged_` before the "
              "name of "
              "a cells' field averages it at the vertices, `nodal_` smooths it onto them."},
             [](const SceneNode& node, O& o) { o.fields = read_choices(node, field_names()); }),
      choices_key(
          "formats", &O::formats,
          "vtu: a file for each frame, for ParaView; html: result.html, one page with the motion that "
          "opens in any browser; usda: result.usda, for Blender and Houdini."),
  };
}

Keys<ProbeDescription> probe_keys() {
  using P = ProbeDescription;
  return {
      text_key("name", &P::name, "probe[0] ...", "The report lists the motion under it."),
      text_key("body", &P::body, "the only body", "Name of the body that is watched."),
      key<P>({"at", "vector", "m", "required", "The vertex nearest to this rest position is watched."},
             [](const SceneNode& node, P& p) { p.at = read_vector(node); }),
  };
}

}  // namespace resilin
