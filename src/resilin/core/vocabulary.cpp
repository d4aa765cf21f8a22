#include "resilin/core/vocabulary.hpp"

#include <algorithm>
#include <array>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// Lists of words have blanks between.
struct Row {
  std::string_view called, words, home = {}, limit = {}, advice = {};
};

// A word may stand in several rows: the first row that has one of the words that are known is meant.
constexpr std::array rows = {
    // keys
    Row{"fix",
        "dirichlet boundary boundary_condition boundary_conditions bc bcs constraint support supports fixed "
        "clamp clamped encastre symmetry pin pinned displacement prescribed_displacement dirichlet_boundary"},
    Row{"tie", "ties tied tied_contact glue glued bonded bond mortar"},
    Row{"constraint",
        "constraints linear_constraint multipoint_constraint mpc equation equations periodic periodicity "
        "periodic_boundary coupling rigid_link rve homogenisation homogenization"},
    Row{"joint",
        "joints hinge revolute ball_joint spherical prismatic cardan slider universal connector linkage "
        "pivot"},
    Row{"spring", "springs elastic_band rubber_band"},
    Row{"cable", "cables tendon tendons rope string wire"},
    Row{"load",
        "neumann force forces moment moments torque traction pressure body_force dead_load follower_load "
        "surface_load cload dload dsload neumann_boundary pressure_boundary"},
    Row{"collider", "obstacle obstacles floor ground wall plane is_obstacle"},
    Row{"body",
        "part parts solid solids domain geometry geometries object deformable instance instances assembly"},
    Row{"probe", "monitor sensor history node_history point_output tracker"},
    Row{"step", "stage stages load_case load_cases loadcase analysis_step"},
    Row{"section", "cut section_force integrated_output"},
    Row{"simulation", "analysis step procedure control time settings"},
    Row{"kind", "analysis procedure type"},
    Row{"newton", "nonlinear nonlinear_solver convergence"},
    Row{"solver", "linear_solver linear direct iterative preconditioner"},
    Row{"contact",
        "contact_pair contact_pairs general_contact self_contact interaction collision collisions ipc"},
    Row{"law",
        "model constitutive constitutive_model constitutive_law material_model hyperelastic type name "
        "energy"},
    Row{"material", "materials model constitutive constitutive_model elastic"},
    Row{"youngs_modulus", "e young youngs young_modulus elastic_modulus modulus stiffness"},
    Row{"poissons_ratio", "nu v poisson poisson_ratio poissons"},
    Row{"density", "rho mass_density"},
    Row{"friction", "mu mu_f friction_coefficient coefficient_of_friction coulomb"},
    Row{"shear_modulus", "mu g lame_mu shear"},
    Row{"lame_lambda", "lambda lame lame_first"},
    Row{"bulk_modulus", "kappa k bulk"},
    Row{"activation_distance",
        "dhat d_hat barrier_distance contact_distance contact_offset thickness margin"},
    Row{"pair", "pairs master slave contact_pair contact_pairs"},
    Row{"stiffness", "kappa barrier_stiffness contact_stiffness penalty penalty_stiffness k beta"},
    Row{"friction_speed", "eps_v epsv epsilon_v static_friction_speed_bound slip_tolerance"},
    Row{"friction_iterations", "lagging_iterations friction_lagging lagged_iterations"},
    Row{"self", "self_contact self_collision selfcollide"},
    Row{"mass", "alpha rayleigh_alpha lumping"},
    Row{"time_step", "dt h step timestep step_size delta_t increment"},
    Row{"end_time", "t_end tend duration total_time final_time period stop_time"},
    Row{"load_steps", "increments num_increments load_increments steps time_steps substeps nincs"},
    Row{"load_control", "riks arclength arc_length path_following"},
    Row{"integrator", "scheme time_integration time_integrator method"},
    Row{"adaptive", "automatic auto_step time_stepper automatic_increments"},
    Row{"modes", "modal eigen eigenvalues eigenfrequencies frequency natural_frequencies"},
    Row{"count", "num_modes n number"},
    Row{"element", "elements shape_functions discr_order order degree elem_type element_type"},
    Row{"quadrature", "integration quadrature_order quadrature_rule"},
    Row{"where",
        "nodes node_set nset elset region surface set nodeset selection surface_selection group at face "
        "faces"},
    Row{"group", "nodes elset surface physical node_set nset set physical_group tag id nodeset"},
    Row{"displacement", "value u d disp dirichlet u1 u2 u3 ux uy uz"},
    Row{"value", "force traction pressure moment torque magnitude vector f t"},
    Row{"point", "attack point_of_attack reference_point attack_point application_point at"},
    Row{"face_at", "face point picked_face"},
    Row{"normal", "direction facing"},
    Row{"ball", "sphere"},
    Row{"disc", "disk circle"},
    Row{"spherical_shell", "shell hollow_sphere hollow_ball"},
    Row{"components", "dofs dof directions axes symmetry roller"},
    Row{"time_function", "amplitude curve load_curve lc loadcurve table tabular time ramp smooth_step"},
    Row{"rotate", "rotation angle turn orientation"},
    Row{"translate", "translation position offset pos"},
    Row{"velocity", "initial_velocity v v0 speed"},
    Row{"damping", "rayleigh rayleigh_damping viscosity"},
    Row{"shear_viscosity", "viscosity eta"},
    Row{"skin", "surface embedded_surface visual visual_mesh render_mesh"},
    Row{"viscoelastic", "viscoelastic visco viscoelasticity prony prony_series maxwell relaxation",
        "body.material.viscoelastic"},
    Row{"mullins", "mullins mullins_effect ogden_roxburgh softening", "body.material.mullins"},
    Row{"g", "g_i gi g_i_prony coefficients shares ratios"},
    Row{"tau", "tau_i taui t times relaxation_time relaxation_times"},
    Row{"fibres", "fibers fibre fiber fibre_directions fiber_directions"},
    Row{"tolerance", "tol rtol rel_tol grad_norm residual_tolerance"},
    Row{"max_iterations", "max_iter maxiter iterations max_refs newton_max_iter"},
    Row{"every", "interval stride skip_frame plot_stride output_interval"},
    Row{"fields", "variables field_output quantities"},
    Row{"formats", "format writer"},
    Row{"gravity", "g rhs acceleration body_acceleration"},
    Row{"output", "results plotfile field_output writer"},
    Row{"dimension", "dim ndim spatial_dimension"},

    // words of another table
    Row{"rigid", "rigid rigid_body rigid_bodies",
        "[[collider]] (prescribed motion) or body.rigid (free motion)"},
    Row{"fix", "displacement prescribed_displacement dirichlet", "[[fix]]"},
    Row{"material", "model constitutive constitutive_model constitutive_law material_model", "body.material"},
    Row{"friction", "friction friction_coefficient coefficient_of_friction", "contact.friction"},
    Row{"self", "self_contact self_collision", "contact.self"},
    Row{"density", "density rho mass_density", "body.material.density"},
    Row{"law", "law hyperelastic", "body.material.law"},
    Row{"youngs_modulus", "youngs_modulus e young youngs young_modulus elastic_modulus",
        "body.material.youngs_modulus"},
    Row{"poissons_ratio", "poissons_ratio nu poisson poisson_ratio poissons", "body.material.poissons_ratio"},
    Row{"shear_modulus", "shear_modulus mu shear lame_mu", "body.material.shear_modulus"},
    Row{"lame_lambda", "lame_lambda lambda lame", "body.material.lame_lambda"},
    Row{"fibres", "fibres fibers fibre fiber", "body.material.fibres"},
    Row{"material", "material materials", "body.material"},
    Row{"mesh", "mesh meshes", "body.mesh"},
    Row{"element", "element elements discr_order elem_type element_type", "body.element"},
    Row{"skin", "skin embedded_surface visual_mesh", "body.skin"},
    Row{"damping", "damping rayleigh rayleigh_damping viscosity", "body.damping"},
    Row{"velocity", "initial_velocity initial_conditions predefined_field", "body.velocity"},
    Row{"group", "group groups elset nset node_set surface_set set sets physical_group",
        "where.group (of [[fix]], [[load]] ...)"},
    Row{"where", "where nodes vertices", "fix.where, load.where"},
    Row{"time_function", "amplitude time_function load_curve", "fix.time_function, load.time_function"},
    Row{"fix", "fix boundary boundary_condition clamp support", "[[fix]]"},
    Row{"gravity", "gravity acceleration", "simulation.gravity"},
    Row{"dimension", "dimension dim plane_strain", "simulation.dimension"},
    Row{"time_step", "time_step dt timestep", "simulation.time_step"},
    Row{"end_time", "end_time t_end tend total_time", "simulation.end_time"},
    Row{"load_steps", "load_steps increments load_increments", "simulation.load_steps"},
    Row{"integrator", "integrator scheme time_integration", "simulation.integrator"},
    Row{"tolerance", "tolerance tol rtol", "newton.tolerance"},
    Row{"max_iterations", "max_iterations max_iter maxiter", "newton.max_iterations"},
    Row{"solver", "solver linear_solver", "solver.kind"},
    Row{"every", "every fps output_interval", "output.every"},
    Row{"output", "output results", "[output]"},

    // values
    Row{"force nodal_force", "force point_load point_force concentrated_force remote_force total_force cload",
        "[[load]] of kind \"force\""},
    Row{"moment", "moment torque couple remote_moment", "[[load]] of kind \"moment\""},
    Row{"traction", "surface_traction dead_load surface_load", "[[load]] of kind \"traction\""},
    Row{"pressure", "follower_load follower_pressure", "[[load]] of kind \"pressure\""},
    Row{"body_force", "volume_force volumetric_load", "[[load]] of kind \"body_force\""},
    Row{"half_space", "plane ground_plane halfspace wall", "[[collider]] of kind \"half_space\""},
    Row{"backward_euler", "implicit_euler euler", "simulation.integrator"},
    Row{"static", "quasistatic quasi_static steady equilibrium", "simulation.kind = \"static\""},
    Row{"dynamic", "transient implicit_dynamic", "simulation.kind = \"dynamic\""},
    Row{"modes", "modal eigenmodes vibration frequency eigenfrequencies natural_frequencies",
        "simulation.kind = \"modes\""},
    Row{"plane_stress", "cps cps3 cps4 cps6 plane_stress", "simulation.dimension = \"plane_stress\""},
    Row{"axisymmetric", "axisymmetry axi cax cax3 cax4 cax6 cax8 axisymmetric",
        "simulation.dimension = \"axisymmetric\""},
    Row{"linear_elastic", "hookean hooke isotropic_linear_elastic", "body.material.law"},
    Row{"neo_hookean", "neohookean neo_hooke nh", "body.material.law"},
    Row{"mooney_rivlin", "mooney", "body.material.law"},
    Row{"holzapfel_gasser_ogden", "hgo holzapfel", "body.material.law"},
    Row{"transversely_isotropic", "trans_iso transversely_isotropic_elastic transverse_isotropy",
        "body.material.law"},
    Row{"orthotropic", "anisotropic orthotropic_elastic", "body.material.law"},
    Row{"fung_orthotropic", "fung", "body.material.law"},
    Row{"veronda_westmann", "veronda", "body.material.law"},
    Row{"holmes_mow", "holmesmow", "body.material.law"},
    Row{"hencky", "logarithmic_strain_law", "body.material.law"},
    Row{"exponential_fibre", "fiber_exp_pow exponential_fiber", "body.material.law"},
    Row{"toe_linear_fibre", "fiber_exp_linear trans_iso_mooney_rivlin ligament", "body.material.law"},
    Row{"sum", "mixture solid_mixture uncoupled_solid_mixture", "body.material.sum"},
    Row{"saint_venant_kirchhoff", "stvk svk st_venant_kirchhoff saint_venant", "body.material.law"},
    Row{"disc", "disk circle", "mesh = { disc = ... }"},
    Row{"ring", "annulus", "mesh = { ring = ... }"},
    Row{"tube", "pipe hollow_cylinder", "mesh = { tube = ... }"},
    Row{"spherical_shell", "hollow_sphere", "mesh = { spherical_shell = ... }"},

    // words that no key stands for
    Row{"", "restart resume checkpoint continue", "", "", "run it with the option --resume"},
    Row{"", "threads num_threads cpus n_threads", "", "", "give the option --threads"},
    Row{"", "nlgeom nonlinear nonlinear_geometry large_deformation finite_strain", "", "",
        "large deformation is always on"},
    Row{"", "ccd collision_detection continuous_collision_detection", "", "",
        "continuous collision detection is always on"},
    Row{"", "encastre clamped fixed_all all_components", "", "",
        "a [[fix]] without components holds all of them"},
    Row{"", "units unit unit_system", "", "", "units are SI; any consistent set works"},
    Row{"", "bulk_modulus kappa k bulk", "", "",
        "without a bulk_modulus in the law, poissons_ratio says how compressible it is (docs/laws.md)"},
    Row{"", "c10 c01 c20 c30 c1 c2", "", "",
        "such constants are those of mooney_rivlin and yeoh; C10 of a neo_hookean is shear_modulus / 2"},
    Row{"", "d1 d2 d3", "", "", "Abaqus's D1 is 2 / bulk_modulus; neo_hookean_isochoric has a bulk_modulus"},
    Row{"", "incompressible nearly_incompressible", "", "",
        "poissons_ratio = 0.499 is nearly incompressible; a mixed element is chosen by itself"},

    // features that are not available
    Row{"", "plasticity plastic elastoplastic yield_stress von_mises_plasticity", "", "no plasticity"},
    Row{"", "damage fracture crack", "", "fracture"},
    Row{"", "creep", "", "creep"},
    Row{"", "thermal temperature heat thermal_expansion expansion", "", "heat"},
    Row{"", "shell shells membrane cloth rod truss", "", "no shells, membranes, rods"},
    Row{"", "gpu cuda opencl device", "", "no gpu"},
    Row{"", "explicit central_difference", "", "no explicit integrator"},
    Row{"", "adhesion cohesive", "", "no adhesion"},
    Row{"", "p3 cubic", "", "no degree 3"},
};

