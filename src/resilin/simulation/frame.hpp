#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resilin/optimize/newton.hpp"
#include "resilin/world/linear_problem.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Entry of the report for one instant.
struct Frame {
  struct ProbeValue {
    std::string name;
    Vector3 displacement = Vector3::Zero();  ///< [m]
    Vector3 velocity = Vector3::Zero();      ///< [m/s]
  };

  /// Strain energy of a domain of a body that has regions.
  struct RegionEnergy {
    std::string body, region;   ///< names; the body's own material is ""
    double elastic_energy = 0;  ///< [J]
  };

  /// Motion of a rigid body.
  struct RigidMotion {
    std::string name;
    Vector3 position = Vector3::Zero();  ///< position of the centre of mass [m]
    std::array<double, 4> rotation = {
        1, 0, 0, 0};                     ///< quaternion (w, x, y, z) from the placed reference configuration
    Vector3 velocity = Vector3::Zero();  ///< velocity of the centre of mass [m/s]
    Vector3 angular_velocity = Vector3::Zero();  ///< [rad/s]
  };

  /// A spring or a cable.
  struct CableForce {
    std::string name;
    double force = 0;                ///< its tension at the first point; negative where a spring pushes [N]
    double length = 0;               ///< [m]
    std::vector<double> tensions{};  ///< tensions of its pieces; empty: there is one [N]
  };

  struct ModeValues {
    int number = 0;        ///< from 1
    double frequency = 0;  ///< [Hz]; zero for a rigid or unstable mode
    bool is_rigid = false;
    bool is_unstable = false;
    double growth_rate = 0;                    ///< growth rate of an unstable mode [1/s]
    Vector3 effective_mass = Vector3::Zero();  ///< mass that a shaken wall moves in it [kg]
  };

  int step = 0;
  std::string step_name;  ///< name of the step in sequence; empty: there are none
  double time = 0;
  std::optional<ModeValues> mode;  ///< mode of a free vibration
  double load = 0;
  int newton_iterations = 0;
  int linear_iterations = 0;
  double residual = 0;         ///< force residual relative to the forces that balance
  double residual_newton = 0;  ///< force residual [N]
  bool converged = true;
  int failed_attempts = 0;  ///< steps that were tried before this one, too long
  double time_step = 0;     ///< motion: length of the step [s]
  double time_error = 0;    ///< motion with adaptive steps: about how far it misplaced a vertex [m]
  double min_volume_ratio = 1;
  std::optional<Index> unstable_modes;  ///< statics: negative eigenvalues of the stiffness, where counted
  double jump_energy = 0;               ///< statics: lost in a jump to another equilibrium; 0: none [J]
  std::optional<Inversion> inversion;   ///< linear statics: where a cell is first turned inside out
  Index worst_cell = -1;                ///< where the volume ratio is least, in its body ...
  int worst_body = 0;                   ///< ... this one
  double elastic_energy = 0, kinetic_energy = 0, external_energy = 0, contact_energy = 0;  ///< [J]
  /// Loss by damping, friction and viscoelasticity since the start; no part of the total [J].
  double dissipated_energy = 0;
  double friction_work = 0;                    ///< part of it that is friction [J]
  Vector3 linear_momentum = Vector3::Zero();   ///< [kg m/s]
  Vector3 angular_momentum = Vector3::Zero();  ///< about the origin [kg m^2/s]
  std::vector<ProbeValue> probes;
  /// Forces that supports, then colliders, exert on the bodies; of a support in statics also while it lets go
  /// [N].
  std::vector<std::pair<std::string, Vector3>> reactions;

  std::vector<Vector3>
      reaction_torques;  ///< reaction torques of the same about the origin, on the moved nodes [N m]

  /// Bodies that touch.
  std::vector<SurfaceContact::BodyContact> contacts;

  std::vector<RegionEnergy> regions;  ///< regions of bodies that have regions

  std::vector<RigidMotion> rigid_bodies;
  std::vector<JointForce> joints;
  std::vector<CableForce> cables;  ///< springs, then cables

  std::vector<SectionForce> sections;  ///< section forces of the cuts that the scene asks for

  double total_energy() const { return elastic_energy + kinetic_energy + external_energy + contact_energy; }
};

/// Measures a state. `step_gradient` is dE/dx of the step that led to it, inertia included (from which
/// reactions follow); null at the start, when it is taken from the loads and the elastic forces alone.
Frame measure_frame(const World& world, const State& state, const VectorX* step_gradient);

}  // namespace resilin
