#include "resilin/simulation/force_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/optimize/convergence.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/simulation/step.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

/// Part of a displacement for differences of energies along it, whose error is the square of this beside one.
constexpr double part_of_displacement = 1e-4;
/// Part of a body's extent: a displacement that is only rounding is followed so far beyond itself, since
/// the positions have no digits for parts of it.
constexpr double least_way = 1e-6;
/// Where the energy ends so near by, parts are halved so often at most; shorter ones have no digits.
constexpr int most_halvings = 14;

/// Share of the largest gap that is accepted: from there on differences of energies are taken more closely.
constexpr double precision_of_doubt = 0.1;

/// Share of the parts that a force is the sum of, what rounding may leave of it.
constexpr double digits = 10 * std::numeric_limits<double>::epsilon();

std::string gap_text(const Body& body, const ForceBalance& balance) {
  return "the forces on \"" + body.name + "\" do not balance: its boundary conditions exert " +
         format_short(balance.reaction.norm()) + " N, all other forces " + format_short(balance.load.norm()) +
         " N; the imbalance is " + format_short(balance.gap()) + " N";
}

/// How the strain energy of a body changes from x to both sides of it, by parts of a displacement.
class EnergyRate {
 public:
  EnergyRate(const World& world, const Body& body, const VectorX& x, const VectorX& displacement)
      : share_(world.share), body_(body), x_(x), displacement_(displacement) {
    const double largest = world.share.largest(displacement
                                                   .segment(Eigen::Index{body.first_node} * world.dimension,
                                                            Eigen::Index{body.num_nodes} * world.dimension)
                                                   .cwiseAbs()
                                                   .maxCoeff());
    const double way = least_way * world.largest_extent(body);
    if (way * std::numeric_limits<double>::epsilon() > largest) return;  // moves nothing
    smallest_part_ = way / largest;
    part_ = std::max(part_of_displacement, smallest_part_);
    measure();
    for (int halvings = 0; !is_inside() && halvings < most_halvings; ++halvings) halve();
  }

  /// For the whole displacement at the rate at x [J].
  double rate() const { return (after_ - before_) / (2 * part_); }
  /// The larger of both changes, for the whole displacement [J].
  double scale() const { return std::max(std::abs(after_), std::abs(before_)) / (2 * part_); }

  /// Where the energy bends sharply, as near the limit of a law, differences see its rate from nearer by.
  /// @param precision  of the rate [J]
  void look_closer(double precision) {
    for (double last = std::numeric_limits<double>::infinity();
         !(std::abs(rate() - last) <= precision) && 0.5 * part_ >= smallest_part_;) {
      last = rate();
      halve();
    }
  }

 private:
  bool is_inside() const { return std::isfinite(after_) && std::isfinite(before_); }
  void halve() {
    part_ *= 0.5;
    measure();
  }
  void measure() {
    const VectorX step = part_ * displacement_;
    after_ = share_.sum(body_.domains.difference(x_, x_ + step));
    before_ = share_.sum(body_.domains.difference(x_, x_ - step));
  }

  const ProcessGroup& share_;
  const Body& body_;
  const VectorX& x_;
  const VectorX& displacement_;
  double part_ = part_of_displacement, smallest_part_ = part_of_displacement, after_ = 0, before_ = 0;
};

/// Numbers of a body's unknowns become zero where another process owns their node.
void leave_copies_out(const World& world, const Body& body, VectorX& values) {
  if (world.share.is_whole()) return;
  for (Eigen::Index i = 0; i < values.size(); ++i)
    if (!world.share.owns(body.first_node + static_cast<Index>(i / world.dimension))) values[i] = 0;
}

/// Norm of numbers of a body's unknowns.
double norm_of_body(const World& world, const Body& body, const Eigen::Ref<const VectorX>& values) {
  if (world.share.is_whole()) return values.norm();
  VectorX owned = values;
  leave_copies_out(world, body, owned);
  return std::sqrt(world.share.sum(owned.squaredNorm()));
}

/// Bound of the rounding of the sum of the forces on a body [N].
/// @param rounding  of each force; empty: none
double rounding_of(const World& world, const Body& body, const VectorX& rounding) {
  if (world.share.all(rounding.size() == 0)) return 0;
  const Eigen::Index count = Eigen::Index{body.num_nodes} * world.dimension;
  const double norm =
      norm_of_body(world, body, rounding.segment(Eigen::Index{body.first_node} * world.dimension, count));
  return norm * std::sqrt(world.share.sum(static_cast<double>(count)));
}

}  // namespace

namespace {

/// dE/dx of all that acts on bodies but for supports: loads, inertia, contact, springs and cables, what ties
/// and constraints pass on.
std::vector<VectorX> acting_on_bodies(const World& world, const Potential& potential, const VectorX& x,
                                      const VectorX& gradient) {
  std::vector<VectorX> acting = potential.gradients_without(EnergyCategory::elastic, x);
  const auto add = [&](const Energy& term) {
    if (term.properties().category != EnergyCategory::elastic) return;
    acting.push_back(VectorX::Zero(x.size()));
    term.add_gradient(x, potential.conditions(), acting.back());
  };
  for (const auto& cable : world.cables) add(*cable);
  for (const Joint& joint : world.joints)
    for (const auto& term : joint.terms) add(*term);
  if (world.constraints) acting.push_back(world.constraints->forces(gradient));
  return acting;
}

}  // namespace

