#pragma once

#include <map>
#include <string>
#include <vector>

#include "resilin/sensitivity/barrier_links.hpp"
#include "resilin/sensitivity/contact_links.hpp"
#include "resilin/sensitivity/world_change.hpp"

namespace resilin {

/// How the terms of a world follow from the numbers that it was made of: the linear map from changes of the
/// world to those of its terms, and its transpose.
class TermLinks {
 public:
  /// @param world  made of a description that it still has; kept by reference
  explicit TermLinks(const World& world);

  /// Room for the slopes that `gather` needs of what `asked` has.
  TermChanges zero(const WorldChange& asked) const;
  TermChanges spread(const WorldChange& change) const;
  /// Adds to what `slopes` has.
  void gather(const TermChanges& terms, WorldChange& slopes) const;

  /// The term of inertia, whose "mass" are the entries of the world's mass matrix; -1 at rest.
  int inertia() const { return inertia_; }

 private:
  struct Viscous {
    std::size_t term, body;
  };
  void spread_gravity(const WorldChange& change, VectorX& forces) const;
  void gather_gravity(const VectorX& forces, WorldChange& slopes) const;
  void spread_viscosities(const WorldChange& change, std::size_t body, VectorX& viscosities) const;
  void gather_viscosities(const VectorX& viscosities, std::size_t body, WorldChange& slopes) const;
  CellMasses masses_of(std::size_t body, double density) const;
  bool moves_gravity(const WorldChange& change) const;
  bool moves_viscosity(const WorldChange& change, std::size_t body) const;

  const World& world_;
  const Description& description_;
  int gravity_ = -1, inertia_ = -1, mass_damping_ = -1;  ///< numbers of terms
  std::vector<Viscous> viscous_;
  BarrierLinks barriers_;
  ContactLinks contacts_;
};

}  // namespace resilin
