#pragma once

#include <string>
#include <vector>

#include "resilin/material/law.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The material of one body as it can be changed while a scene runs.
struct BodyControls {
  std::string law;
  double youngs_modulus = 1e5;  ///< [Pa] of the small-strain solid
  double poissons_ratio = 0.4;
  bool operator==(const BodyControls&) const = default;
};

/// Values that can be changed while a scene runs. The material is that of the first deformable body; changed
/// here, it changes in all of them.
struct LiveControls {
  std::string law;
  double youngs_modulus = 1e5;  ///< [Pa] of the small-strain solid
  double poissons_ratio = 0.4;
  double damping = 0;                 ///< damping of all motion, in proportion to mass [1/s]
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  double time_step = 1.0 / 60;        ///< [s]
  double max_force = 0;               ///< maximum force of the hand [N]
  bool has_ground = false;            ///< a floor
  double ground_height = 0;           ///< ground height of the floor, against gravity [m]
  double ground_friction = 0;         ///< Coulomb's coefficient of bodies on it
  double contact_friction = 0;        ///< Coulomb's coefficient of bodies on each other
  double contact_stiffness = 1e5;     ///< contact stiffness of the layer between bodies [Pa]
  double contact_distance = 1e-3;     ///< activation distance between bodies [m]
  int newton_limit = 0;               ///< Newton iterations of a step; 0: as many as its time allows
  double tolerance = 1e-4;            ///< force residual relative to the load at which a step is solved
  double speed = 1;                   ///< simulated over real time, for whoever calls the steps
};

/// The controls that a scene begins with: its first body's material, its gravity and time step, and a hand
/// that can stretch a body of its size and stiffness visibly. The ground is off, under the lowest node along
/// `up`. Contact is that of the world, where its bodies meet.
LiveControls starting_controls(const Description& description, const World& world, const Vector3& up);

/// The material that a body begins with; the mean over its cells where it varies. A rigid body has the
/// stiffness by which contact measures it, and keeps it.
BodyControls starting_material(const BodyDescription& description, const Body& body);

/// The controls with the material of another body.
LiveControls with_material(LiveControls controls, const BodyControls& material);

/// Whether a collider is a floor, which becomes the ground of the controls: level, facing up and at rest.
bool is_floor(const ColliderDescription& collider, const Vector3& up);

/// Throws InputError for the first value that cannot be.
void check_controls(const LiveControls& controls);

/// The material of `description` with this law and this stiffness; as long as the law is its
/// own it keeps its fibres and free constants (ConstantText::is_free).
MaterialDescription material_of(const BodyControls& controls, const MaterialDescription& description);

/// Laws that a scene can change to: those that Young's modulus and Poisson's ratio alone make.
std::vector<const LawInfo*> live_laws();

/// The first deformable body, whose material the controls begin with; the first one where all are rigid.
std::size_t first_deformable(const World& world);

/// Stiffness of a spring that holds a point of a body as if it were fixed [N/m].
double anchor_stiffness(const Body& body, const LiveControls& controls, const World& world);

/// How stiff the hand's spring is, so that a place of a body follows it closely [N/m].
/// @param body  which it holds
double hand_stiffness(const LiveControls& controls, const World& world, const Body& body);

}  // namespace resilin