std::vector<ForceBalance> measure_balance(const World& world, const VectorX& gradient,
                                          std::span<const VectorX> acting) {
  std::vector<ForceBalance> balances;
  for (const Body& body : world.bodies) {
    ForceBalance balance;
    double held = 0;  // supports may press against each other: their forces then cancel in the sum
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
      if (!world.share.owns(node)) continue;
      for (int k = 0; k < world.dimension; ++k) {
        const Eigen::Index i = Eigen::Index{node} * world.dimension + k;
        if (world.support_of[static_cast<std::size_t>(i)] < 0) continue;
        balance.reaction[k] += gradient[i];
        held += gradient[i] * gradient[i];
      }
    }
    balance.reaction = world.share.sum(balance.reaction);
    balance.scale = std::max(balance.reaction.norm(), std::sqrt(world.share.sum(held)));
    for (const VectorX& forces : acting) {
      Vector3 sum = Vector3::Zero();
      double size = 0;
      for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
        if (!world.share.owns(node)) continue;
        const Vector3 force = node_position(world.dimension, node, forces);
        sum -= force;
        size += force.squaredNorm();
      }
      sum = world.share.sum(sum);
      size = world.share.sum(size);
      balance.load += sum;
      balance.scale = std::max({balance.scale, sum.norm(), std::sqrt(size)});
    }
    if (is_axisymmetric(world)) balance.reaction.x() = balance.load.x() = 0;  // hoop stress balances the rest
    balances.push_back(balance);
  }
  return balances;
}

std::vector<WorkBalance> measure_work(const World& world, const Potential& potential, const VectorX& x,
                                      const VectorX& gradient, std::span<const VectorX> acting,
                                      const VectorX& displacement) {
  VectorX magnitude;
  potential.gradient_magnitude(x, magnitude);
  std::vector<WorkBalance> balances;
  for (const Body& body : world.bodies) {
    WorkBalance balance;
    EnergyRate energy(world, body, x, displacement);
    balance.strain_energy = energy.rate();
    balance.scale = energy.scale();
    const Eigen::Index first = Eigen::Index{body.first_node} * world.dimension;
    const Eigen::Index count = Eigen::Index{body.num_nodes} * world.dimension;
    double held = 0;
    for (Eigen::Index i = first; i < first + count; ++i) {
      if (!world.share.owns(static_cast<Index>(i / world.dimension))) continue;
      balance.rounding += digits * magnitude[i] * std::abs(displacement[i]);
      if (world.support_of[static_cast<std::size_t>(i)] < 0) continue;
      balance.work += gradient[i] * displacement[i];
      held += std::abs(gradient[i] * displacement[i]);
    }
    balance.rounding = world.share.sum(balance.rounding);
    balance.work = world.share.sum(balance.work);
    balance.scale = std::max(balance.scale, world.share.sum(held));
    for (const VectorX& forces : acting) {  // one by one: a weight and its inertia are large and cancel
      VectorX works = forces.segment(first, count).cwiseProduct(displacement.segment(first, count));
      leave_copies_out(world, body, works);
      balance.work -= world.share.sum(works.sum());
      balance.scale = std::max(balance.scale, world.share.sum(works.cwiseAbs().sum()));
    }
    const double precision = precision_of_doubt * largest_balance_error * balance.scale;
    if (!(balance.gap() <= precision)) {
      energy.look_closer(precision);
      balance.strain_energy = energy.rate();
    }
    balances.push_back(balance);
  }
  return balances;
}

namespace {

bool is_joined(const World& world, std::size_t body) {
  return std::ranges::any_of(world.joints, [&](const Joint& joint) {
    return std::ranges::find(joint.bodies, body) != joint.bodies.end();
  });
}

}  // namespace

