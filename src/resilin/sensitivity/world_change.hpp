#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// A change of the numbers that a world was made of, to first order; or slopes of a result by them. What is
/// empty does not change, or is not asked for.
struct WorldChange {
  struct OfDomain {
    VectorX constants{};  ///< as the parameter of ElasticEnergy
    bool has_density = false;
    double density = 0;
  };
  struct OfBody {
    std::vector<OfDomain> domains{};
    bool has_damping = false;  ///< any of these:
    double mass_damping = 0, stiffness_damping = 0, shear_viscosity = 0, bulk_viscosity = 0;

    bool has_density() const { return std::ranges::any_of(domains, &OfDomain::has_density); }
  };
  struct OfSupport {
    bool is_asked = false;
    Vector3 displacement = Vector3::Zero(), velocity = Vector3::Zero();
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  };

  struct OfCollider {
    bool has_friction = false;
    double friction = 0;
    bool has_motion = false;  ///< any of these:
    Vector3 place = Vector3::Zero(), velocity = Vector3::Zero(), displacement = Vector3::Zero();
  };
  /// Changes of bodies on each other.
  struct OfContact {
    bool has_friction = false;
    double friction = 0;        ///< friction of all contact without a pair of its own
    std::vector<double> pairs;  ///< friction of each pair of the description
  };

  explicit WorldChange(const World& world)
      : bodies(world.bodies.size()),
        loads(world.made_from->loads.size()),
        supports(world.supports.size()),
        colliders(world.made_from->colliders.size()),
        contact{.pairs = std::vector<double>(world.made_from->contact.pairs.size())} {
    for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].domains.resize(world.bodies[b].domains.size());
  }

  bool has_gravity = false;
  Vector3 gravity = Vector3::Zero();
  std::vector<OfBody> bodies;
  std::vector<std::map<std::string, VectorX>> loads;  ///< by the names of the term's parameters
  /// Numbers of joints, springs and cables: by the number of the term and its parameter
  std::map<std::size_t, std::map<std::string, VectorX>> couplings;
  std::vector<OfSupport> supports;
  std::vector<OfCollider> colliders;
  OfContact contact;
  VectorX rest_positions{};  ///< rest positions of all nodes, as the following [m]
  VectorX start_positions{};
  VectorX start_velocities{};  ///< [m/s]

  bool has_mass() const;
};

}  // namespace resilin
