#pragma once

#include "resilin/core/members.hpp"
#include "resilin/mesh/mesh_members.hpp"
#include "resilin/world/description.hpp"

/// Members of a description. Its image keeps all of it; which of it the steps depend on is said in
/// fingerprint.cpp.
namespace resilin {

/// A constant function has no members.
inline Members<> members(const TimeFunction::Constant&) { return {}; }

RESILIN_MEMBERS(Where, kind, group, min, max, axis, at, tolerance, center, radius, vertices, face_at, normal,
                angle)
RESILIN_MEMBERS(ViscoelasticDescription, place, g, k, tau, moduli, formulation)
RESILIN_MEMBERS(MullinsDescription, place, r, m, beta)
RESILIN_MEMBERS(MaterialDescription, place, law, constants, cell_constants, fibres, density, viscoelastic,
                mullins)
RESILIN_MEMBERS(Rotation, axis, center, degrees)
RESILIN_MEMBERS(DampingDescription, mass, stiffness, shear_viscosity, bulk_viscosity)
RESILIN_MEMBERS(SkinDescription, place, surface, surface_name, is_smooth)
RESILIN_MEMBERS(RigidDescription, place, density, stiffness, region_of)
RESILIN_MEMBERS(RegionDescription, place, name, where, cells, material, rigid)
RESILIN_MEMBERS(BodyDescription, place, name, mesh, mesh_name, element, quadrature, material, regions, scale,
                rotate, translate, velocity, velocity_gradient, initial_positions, initial_velocities,
                contact_shape, mass, damping, contact_surface, skin, rigid)
RESILIN_MEMBERS(TimeFunction::Table, times, values)
RESILIN_MEMBERS(TimeFunction::Sine, frequency, amplitude, phase, offset)
RESILIN_MEMBERS(TimeFunction::Ramp, from, until)
RESILIN_MEMBERS(TimeFunction, form)
RESILIN_MEMBERS(FixDescription, place, name, body, where, components, displacement, gradient, rotate,
                velocity, until, time_function, switches, reports_stiffness)
RESILIN_MEMBERS(LoadDescription, place, name, body, kind, where, value, pressure, point, stiffness,
                displacement, velocity, from, until, time_function)
RESILIN_MEMBERS(ShapeDescription, point, normal, center, radius, size, start, end, mesh, mesh_name, scale,
                translate)
RESILIN_MEMBERS(ColliderTurn, axis, center, degrees, degrees_per_second)
RESILIN_MEMBERS(ColliderDescription, place, name, kind, shape, velocity, until, displacement, time_function,
                rotate, activation_distance, stiffness, friction, friction_factor)
RESILIN_MEMBERS(ContactPairDescription, place, bodies, is_enabled, friction, switches)
RESILIN_MEMBERS(ContactDescription, place, is_enabled, with_themselves, activation_distance, stiffness,
                friction, friction_speed, friction_factor, friction_iterations, pairs)
RESILIN_MEMBERS(TiedSurface, place, body, where)
RESILIN_MEMBERS(TieDescription, place, name, surfaces, closes_gap, max_distance)
RESILIN_MEMBERS(ConstraintTerm, place, body, where, axis, coefficient)
RESILIN_MEMBERS(ConstraintDescription, place, name, kind, body, where, components, terms, value, gradient,
                time_function)
RESILIN_MEMBERS(MotorDescription, position, velocity, effort, stiffness, time_function)
RESILIN_MEMBERS(JointDescription, place, name, kind, bodies, at, axis, second_axis, to, stiffness, rest,
                damping, limits, motor)
RESILIN_MEMBERS(AnchorDescription, place, body, at)
RESILIN_MEMBERS(CableDescription, place, name, points, stiffness, elongations, forces, rest_length,
                tension_only, tension, shortening, friction, time_function)
RESILIN_MEMBERS(ProbeDescription, place, name, body, at)
RESILIN_MEMBERS(SectionDescription, place, name, body, axis, at)
RESILIN_MEMBERS(NewtonOptions, tolerance, max_iterations, max_failures, projection, inversion_bound)
RESILIN_MEMBERS(SolverOptions, kind, max_iterations)
RESILIN_MEMBERS(OutputOptions, every, fields, formats)
RESILIN_MEMBERS(AdaptiveSteps, tolerance, min_step, max_step)
RESILIN_MEMBERS(ModesOptions, count, is_loaded)
RESILIN_MEMBERS(StepDescription, place, name, end)
RESILIN_MEMBERS(Description, place, title, is_dynamic, dimension, thickness, gravity, gravity_function,
                time_step, end_time, integrator, adaptive, modes, load_steps, load_control, max_steps,
                unstable_modes, on_jump, steps, bodies, fixes, ties, constraints, joints, springs, cables,
                loads, colliders, contact, probes, sections, newton, solver, output)

}  // namespace resilin
