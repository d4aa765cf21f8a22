#pragma once

#include <map>
#include <string>
#include <vector>

#include "resilin/sensitivity/world_change.hpp"

namespace resilin {

/// Changes of the terms of a world, each under the names of its own parameters; or derivatives by
/// these. Terms that do not change have none.
using TermChanges = std::vector<std::map<std::string, VectorX, std::less<>>>;

/// How the terms of contact and of friction follow the numbers of colliders and of [contact]: coefficients of
/// friction, places and motions of colliders. What friction has of the stiffness of barriers follows them.
class ContactLinks {
 public:
  /// @param world  made of a description that it still has
  explicit ContactLinks(const World& world);

  /// Room for what `asked` needs; that of the barriers' stiffness has been made.
  void add_zero(const WorldChange& asked, TermChanges& terms) const;
  /// The stiffness of barriers has been spread.
  void spread(const WorldChange& change, TermChanges& terms) const;
  void gather(const TermChanges& terms, WorldChange& slopes) const;
  /// By the stiffness of the barrier of this term, by what friction does with it among them.
  VectorX stiffness_slopes(std::size_t term, const TermChanges& terms) const;

 private:
  /// Friction sources, and where their numbers begin among those of friction.
  struct Source {
    std::size_t term;
    Eigen::Index coefficient, num_coefficients, stiffness, num_stiffnesses;
    std::vector<int> pairs{};  ///< between bodies, of each coefficient: the number of its pair; -1: none
  };
  const Source* source_of(std::size_t term) const;
  bool moves_motion(const WorldChange& change) const;
  /// Calls `visit(collider of the change, its term)`.
  template <class Change, class Visit>
  void for_each_collider(Change& change, const Visit& visit) const;
  /// Calls `visit(coefficient, number of the world)` for those that are asked about.
  template <class Change, class Visit>
  void for_each_coefficient(Change& change, const Visit& visit) const;

  std::vector<std::size_t> collider_terms_;  ///< in the order of the scene
  int friction_ = -1;                        ///< the number of its term
  std::vector<Source> sources_;
};

}  // namespace resilin
