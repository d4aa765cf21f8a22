#pragma once

#include <string>
#include <vector>

#include "resilin/sensitivity/world_change.hpp"

namespace resilin {

/// How barriers whose stiffness the scene leaves out follow the constants of the bodies' materials: it is in
/// proportion to Young's modulus at small strain of the means of these, in the softest domain
/// (world/meeting_surface.hpp). A rigid body's follows the stiffest domain of all deformable bodies.
class BarrierLinks {
 public:
  /// A domain whose Young's modulus sets the barrier stiffness of a body.
  struct FollowedDomain {
    std::size_t body, domain;
  };

  /// A collider's barrier, or what keeps bodies apart.
  struct Barrier {
    std::size_t term;           ///< its number
    std::vector<Index> bodies;  ///< bodies of each number of the parameter "barrier_stiffness"; -1: of none
    VectorX stiffness;          ///< these numbers
  };

  /// @param world  made of a description that it still has; kept by reference
  explicit BarrierLinks(const World& world);

  /// Those that follow a material.
  const std::vector<Barrier>& all() const { return barriers_; }
  bool moves(const Barrier& barrier, const WorldChange& change) const;
  void spread(const Barrier& barrier, const WorldChange& change, VectorX& stiffness) const;
  void gather(const Barrier& barrier, const VectorX& stiffness, WorldChange& slopes) const;

 private:
  const World& world_;
  std::vector<Barrier> barriers_;
  std::vector<FollowedDomain> followed_;  ///< by each body
  std::vector<VectorX>
      modulus_slopes_;  ///< modulus slopes of this domain: d(log E)/d(means of its constants)
};

/// One line on the first two bodies that are equally stiff, if `change` is one of a material of theirs: the
/// layer between them is as stiff as the softer one, which has a kink there. Empty where there are none.
std::string kink_of_barrier(const World& world, const WorldChange& change);

}  // namespace resilin
