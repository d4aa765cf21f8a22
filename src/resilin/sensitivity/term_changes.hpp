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
  /// A term of a domain.
  struct OfDomain {
    std::size_t term, body, domain;
  };
  void spread_gravity(const WorldChange& change, VectorX& forces) const;
  void gather_gravity(const VectorX& forces, WorldChange& slopes) const;
  void spread_viscosities(const WorldChange& change, const OfDomain& of, VectorX& viscosities) const;
  void gather_viscosities(const VectorX& viscosities, const OfDomain& of, WorldChange& slopes) const;
  /// Calls `use(body, domain, change of the domain)` for each domain of the world.
  template <class Change, class Use>
  void for_each_domain(Change& change, const Use& use) const {
    for (std::size_t b = 0; b < world_.bodies.size(); ++b)
      for (std::size_t d = 0; d < world_.bodies[b].domains.size(); ++d)
        use(b, world_.bodies[b].domains[d], change.bodies[b].domains[d]);
  }
  CellMasses masses_of(std::size_t body, const Domain& domain, double density) const;
  bool moves_gravity(const WorldChange& change) const;
  bool moves_viscosity(const WorldChange& change, const OfDomain& of) const;

  const World& world_;
  const Description& description_;
  int gravity_ = -1, inertia_ = -1, mass_damping_ = -1;  ///< numbers of terms
  std::vector<OfDomain> elastic_, viscous_;
  std::vector<std::size_t> loads_, cables_;  ///< numbers of their terms
  BarrierLinks barriers_;
  ContactLinks contacts_;
};

}  // namespace resilin
