#include "resilin/scene/synonyms.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace resilin {
namespace {

struct Synonym {
  std::string_view key;
  std::string_view words;  ///< in lower case, with a blank around each
};

// A word may stand in several rows: the first key that the table at hand knows is meant.
constexpr std::array synonyms = {
    Synonym{
        "fix",
        " dirichlet boundary boundary_condition boundary_conditions bc bcs constraint support supports fixed "
        "clamp clamped encastre pin pinned displacement prescribed_displacement dirichlet_boundary "},
    Synonym{
        "load",
        " neumann force forces traction pressure body_force dead_load follower_load surface_load cload dload "
        "dsload neumann_boundary pressure_boundary "},
    Synonym{"collider",
            " obstacle obstacles rigid rigid_body rigid_bodies floor ground wall plane is_obstacle "},
    Synonym{"body", " part parts solid solids domain geometry geometries object deformable "},
    Synonym{"probe", " monitor sensor history node_history point_output tracker "},
    Synonym{"section", " cut section_force integrated_output "},
    Synonym{"simulation", " analysis step procedure control time settings "},
    Synonym{"kind", " analysis procedure type "},
    Synonym{"newton", " nonlinear nonlinear_solver convergence "},
    Synonym{"solver", " linear_solver linear direct iterative preconditioner "},
    Synonym{"contact", " contact_pair contact_pairs interaction collision collisions ipc "},
    Synonym{"law",
            " model constitutive constitutive_model constitutive_law material_model hyperelastic type name "
            "energy "},
    Synonym{"material", " materials law model constitutive constitutive_model elastic "},
    Synonym{"youngs_modulus", " e young youngs young_modulus elastic_modulus modulus stiffness "},
    Synonym{"poissons_ratio", " nu v poisson poisson_ratio poissons "},
    Synonym{"density", " rho mass_density "},
    Synonym{"friction", " mu mu_f friction_coefficient coefficient_of_friction coulomb "},
    Synonym{"shear_modulus", " mu g lame_mu "},
    Synonym{"lame_lambda", " lambda lame lame_first "},
    Synonym{"bulk_modulus", " kappa k bulk "},
    Synonym{"activation_distance",
            " dhat d_hat barrier_distance contact_distance contact_offset thickness margin "},
    Synonym{"stiffness", " kappa barrier_stiffness contact_stiffness penalty penalty_stiffness k beta "},
    Synonym{"friction_speed", " eps_v epsv epsilon_v static_friction_speed_bound slip_tolerance "},
    Synonym{"friction_iterations", " lagging_iterations friction_lagging lagged_iterations "},
    Synonym{"self", " self_contact self_collision selfcollide "},
    Synonym{"mass", " alpha rayleigh_alpha lumping "},
    Synonym{"time_step", " dt h step timestep step_size delta_t increment "},
    Synonym{"end_time", " t_end tend duration total_time final_time period stop_time "},
    Synonym{"load_steps", " increments num_increments load_increments steps time_steps substeps nincs "},
    Synonym{"load_control", " riks arclength arc_length path_following "},
    Synonym{"integrator", " scheme time_integration time_integrator method "},
    Synonym{"adaptive", " automatic auto_step time_stepper automatic_increments "},
    Synonym{"modes", " modal eigen eigenvalues eigenfrequencies frequency natural_frequencies "},
    Synonym{"count", " num_modes n number "},
    Synonym{"element", " elements shape_functions discr_order order degree elem_type element_type "},
    Synonym{"quadrature", " integration quadrature_order quadrature_rule "},
    Synonym{"where",
            " nodes node_set nset elset region surface set nodeset selection surface_selection group at "},
    Synonym{"group", " node_set nset set physical_group tag id nodeset "},
    Synonym{"displacement", " value u d disp dirichlet "},
    Synonym{"value", " force traction pressure magnitude vector f t "},
    Synonym{"components", " dofs dof directions axes "},
    Synonym{"time_function", " amplitude curve load_curve lc loadcurve table tabular "},
    Synonym{"rotate", " rotation angle turn "},
    Synonym{"translate", " translation position offset pos "},
    Synonym{"velocity", " initial_velocity v v0 speed "},
    Synonym{"damping", " rayleigh rayleigh_damping viscosity "},
    Synonym{"shear_viscosity", " viscosity eta "},
    Synonym{"skin", " surface embedded_surface visual visual_mesh render_mesh "},
    Synonym{"viscoelastic", " visco viscoelasticity prony prony_series maxwell relaxation "},
    Synonym{"g", " g_i gi g_i_prony coefficients shares ratios "},
    Synonym{"tau", " tau_i taui t times relaxation_time relaxation_times "},
    Synonym{"fibres", " fibers fibre fiber fibre_directions fiber_directions "},
    Synonym{"tolerance", " tol rtol rel_tol grad_norm residual_tolerance "},
    Synonym{"max_iterations", " max_iter maxiter iterations max_refs newton_max_iter "},
    Synonym{"every", " interval stride skip_frame plot_stride output_interval "},
    Synonym{"fields", " variables field_output quantities "},
    Synonym{"formats", " format writer "},
    Synonym{"gravity", " g rhs acceleration body_acceleration "},
    Synonym{"output", " results plotfile field_output writer "},
    Synonym{"dimension", " dim ndim spatial_dimension "},
};

}  // namespace

std::string key_for_synonym(std::string_view word, std::span<const std::string> known) {
  std::string sought(1, ' ');
  for (const char letter : word)
    sought += letter == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  sought += ' ';
  if (std::ranges::count(sought, ' ') != 2 || sought.size() < 3) return {};
  for (const Synonym& synonym : synonyms) {
    if (synonym.words.find(sought) == std::string_view::npos) continue;
    if (std::ranges::find(known, synonym.key) != known.end()) return std::string(synonym.key);
  }
  return {};
}

}  // namespace resilin
