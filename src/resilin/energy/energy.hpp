#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/projection.hpp"
#include "resilin/core/types.hpp"
#include "resilin/integrator/stage.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Conditions that loads and moving targets depend on, besides the positions.
struct Conditions {
  double time = 0;    ///< [s]; in a static run the load factor times the scene's end time
  double load = 1;    ///< load factor of a static run; 1 in dynamics
  double delay = 0;   ///< how far motions that bodies may block are behind `time` [s]
  double weight = 1;  ///< factor of the energies of terms that act as impulses (`acts_as_impulse`)
};

/// Category of a term in reports.
enum class EnergyCategory { elastic, external, contact, friction, damping, inertia };

/// Forces of contact and of friction act as impulses at the ends of stages.
inline bool acts_as_impulse(EnergyCategory category) {
  return category == EnergyCategory::contact || category == EnergyCategory::friction;
}

/// Properties of a term that need no evaluation.
struct EnergyProperties {
  EnergyCategory category = EnergyCategory::external;
  bool is_quadratic = false;  ///< in x, with one Hessian for all x and all conditions
  bool has_potential = true;  ///< false: its force may depend on the path; its Hessian is then symmetrised
};

/// Resultant of a term on the bodies, for terms that report it under their name.
struct Reaction {
  Vector3 force = Vector3::Zero();   ///< [N]
  Vector3 torque = Vector3::Zero();  ///< about the origin [N m]
};

/// Weight of a node in the position of a point, or in the distance of two points.
struct WeightedNode {
  Index node;
  double weight;
};

/// A direction in which a point of a body, or the relative position of points of two bodies, is constrained
/// at the start of a static run: the weighted sum of nodal displacements along it stays zero.
struct HeldDirection {
  std::vector<WeightedNode> nodes;
  Vector3 direction;  ///< direction of length 1
};

/// Numbers that a term was made with, or that a stage gave it, and by which its force may be differentiated:
/// one, one for each cell or unknown, ...
struct EnergyParameter {
  std::string_view name;  ///< "stiffness"; of a stage's own term also "base_positions" and the like
  Eigen::Index size = 1;
};

/// Matrices of the cells of a body, for its own loop over them to add (energy/elastic.hpp).
class CellMatrices;

/// A source of friction on bodies (contact/friction_contact.hpp).
class FrictionSource;

/// Capabilities of a term that are asked for as a whole: each has a header of its name.
class CellTerm;
class HistoryTerm;
class LaggedTerm;

/// One term of the sum that is minimised over the positions: E(x) in joules.
///
/// Positions are one number per unknown, node by node (`dim * node + component`) [m]. Terms of a world are
/// shared and never change; all functions are pure and give the same bits for any number of threads. What a
/// step has to remember (a shape of its start, pairs of things that touch) lives in the term's own copy for
/// that stage: see `begin_stage`.
///
/// Every function is pure virtual, so that a class that wraps a term answers each of them or does not
/// compile. A term derives from `BasicEnergy`, which has the answers of a term without further capabilities.
class Energy {
 public:
  virtual ~Energy() = default;

  // ---- the core

  virtual std::string_view name() const = 0;
  virtual EnergyProperties properties() const = 0;

  /// Energy [J]; zero in the reference configuration; +infinity outside the domain (J <= 0 under a
  /// logarithm).
  virtual double value(const VectorX& x, const Conditions& c) const = 0;

  /// E(to) - E(from) [J] as the sum of the differences of its parts, so that it keeps its digits when the two
  /// are close. +infinity when `to` is outside the domain.
  virtual double difference(const VectorX& from, const VectorX& to, const Conditions& c) const = 0;

  /// The sum of the |parts| that `value` is made of [J]: the scale of its round-off.
  virtual double magnitude(const VectorX& x, const Conditions& c) const = 0;

  /// Adds dE/dx [N] to `gradient`.
  virtual void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const = 0;

  /// Adds the sum over its parts of |dE_part/dx| [N]: the scale of the round-off in the gradient.
  virtual void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const = 0;

