#include "resilin/fields/catalog.hpp"
#include "resilin/integrator/integrator.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {

bool is_plane_stress_dimension(const SceneNode& node) {
  const auto* text = std::get_if<std::string>(&node.value->data);
  return text != nullptr && *text == "plane_stress";
}

bool is_axisymmetric_dimension(const SceneNode& node) {
  const auto* text = std::get_if<std::string>(&node.value->data);
  return text != nullptr && *text == "axisymmetric";
}

Keys<Description> simulation_keys() {
  using D = Description;
  const D defaults;
  return {
      key<D>({"kind", one_of({"static", "dynamic", "modes"}), "", "\"static\"",
              "Quasi-static, dynamic (transient) or modal analysis."},
             [](const SceneNode& node, D& d) {
               const std::string kind = read_choice(node, {"static", "dynamic", "modes"});
               d.is_dynamic = kind == "dynamic";
               if (kind == "modes") d.modes.emplace();
               node.context->is_dynamic = d.is_dynamic;
             }),
      key<D>({"dimension", "2, 3, \"plane_stress\" or \"axisymmetric\"", "", default_text(defaults.dimension),
              "3, or 2 for plane strain. It sets the length of every vector. "
              "`\"plane_stress\"`: 2 in [plane stress](materials.md#plane-stress), for thin sheets. "
              "`\"axisymmetric\"`: 2 with x the radius and y the axis of "
              "[axisymmetric solids](materials.md#axisymmetric-solids)."},
             [](const SceneNode& node, D& d) {
               const std::string expected = "2, 3, \"plane_stress\" or \"axisymmetric\"";
               int dimension = 2;
               if (!is_plane_stress_dimension(node) && !is_axisymmetric_dimension(node)) {
                 if (std::holds_alternative<std::string>(node.value->data)) node.fail(expected);
                 dimension = read_integer(node);
                 if (dimension != 2 && dimension != 3) node.fail(expected);
               }
               d.dimension = node.context->dimension = dimension;
             }),
      number_key("thickness", &D::thickness, "m", positive,
                 "In 2D: the thickness, of which forces, energies, volumes and masses are those. Not in "
                 "axisymmetric solids, where they are those of the full turn."),
      vector_key("gravity", &D::gravity, "m/s^2", "Gravitational acceleration."),
      number_key("time_step", &D::time_step, "s", positive, "Dynamics: time step; at most end_time."),
      number_key("end_time", &D::end_time, "s", positive,
                 "Dynamics: end of the run. Static: the time at load factor 1, for functions of time."),
      choice_key("integrator", &D::integrator, integrator_names(), {}, "Time integration scheme."),
      key<D>({"adaptive", "[adaptive](#adaptive)", "", "none: equal steps",
              "Dynamics: adaptive time steps by an error estimate."},
             [](const SceneNode& node, D& d) { read_adaptive_steps(node, d.adaptive); }),
      key<D>({"modes", "[modes](#modes)", "", "see there", "Modal analysis."},
             [](const SceneNode& node, D& d) { read_modes(node, d.modes); }),
      integer_key("load_steps", &D::load_steps, at_least_one,
                  "Static: number of equal load increments. A cutback halves an increment that fails."),
      choice_key("load_control", &D::load_control,
                 "Static: load increments, or arc length, which follows the equilibrium path beyond limit "
                 "points (snap-through)."),
      integer_key("max_steps", &D::max_steps, at_least_one,
                  "Static, arc_length: limit of steps along the path."),
      choice_key("unstable_modes", &D::unstable_modes,
                 "Static: count the unstable modes of each equilibrium (buckling). \"auto\" counts up to "
                 "10,000 free DOFs; beyond, it reports 0 where a direct solver has found none."),
      choice_key("on_jump", &D::on_jump,
                 "Static: if bodies jump to another equilibrium (snap-through, slip-off or unwinding, with a "
                 "loss of strain energy), continue with a warning (follow) or stop before it."),
  };
}

Keys<NewtonOptions> newton_keys() {
  using N = NewtonOptions;
  return {
      number_key("tolerance", &N::tolerance, "", positive,
                 "Convergence tolerance: residual force relative to the loads."),
      integer_key("max_iterations", &N::max_iterations, at_least_one,
                  "Limit of Newton iterations per load increment or time step; friction iterations add some. "
                  "A limit below 100 truncates a time step safely."),
      integer_key("max_failures", &N::max_failures, not_negative,
                  "Dynamics: the run ends after this many failed steps in a row; steps truncated by a "
                  "max_iterations below 100 do not count. 0: never."),
      choice_key("projection", &N::projection, "Projection of negative eigenvalues of the element Hessians."),
      choice_key("inversion_bound", &N::inversion_bound,
                 "Where laws that need J > 0 enforce it: at the quadrature points, or everywhere in each "
                 "cell (by a bound)."),
  };
}

Keys<SolverOptions> solver_keys() {
  using S = SolverOptions;
  std::vector<std::string> kinds = linear_solver_names();
  kinds.insert(kinds.begin(), "auto");
  return {
      key<S>({"kind", "text", "", default_text(S{}.kind),
              "Linear solver: \"auto\" selects by kind and size of the problem; `resilin info` lists the "
              "others."},
             [kinds](const SceneNode& node, S& s) { s.kind = read_choice(node, kinds); }),
      integer_key("max_iterations", &S::max_iterations, at_least_one,
                  "Limit of iterations of an iterative solver per solve."),
  };
}

Keys<OutputOptions> output_keys() {
  using O = OutputOptions;
  return {
      integer_key("every", &O::every, at_least_one, "Output interval: one frame for every n-th step."),
      key<O>({"fields", "list of names", "", default_text(O{}.fields),
              "Fields of a frame; [results.md](results.md#fields) lists them. `averaged_` before a cell "
              "field averages it at the vertices, `nodal_` projects it onto them."},
             [](const SceneNode& node, O& o) { o.fields = read_choices(node, field_names()); }),
      choices_key("formats", &O::formats,
                  "vtu: a file for each frame, for ParaView; html: result.html, one self-contained page for "
                  "any browser; usda: result.usda, for Blender and Houdini."),
  };
}

Keys<ProbeDescription> probe_keys() {
  using P = ProbeDescription;
  return {
      text_key("name", &P::name, "probe[0] ...", "Name in the report."),
      text_key("body", &P::body, "the only body", "Name of the body."),
      key<P>({"at", "vector", "m", "required", "Reference position; the nearest vertex is used."},
             [](const SceneNode& node, P& p) { p.at = read_vector(node); }),
  };
}

}  // namespace resilin
