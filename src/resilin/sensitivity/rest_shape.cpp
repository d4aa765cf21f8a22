#include "resilin/sensitivity/rest_shape.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/linear/gmres.hpp"
#include "resilin/sensitivity/parameter.hpp"
#include "resilin/sensitivity/prescribed_changes.hpp"
#include "resilin/sensitivity/stage_slopes.hpp"
#include "resilin/sensitivity/tangent.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin {
namespace {

constexpr double force_tolerance = 1e-10;  ///< of the run that judges, at most
constexpr double shortest_step = 1.0 / 64;
constexpr double least_accuracy = 1e-3;  ///< of GMRES: less is no step of Newton's

/// Rest places of the vertices, by body, and deformed places of all nodes, in the scene's coordinates.
struct Shape {
  std::vector<VectorX> rest;
  VectorX deformed;
};

VectorX shifted(VectorX places, const Vector3& by, int dim) {
  for (Eigen::Index i = 0; i < places.size(); ++i) places[i] += by[i % dim];
  return places;
}

std::vector<std::string> rest_names(const World& world) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const std::string& name = world.bodies[b].name;
    names.push_back("body." + (name.empty() ? std::to_string(b + 1) : name) + ".rest_positions");
  }
  return names;
}

Description with_rest(const Description& description, const std::vector<Parameter>& parameters,
                      const std::vector<VectorX>& rest) {
  Description changed = description;
  for (std::size_t b = 0; b < rest.size(); ++b) {
    parameters[b].set(rest[b], changed);
    changed.bodies[b].contact_shape.clear();  // as the scene has it that is made of the shape
  }
  return changed;
}

/// g(x, X) = 0 at the free unknowns, x = support(X) at the fixed ones, and its derivative by
///
///   z = dx - dX,
///
/// in which both are one unknown of each node: at a vertex, which stays where it was drawn, z = -dX; of an
/// added node, whose rest place follows those of the vertices, z says where it goes. Unstrained dg = K z.
class Balance {
 public:
  Balance(Description description, const std::vector<std::string>& names, const Shape& shape, double load)
      : world_(std::move(description)),
        links_(world_),
        conditions_(world_.at_load(load)),
        x_(shifted(shape.deformed, -world_.origin, world_.dimension)),
        potential_(world_, conditions_, static_stage(x_)),
        tangent_(world_, world_.solver.kind) {
    for (const std::string& name : names) parameters_.push_back(find_parameter(world_, name));
    potential_.prepare(x_, VectorX::Zero(x_.size()));
  }
  Balance(const Balance&) = delete;
  Balance& operator=(const Balance&) = delete;

  bool is_in_domain() const { return potential_.is_in_domain(x_); }
  bool is_apart() const { return std::isfinite(potential_.energy(EnergyCategory::contact, x_)); }

  /// Forms K; solutions with it are then to be had.
  void form() { tangent_.form(potential_, x_); }
  /// As far as solutions with it have told.
  Index unstable_modes() const { return tangent_.is_symmetric() ? tangent_.negative_eigenvalues() : 0; }

  /// What is out of balance: forces at the free unknowns, distances at the fixed ones.
  VectorX residual() const {
    VectorX found;
    potential_.gradient(x_, found);
    for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
      if (world_.is_fixed[i] != 0) found[static_cast<Eigen::Index>(i)] = 0;
    VectorX prescribed = world_.rest_positions;
    place_supports(world_.dimension, world_.supports, world_.rest_positions, conditions_, prescribed);
    for (std::size_t i = 0; i < world_.is_fixed.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (world_.is_fixed[i] != 0) found[k] = x_[k] - prescribed[k];
    }
    return found;
  }

  /// K z = residual at the free unknowns, z = residual at the fixed ones.
  VectorX preconditioned(const VectorX& residual) {
    VectorX z = residual;
    for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
      if (world_.is_fixed[i] == 0) z[static_cast<Eigen::Index>(i)] = 0;
    return z + tangent_.solve(residual - tangent_.times(z, false), false);
  }