  /// Adds d2E/dx2 [N/m], its parts projected as asked. `bind` must have been called.
  virtual void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                           BlockMatrix& hessian) const = 0;

  /// Adds permanent couplings of nodes. Called once, before `bind`.
  virtual void add_pattern(BlockPatternBuilder& builder) const = 0;
  /// Looks up its slots in the pattern that all energies share. Called once.
  virtual void bind(const BlockPattern& pattern) = 0;

  /// The largest step t in (0, 1] such that x + t p stays inside the domain with a margin.
  virtual double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const = 0;

  // ---- capabilities as a whole; null: the term does without

  /// The term as one with internal variables: its stages begin with those of a state.
  virtual const HistoryTerm* history_term() const = 0;

  /// The term as a sum over the cells of a body, whose loop may serve other terms.
  virtual const CellTerm* cell_term() const = 0;
  /// Matrices of the cells of a body, if the Hessian is a sum of such. A cell term of that body takes them
  /// along, so that each block of the Hessian is visited once; `add_hessian` is then not asked for.
  virtual const CellMatrices* cell_matrices() const = 0;

  /// A stage's own term as one that keeps something of a shape that is known, such as normal forces.
  virtual LaggedTerm* lagged_term() = 0;

  /// The term as a source of friction.
  virtual const FrictionSource* friction_source() const = 0;

  // ---- second order

  /// Adds forces [N] that times the inverse of the Hessian at x lead a Newton step p around what it would run
  /// into although to first order it does not. @return whether there are any
  virtual bool add_second_order_forces(const VectorX& x, const VectorX& p, const Conditions& c,
                                       VectorX& forces) const = 0;

  // ---- one stage of a step, in motion and in statics

  /// The term for one stage, which then belongs to the stage alone: terms that follow velocities, that lag
  /// something behind or that keep what an iteration shares make one. Null: the term itself serves. It must
  /// not outlive this term.
  virtual std::unique_ptr<Energy> begin_stage(const Stage& stage) const = 0;

  /// Asked of a stage's own terms alone, before `max_step`, `difference` and `add_gradient` between x and
  /// x + p: what they all need (candidates for contact) may be found here, once.
  virtual void prepare(const VectorX& x, const VectorX& p, const Conditions& c) = 0;

  // ---- driven motion

  /// Work [J] of imposed changes of the term, by a function of time or its own motion, while bodies move from
  /// `from` to `to`: where a scheme decides at which of the two the term's forces are taken, the largest that
  /// it may be. None for a term whose energy depends on the positions alone.
  virtual std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                            const Conditions& after) const = 0;

  /// Smallest delay of the term's own motion when bodies are at x, at most `c.delay` [s]: zero where
  /// nothing blocks it.
  virtual double least_delay(const VectorX& x, const Conditions& c) const = 0;

  // ---- reporting

  /// The term's force on the bodies in sum, for terms that report it under their name.
  virtual std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const = 0;

  /// Directions in which it constrains nodes at x, so that no rigid-body motion is free.
  virtual void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const = 0;

  /// Heat [J] that the term makes while bodies go from one shape to another at even speed: zero for terms
  /// that neither damp nor rub.
  virtual double dissipation(const VectorX& from, const VectorX& to, double duration) const = 0;

  // ---- derivatives by the term's own numbers p, with everything else held: products of d2E/(dx dp)

  virtual std::vector<EnergyParameter> parameters() const = 0;

  /// slopes += w . d2E/(dx dp), w one number per unknown: what an adjoint solution says of p.
  /// @param name    of one of `parameters`, whose size `slopes` has
  virtual void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                    const Conditions& c, VectorX& slopes) const = 0;

  /// gradient += d2E/(dx dp) . change: the first order of what a change of p does to dE/dx [N].
  virtual void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                    const Conditions& c, VectorX& gradient) const = 0;
};

/// The base of terms: answers for every capability that a term may do without. A term overrides those that it
/// has.
class BasicEnergy : public Energy {
 public:
  double magnitude(const VectorX& x, const Conditions& c) const override { return std::abs(value(x, c)); }
  void add_pattern(BlockPatternBuilder&) const override {}
  void bind(const BlockPattern&) override {}
  double max_step(const VectorX&, const VectorX&, const Conditions&) const override { return 1; }

  const HistoryTerm* history_term() const override { return nullptr; }
  const CellTerm* cell_term() const override { return nullptr; }
  const CellMatrices* cell_matrices() const override { return nullptr; }
  LaggedTerm* lagged_term() override { return nullptr; }
  const FrictionSource* friction_source() const override { return nullptr; }

  bool add_second_order_forces(const VectorX&, const VectorX&, const Conditions&, VectorX&) const override {
    return false;
  }

  std::unique_ptr<Energy> begin_stage(const Stage&) const override { return nullptr; }
  void prepare(const VectorX&, const VectorX&, const Conditions&) override {}

  std::optional<double> driven_work(const VectorX&, const Conditions&, const VectorX&,
                                    const Conditions&) const override {
    return std::nullopt;
  }
  double least_delay(const VectorX&, const Conditions&) const override { return 0; }

  std::optional<Reaction> reaction(const VectorX&, const Conditions&) const override { return std::nullopt; }
  void add_held_directions(const VectorX&, std::vector<HeldDirection>&) const override {}
  double dissipation(const VectorX&, const VectorX&, double) const override { return 0; }

  std::vector<EnergyParameter> parameters() const override { return {}; }
  void add_parameter_slopes(std::string_view, const VectorX&, const VectorX&, const Conditions&,
                            VectorX&) const override {}
  void add_parameter_forces(std::string_view, const VectorX&, const VectorX&, const Conditions&,
                            VectorX&) const override {}
};

/// A sum of energies; the order is that of the sum.
using Terms = std::vector<std::shared_ptr<const Energy>>;

}  // namespace resilin