/// Small letters, "_" for blanks and hyphens.
std::string normalized(std::string_view word) {
  std::string result(word);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == ' ' || c == '-') c = '_';
  }
  return result;
}

std::vector<std::string_view> split(std::string_view list) {
  std::vector<std::string_view> words;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(' '), list.size());
    if (end > 0) words.push_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return words;
}

bool has(const ForeignWord& foreign, const std::string& word) {
  return std::ranges::find(foreign.words, word) != foreign.words.end();
}

}  // namespace

std::span<const ForeignWord> vocabulary() {
  static const std::vector<ForeignWord> words = [] {
    std::vector<ForeignWord> all;
    for (const Row& row : rows)
      all.push_back({split(row.words), split(row.called), row.home, row.limit, row.advice});
    return all;
  }();
  return words;
}

std::string foreign_word_cure(std::string_view word, std::span<const std::string> known) {
  const std::string meant = normalized(word);
  for (const ForeignWord& foreign : vocabulary())
    if (has(foreign, meant))
      for (const std::string_view own : foreign.called)
        if (own != word && std::ranges::find(known, own) != known.end())
          return "it is called \"" + std::string(own) + "\" here";
  for (const ForeignWord& foreign : vocabulary()) {
    if (!has(foreign, meant)) continue;
    if (!foreign.limit.empty()) return "not available (docs/limits.md)";
    if (!foreign.advice.empty()) return std::string(foreign.advice);
    if (foreign.home.empty()) continue;
    const bool is_sentence = foreign.home.find('"') != foreign.home.npos;
    return (is_sentence ? "it is " : "it is called ") + std::string(foreign.home) + " here";
  }
  return {};
}

void refuse_own_word(const std::string& place, std::string_view word, std::span<const std::string> known) {
  throw InputError(place, "one of " + join(known), '"' + std::string(word) + '"', cure_of_word(word, known));
}

std::string cure_of_word(std::string_view word, std::span<const std::string> known) {
  const std::string cure = foreign_word_cure(word, known);
  return cure.empty() ? did_you_mean(word, known) : cure;
}

}  // namespace resilin