  /// The change of the residual along z.
  VectorX product(const VectorX& z) {
    const WorldChange change = change_of(z);
    const VectorX dx = z + change.rest_positions;
    VectorX found = VectorX::Zero(x_.size());
    add_stage_forces({world_, potential_}, x_, links_.spread(change), {}, found);
    found += tangent_.times(dx, false);
    Motion prescribed{dx, VectorX::Zero(dx.size()), VectorX::Zero(dx.size())};
    place_prescribed_changes(world_, change, conditions_, prescribed);
    for (std::size_t i = 0; i < world_.is_fixed.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (world_.is_fixed[i] != 0) found[k] = dx[k] - prescribed.positions[k];
    }
    return found;
  }

  Shape moved(const Shape& shape, const VectorX& z) const {
    Shape next = shape;
    for (std::size_t b = 0; b < parameters_.size(); ++b) next.rest[b] += of_vertices(b, z);
    next.deformed += z + change_of(z).rest_positions;
    return next;
  }

 private:
  /// dX of a body's vertices.
  VectorX of_vertices(std::size_t body, const VectorX& z) const {
    return -z.segment(Eigen::Index{world_.bodies[body].first_node} * world_.dimension,
                      parameters_[body].value.size());
  }
  WorldChange change_of(const VectorX& z) const {
    WorldChange change(world_);
    for (const Parameter& parameter : parameters_) parameter.ask(change);
    for (std::size_t b = 0; b < parameters_.size(); ++b) parameters_[b].spread(of_vertices(b, z), change);
    return change;
  }

  World world_;
  TermLinks links_;
  Conditions conditions_;
  VectorX x_;
  Potential potential_;
  Tangent tangent_;
  std::vector<Parameter> parameters_;
};

class Search {
 public:
  Search(Description description, const RestShapeOptions& options)
      : options_(options), description_(std::move(description)) {
    if (description_.is_dynamic)
      throw InputError(description_.place + ": simulation.kind",
                       "\"static\", for the rest shape of an equilibrium", "\"dynamic\"");
    if (description_.modes)
      throw InputError(description_.place + ": simulation.modes", "none for a rest shape", "free vibrations");
    const World drawn{Description(description_)};
    if (drawn.friction)
      throw InputError(description_.place + ": rest shape", "contact without friction", "friction",
                       "with it an equilibrium depends on the way there, which is not known: leave it out");
    keep_elements(description_, drawn);
    names_ = rest_names(drawn);
    drawn_ = std::make_unique<World>(Description(description_));
    for (const std::string& name : names_) {
      parameters_.push_back(find_parameter(*drawn_, name));
      target_.rest.push_back(parameters_.back().value);
    }
    target_.deformed = shifted(drawn_->rest_positions, drawn_->origin, drawn_->dimension);
    size_ = drawn_->largest_extent();
  }

  RestShape found() {
    Shape shape = target_;
    double part = 0, raise = 1;
    while (part < 1) {
      const double towards = std::min(1.0, part + raise);
      if (std::optional<Shape> better = newton(shape, towards)) {
        shape = *std::move(better);
        part = towards;
        raise *= 2;
        continue;
      }
      raise /= 2;
      if (raise < options_.smallest_part) refuse(part);
    }
    return judged(shape);
  }

 private:
  [[noreturn]] void refuse(double part) const {
    throw InputError(description_.place + ": rest shape", "a shape that the loads deform into what is drawn",
                     "none beyond " + format_short(100 * part) + " % of the loads: " + failure_,
                     "take smaller loads or a stiffer body, or hold it at more places");
  }

  std::unique_ptr<Balance> balance(const Shape& shape, double part) {
    try {
      auto made =
          std::make_unique<Balance>(with_rest(description_, parameters_, shape.rest), names_, shape, part);
      if (made->is_in_domain()) return made;
      failure_ = made->is_apart() ? "cells would be turned inside out"
                                  : "bodies as drawn would be inside of what they touch";
    } catch (const InputError& error) {
      failure_ = error.what();
    }
    return nullptr;
  }