std::string describe_imbalance(const World& world, const Potential& potential, const VectorX& x,
                               const VectorX& gradient, const NewtonReport& report,
                               const VectorX& displacement) {
  const auto is_missing = [](double gap, double scale, double rounding) {
    return !(gap <= std::max(largest_balance_error * scale, rounding));
  };
  const std::vector<VectorX> acting = acting_on_bodies(world, potential, x, gradient);
  const std::vector<ForceBalance> forces = measure_balance(world, gradient, acting);
  // Forces on joined bodies add up to one residual: a body without any has the rounding of the others'.
  const ConnectedComponents parts(*world.pattern, world.share);
  std::map<Index, double> scale_of_part;
  const auto part_of = [&](std::size_t b) {
    const Body& body = world.bodies[b];
    return parts.of_node(body.cells.size() == 0 ? body.first_node
                                                : body.cells.front());  // its first node may be free
  };
  for (std::size_t b = 0; b < forces.size(); ++b)
    if (is_joined(world, b)) {
      double& scale = scale_of_part[part_of(b)];
      scale = std::max(scale, forces[b].scale);
    }
  for (std::size_t b = 0; b < forces.size(); ++b) {
    const ForceBalance& balance = forces[b];
    double rounding = rounding_of(world, world.bodies[b], report.rounding);
    if (is_joined(world, b))
      rounding = std::max(rounding, world.newton.tolerance * scale_of_part.at(part_of(b)));
    if (!is_missing(balance.gap(), balance.scale, rounding)) continue;
    return gap_text(world.bodies[b], balance);
  }
  if (displacement.size() == 0 || world.share.all(displacement.isZero(0))) return {};
  const std::vector<WorkBalance> works = measure_work(world, potential, x, gradient, acting, displacement);
  for (std::size_t b = 0; b < works.size(); ++b) {
    const WorkBalance& balance = works[b];
    if (world.bodies[b].domains.have_history()) continue;  // forces do work that is not stored
    if (world.bodies[b].rigid) continue;  // a straight way of a turning body strains it beyond all measure
    // A body that slides across its forces goes a long way on which they do no work but that of what the
    // search may leave of them.
    const Eigen::Index first = Eigen::Index{world.bodies[b].first_node} * world.dimension;
    const auto of_body =
        displacement.segment(first, Eigen::Index{world.bodies[b].num_nodes} * world.dimension);
    const double way = norm_of_body(world, world.bodies[b], of_body);
    const double left =
        std::max({balance.rounding, rounding_of(world, world.bodies[b], report.rounding) * way,
                  world.newton.tolerance * forces[b].scale * way});
    if (!is_missing(balance.gap(), balance.scale, left)) continue;
    return "the strain energy of \"" + world.bodies[b].name + "\" would change by " +
           format_short(balance.strain_energy) + " J while the forces on it do " +
           format_short(balance.work) + " J of work; the difference is " + format_short(balance.gap()) +
           " J" + describe_limit(world.bodies[b]);
  }
  return {};
}

VectorX rounding_of_forces(const World& world, const Potential& potential, const ConnectedComponents& parts,
                           const VectorX& x, const VectorX& gradient) {
  BlockMatrix hessian(world.dimension, world.pattern);
  potential.hessian(x, Projection::none, hessian);
  if (world.constraints) world.constraints->dependents.reduce(hessian);
  Convergence balance(potential, world.is_fixed, parts, /*tolerance=*/0);
  balance.measure(x, gradient);
  balance.look_at_rounding(free_diagonal(hessian, world.is_fixed, world.share));
  return balance.rounding();
}

void drop_rounding(const World& world, const Potential& potential, const VectorX& x, VectorX& gradient) {
  const ConnectedComponents parts(*world.pattern, world.share);
  const VectorX roundings =
      parts.norms(rounding_of_forces(world, potential, parts, x, gradient), world.is_fixed, Unknowns::all);
  const VectorX forces = parts.norms(gradient, world.is_fixed, Unknowns::fixed);
  for (Index node = 0; node < world.num_nodes(); ++node) {
    const Index part = parts.of_node(node);
    if (largest_rounding * forces[part] <= roundings[part])
      gradient.segment(Eigen::Index{node} * world.dimension, world.dimension).setZero();
  }
}

std::vector<std::string> describe_lost_digits(const World& world, const State& state) {
  const VectorX& x = state.positions;
  Potential potential = Potential::in_stage(world, state, world.at_load(state.load), stage_of(world, state));
  potential.form_lag(x);
  VectorX gradient;
  potential.gradient(x, gradient);
  const ConnectedComponents parts(*world.pattern, world.share);
  const VectorX scales = potential.distinct_acting_scales(x, VectorX(), parts);
  const double notable = std::max(notable_balance_error, 10 * world.newton.tolerance);
  std::optional<VectorX> rounding;  // asked for where something is missing: it costs a matrix
  std::vector<std::string> texts;
  const std::vector<ForceBalance> forces =
      measure_balance(world, gradient, acting_on_bodies(world, potential, x, gradient));
  for (std::size_t b = 0; b < forces.size(); ++b) {
    const Body& body = world.bodies[b];
    double load = 0;  // reactions may be rounding themselves
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
      load = std::max(load, scales[parts.of_node(node)]);
    load = world.share.largest(load);
    if (load == 0 || forces[b].gap() <= notable * std::max(load, forces[b].scale)) continue;
    if (!rounding) rounding = rounding_of_forces(world, potential, parts, x, gradient);
    const bool is_rounding = forces[b].gap() <= rounding_of(world, body, *rounding);
    texts.push_back(gap_text(body, forces[b]) + (is_rounding ? ": the positions have no digits for less"
                                                             : ": a smaller newton.tolerance leaves less"));
  }
  return texts;
}

}  // namespace resilin
