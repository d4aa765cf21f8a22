#include "resilin/core/vocabulary.hpp"

#include <algorithm>
#include <array>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// Lists of words have blanks between.
struct Row {
  std::string_view called, words, home = {}, limit = {};
};

// A word may stand in several rows: the first row that has one of the words that are known is meant.
constexpr std::array rows = {
    // keys
    Row{"fix",
        "dirichlet boundary boundary_condition boundary_conditions bc bcs constraint support supports fixed "
        "clamp clamped encastre pin pinned displacement prescribed_displacement dirichlet_boundary"},
    Row{"tie", "ties tied tied_contact glue glued bonded bond mortar"},
    Row{"constraint",
        "constraints linear_constraint multipoint_constraint mpc equation equations periodic periodicity "
        "periodic_boundary coupling rigid_link"},
    Row{"joint", "joints hinge revolute ball_joint spherical connector linkage pivot"},
    Row{"spring", "springs elastic_band rubber_band"},
    Row{"cable", "cables tendon tendons rope string wire"},
    Row{"load",
        "neumann force forces moment moments torque traction pressure body_force dead_load follower_load "
        "surface_load cload dload dsload neumann_boundary pressure_boundary"},
    Row{"collider", "obstacle obstacles floor ground wall plane is_obstacle"},
    Row{"body", "part parts solid solids domain geometry geometries object deformable"},
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
    Row{"material", "materials law model constitutive constitutive_model elastic"},
    Row{"youngs_modulus", "e young youngs young_modulus elastic_modulus modulus stiffness"},
    Row{"poissons_ratio", "nu v poisson poisson_ratio poissons"},
    Row{"density", "rho mass_density"},
    Row{"friction", "mu mu_f friction_coefficient coefficient_of_friction coulomb"},
    Row{"shear_modulus", "mu g lame_mu"},
    Row{"lame_lambda", "lambda lame lame_first"},
    Row{"bulk_modulus", "kappa k bulk"},
    Row{"activation_distance",
        "dhat d_hat barrier_distance contact_distance contact_offset thickness margin"},
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
    Row{"where", "nodes node_set nset elset region surface set nodeset selection surface_selection group at"},
    Row{"group", "nodes elset surface physical node_set nset set physical_group tag id nodeset"},
    Row{"displacement", "value u d disp dirichlet"},
    Row{"value", "force traction pressure moment torque magnitude vector f t"},
    Row{"point", "attack point_of_attack reference_point attack_point application_point at"},
    Row{"face_at", "face point picked_face"},
    Row{"normal", "direction facing"},
    Row{"ball", "sphere"},
    Row{"disc", "disk circle"},
    Row{"spherical_shell", "shell hollow_sphere hollow_ball"},
    Row{"components", "dofs dof directions axes"},
    Row{"time_function", "amplitude curve load_curve lc loadcurve table tabular"},
    Row{"rotate", "rotation angle turn"},
    Row{"translate", "translation position offset pos"},
    Row{"velocity", "initial_velocity v v0 speed"},
    Row{"damping", "rayleigh rayleigh_damping viscosity"},
    Row{"shear_viscosity", "viscosity eta"},
    Row{"skin", "surface embedded_surface visual visual_mesh render_mesh"},
    Row{"viscoelastic", "viscoelastic visco viscoelasticity prony prony_series maxwell relaxation",
        "body.material.viscoelastic"},
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
    Row{"saint_venant_kirchhoff", "stvk svk st_venant_kirchhoff saint_venant", "body.material.law"},
    Row{"disc", "disk circle", "mesh = { disc = ... }"},
    Row{"ring", "annulus", "mesh = { ring = ... }"},
    Row{"tube", "pipe hollow_cylinder", "mesh = { tube = ... }"},
    Row{"spherical_shell", "hollow_sphere", "mesh = { spherical_shell = ... }"},

    // features that are not available
    Row{"", "plasticity plastic elastoplastic yield_stress von_mises_plasticity", "", "no plasticity"},
    Row{"", "damage fracture crack", "", "fracture"},
    Row{"", "creep", "", "creep"},
    Row{"", "thermal temperature heat thermal_expansion", "", "heat"},
    Row{"", "shell shells membrane cloth rod truss", "", "no shells, membranes, rods"},
    Row{"", "orthotropic anisotropic", "", "no orthotropic elasticity"},
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
    for (const Row& row : rows) all.push_back({split(row.words), split(row.called), row.home, row.limit});
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