  /// Steps are shortened until the next one, by the same matrix, would be shorter: the natural test of
  /// Deuflhard 2004, "Newton Methods for Nonlinear Problems", ch. 3.
  std::optional<Shape> newton(Shape shape, double part) {
    std::unique_ptr<Balance> now = balance(shape, part);
    for (int k = 0; now && k < options_.max_iterations; ++k) {
      if (options_.goes_on && !options_.goes_on()) throw Interrupted();
      ++iterations_;
      try {
        now->form();
        const VectorX b = -now->preconditioned(now->residual());
        const GmresReport solution =
            gmres([&](const VectorX& z) { return now->preconditioned(now->product(z)); }, b, 1e-8,
                  options_.max_products);
        if (!(solution.left < least_accuracy)) {
          failure_ = "the rest shape does not follow from the deformed one";
          return std::nullopt;
        }
        const double length = solution.x.cwiseAbs().maxCoeff(), now_left = b.norm();
        double t = 1;
        for (;;) {
          Shape next = now->moved(shape, t * solution.x);
          std::unique_ptr<Balance> there = balance(next, part);
          if (there && (length <= options_.step * size_ ||
                        now->preconditioned(there->residual()).norm() <= (1 - t / 4) * now_left)) {
            shape = std::move(next);
            if (length <= options_.step * size_) {
              unstable_modes_ = now->unstable_modes();
              return shape;
            }
            now = std::move(there);
            break;
          }
          t /= 2;
          if (t < shortest_step) {
            if (there) failure_ = "no change of the rest shape comes nearer to balance";
            return std::nullopt;
          }
        }
      } catch (const InputError& error) {
        failure_ = error.what();
        return std::nullopt;
      }
    }
    if (now) failure_ = std::to_string(options_.max_iterations) + " iterations do not find balance";
    return std::nullopt;
  }

  void check_is_stable(Index unstable_modes) const {
    if (unstable_modes > 0)
      throw InputError(
          description_.place + ": rest shape", "a target that is a stable equilibrium",
          "one with " + std::to_string(unstable_modes) + " unstable mode" + (unstable_modes == 1 ? "" : "s"),
          "bodies would leave it: take smaller loads or a stiffer body");
  }

  /// By a run of the scene, in its own load steps, from the shape found.
  RestShape judged(const Shape& shape) {
    check_is_stable(unstable_modes_);
    Description changed = with_rest(description_, parameters_, shape.rest);
    changed.newton.tolerance = std::min(changed.newton.tolerance, force_tolerance);
    Simulation simulation(std::move(changed));
    while (!simulation.is_finished()) {
      const StepReport report =
          simulation.step([this](const NewtonReport&) { return !options_.goes_on || options_.goes_on(); });
      if (report.status == StepReport::Status::interrupted) throw Interrupted();
      if (report.status == StepReport::Status::not_converged)
        throw InputError(description_.place + ": rest shape", "a run from the shape found that converges",
                         "one that does not at load factor " + format_short(simulation.state().load) + ": " +
                             report.reason,
                         "take more load steps");
    }
    check_is_stable(simulation.frame().unstable_modes.value_or(0));
    const World& world = simulation.world();
    const VectorX x = shifted(simulation.state().positions, world.origin, world.dimension);
    RestShape result{.bodies = {}, .distance = 0, .size = size_, .iterations = iterations_};
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
      const VectorX& drawn = target_.rest[b];
      const VectorX deformed =
          x.segment(Eigen::Index{world.bodies[b].first_node} * world.dimension, drawn.size());
      for (Eigen::Index i = 0; i < drawn.size(); i += world.dimension) {
        const double distance =
            (deformed.segment(i, world.dimension) - drawn.segment(i, world.dimension)).norm();
        if (!(distance <= result.distance)) result.distance = distance;
      }
      result.bodies.push_back({names_[b].substr(5, names_[b].rfind('.') - 5), shape.rest[b], deformed});
    }
    if (!(result.distance <= options_.meets * size_))
      throw InputError(description_.place + ": rest shape",
                       "a run from the shape found that ends in the target",
                       "one that ends " + format_short(result.distance) + " m beside it",
                       "the loads have another equilibrium: take more load steps");
    return result;
  }

  RestShapeOptions options_;
  Description description_;
  std::unique_ptr<World> drawn_;
  std::vector<std::string> names_;
  std::vector<Parameter> parameters_;
  Shape target_;
  double size_ = 0;
  int iterations_ = 0;
  Index unstable_modes_ = 0;  ///< of the shape found
  std::string failure_ = "nothing was tried";
};

}  // namespace

RestShape find_rest_shape(Description description, const RestShapeOptions& options) {
  return Search(std::move(description), options).found();
}

}  // namespace resilin
