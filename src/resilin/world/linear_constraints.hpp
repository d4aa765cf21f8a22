#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "resilin/energy/time_function.hpp"
#include "resilin/integrator/stage.hpp"
#include "resilin/linear/dependents.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The ties and linear constraints of a world: which unknowns follow from which others, and by what they
/// differ from them.
struct LinearConstraints {
  /// Part of the constant of a relation, times the factor of a function of time.
  struct Constant {
    int function;  ///< its number; -1: always
    double value;  ///< [m]
  };
  /// As the scene states it: what it follows may follow others.
  struct Stated {
    std::size_t owner;  ///< number of its name
    Dependents::Relation relation;
  };

  /// Part of the force on a dependent unknown in that of a face of a periodic cell.
  struct OnFace {
    std::size_t owner;
    Index unknown;
    double share;  ///< its distance from what it follows, in lengths of the cell
  };

  Dependents dependents;
  std::vector<std::vector<Constant>> constants;  ///< by relation of `dependents`
  std::vector<TimeFunction> functions;
  std::vector<std::string> names;  ///< names of ties and constraints, for the report
  std::vector<Stated> stated;      ///< no relation comes before one that follows it
  std::vector<OnFace> on_faces;    ///< in place of the forces on what follows, for the names that are here

  std::vector<std::array<std::size_t, 2>> tied_bodies;
  std::ptrdiff_t joints = -1;  ///< number of the name that all joints have; -1: there is none

  bool ties(std::size_t body, std::size_t other) const;
  /// The forces and torques that they exert on what follows, by name.
  /// @param gradient  of the whole potential, as `Potential::gradient` gives it [N]
  std::vector<Reaction> reactions(int dim, const VectorX& gradient, const VectorX& positions) const;
  /// dE/dx of what joints exert on all that they couple [N]: zero in sum where bodies hold each other.
  VectorX forces_of_joints(const VectorX& gradient) const;
  /// Likewise of all.
  VectorX forces(const VectorX& gradient) const;
};

/// Writes the constants of the dependent unknowns of a world, if there are any, into `targets`.
void set_constants(const World& world, const Conditions& conditions, VectorX& targets);

/// Likewise of a world in motion at a time [s], with their first and second rates.
void set_constants(const World& world, double time, Motion& constants);

/// Collects relations between displacements, one after another.
class RelationSystem {
 public:
  using Constant = LinearConstraints::Constant;

  /// @param support_of      as World has it
  /// @param names_of_supports  for messages; may be empty
  RelationSystem(int dim, const VectorX& rest_positions, const std::vector<std::int32_t>& support_of,
                 std::vector<std::string> names_of_supports = {});

  std::size_t add_name(std::string name);
  /// The name is that of the upper face of a periodic cell along an axis. All names of one cell come one
  /// after another, from `first_of_cell` on.
  void add_face(std::size_t owner, int axis, double length, std::size_t first_of_cell);
  int add_function(const TimeFunction& function);
  /// Prescribed, or following by an earlier relation.
  bool is_taken(Index unknown) const;
  /// u = sum of `by` + constants. Throws InputError beginning with `place` where these follow u.
  /// @param unknown  which is not taken
  void follow(std::size_t owner, Index unknown, std::vector<Dependents::Weight> by,
              std::vector<Constant> constants, const std::string& place);
  /// sum of `terms` = constants: the free unknown with the largest coefficient follows. Throws InputError
  /// beginning with `place` when none is left that could.
  void add_equation(std::size_t owner, std::vector<Dependents::Weight> terms, std::vector<Constant> constants,
                    const std::string& place);

  /// Null without any relations.
  std::shared_ptr<LinearConstraints> build() const;

 private:
  struct Entry {
    std::size_t owner;
    Dependents::Relation relation;
    std::vector<Constant> constants;
  };
  /// Puts in place of what follows what it follows.
  void substitute(std::vector<Dependents::Weight>& by, std::vector<Constant>& constants) const;
  /// Words for what determines these unknowns: "[[fix]] \"wall\" and \"link\"".
  std::string what_determines(const std::vector<Dependents::Weight>& terms) const;

  struct Face {
    std::size_t owner;
    int axis;
    double length;
    std::size_t first_of_cell;
  };

  int dim_;
  const VectorX& rest_positions_;
  const std::vector<std::int32_t>& support_of_;
  std::vector<Index> entry_of_;  ///< by unknown; -1: none
  std::vector<Entry> entries_;
  std::vector<std::string> names_, names_of_supports_;
  std::vector<Face> faces_;
  std::vector<TimeFunction> functions_;
};

}  // namespace resilin
