#include "resilin/sensitivity/rest_shape.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/linear/gmres.hpp"
#include "resilin/sensitivity/pressing_colliders.hpp"
#include "resilin/sensitivity/rest_balance.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/constraints.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/support_phase.hpp"
#include "resilin/world/viscoelastic_material.hpp"

namespace resilin {
namespace {

constexpr double force_tolerance = 1e-10;  ///< tolerance of forces in the run that judges, at most
constexpr double shortest_step = 1.0 / 64, creeping_step = 1.0 / 32;
constexpr int most_creeping_steps = 3;  ///< running: smaller parts of the loads are nearer
constexpr const char* no_change_comes_nearer = "no change of the stress-free shape reduces the imbalance";
constexpr double least_accuracy = 1e-3;  ///< least accuracy of GMRES: less is no step of Newton's
/// Asked of GMRES: the loosest, the tightest and beside the square of what the last step has left (Eisenstat
/// & Walker 1996, choice 2).
constexpr double loosest = 1e-4, tightest = 1e-8, beside_square = 0.1;

std::vector<std::string> rest_names(const World& world) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const std::string& name = world.bodies[b].name;
    names.push_back("body." + (name.empty() ? std::to_string(b + 1) : name) + ".rest_positions");
  }
  return names;
}

/// The scene with other rest shapes.
/// @param start  of the vertices; null: where the scene lets them begin
Description with_rest(const Description& description, const std::vector<Parameter>& parameters,
                      const std::vector<VectorX>& rest, const std::vector<VectorX>* start = nullptr) {
  Description changed = description;
  for (std::size_t b = 0; b < rest.size(); ++b) {
    parameters[b].set(rest[b], changed);
    changed.bodies[b].contact_shape.clear();  // as the scene has it that is made of the shape
    if (start != nullptr) changed.bodies[b].initial_positions.assign((*start)[b].begin(), (*start)[b].end());
  }
  return changed;
}

/// Less than a gap, in three digits [m].
double shorter_distance(double gap) {
  const std::string digits = format_short(0.9 * gap);
  double distance = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), distance);
  return distance;
}

/// Largest distance of nodes from other ones; not a number where one is.
double largest_distance(const VectorX& from, const VectorX& to, int dim) {
  double largest = 0;
  for (Eigen::Index i = 0; i < from.size(); i += dim) {
    const double distance = (to.segment(i, dim) - from.segment(i, dim)).norm();
    if (!(distance <= largest)) largest = distance;
  }
  return largest;
}

class Search {
 public:
  Search(Description description, const RestShapeOptions& options)
      : options_(options), description_(std::move(description)) {
    if (description_.is_dynamic)
      throw InputError(description_.place + ": simulation.kind",
                       "\"static\", for the stress-free shape of an equilibrium", "\"dynamic\"");
    if (description_.modes)
      throw InputError(description_.place + ": simulation.modes", "none for a stress-free shape",
                       "modal analysis");
    refuse_constraints(description_, "a stress-free shape");
    refuse_releases(description_, "a stress-free shape");
    if (is_axisymmetric(description_))
      throw InputError(description_.place + ": simulation.dimension", "2 or 3 for a stress-free shape",
                       "\"axisymmetric\"", "take a slice in 3D");
    if (description_.thickness != 1)
      throw InputError(description_.place + ": simulation.thickness", "1 m for a stress-free shape",
                       format_number(description_.thickness),
                       "leave it out: forces are those of each metre then");
    if (const auto history = find_history(description_))
      throw InputError(history->place, "an elastic material for a stress-free shape", history->kind,
                       history->cure);
    for (const BodyDescription& body : description_.bodies)
      if (body.rigid)
        throw InputError(body.rigid->place, "deformable bodies for a stress-free shape", "a rigid one",
                         "leave rigid out, or make it a collider");
    const World drawn{Description(description_)};
    if (drawn.friction)
      throw InputError(description_.place + ": stress-free shape", "contact without friction", "friction",
                       "with friction an equilibrium depends on its history, which is unknown: leave it out");
    keep_elements(description_, drawn);
    keep_distances(drawn, false);
    names_ = rest_names(drawn);
    draw();
    size_ = drawn_->largest_extent();
  }

  RestShape found() {
    std::optional<RestAndDeformed> shape = search();
    if (!shape && keep_colliders_off()) shape = search();
    if (!shape) refuse();
    return judged(*shape);
  }

 private:
  void draw() {
    drawn_ = std::make_unique<World>(Description(description_));
    parameters_.clear();
    target_.rest.clear();
    for (const std::string& name : names_) {
      parameters_.push_back(find_parameter(*drawn_, name));
      target_.rest.push_back(parameters_.back().value);
    }
    target_.deformed = places_moved(drawn_->rest_positions, drawn_->origin, drawn_->dimension);
  }

  /// Activation distances that follow the start of a run: those of the drawn shape stay, and the shape found
  /// has the default that it was found with.
  void keep_distances(const World& starts, bool is_found) {
    for (const auto& [origin, shorter] : starts.shorter_distances) {
      const bool is_collider = origin.kind == TermOrigin::Kind::collider;
      const double distance = is_found ? default_activation_distance(starts) : shorter;
      if (is_collider) {
        ColliderDescription& collider = description_.colliders[origin.number];
        collider.activation_distance = distance;
        kept_off_.emplace_back(collider.name, distance);
        continue;
      }
      description_.contact.activation_distance = distance;
      warnings_.push_back(description_.place +
                          ": stress-free shape: it is for contact.activation_distance = " +
                          format_number(distance) + ", of the bodies as drawn");
    }
  }

  bool goes_on(const RestShapeProgress& progress) const {
    return !options_.goes_on || options_.goes_on(progress);
  }

  /// The loads are raised in parts where they cannot be taken at once.
  std::optional<RestAndDeformed> search() {
    RestAndDeformed shape = target_;
    double raise = 1;
    bool has_failed = false;  // the last attempt
    for (part_ = 0; part_ < 1;) {
      const double towards = std::min(1.0, part_ + raise);
      if (std::optional<RestAndDeformed> better = newton(shape, towards)) {
        shape = *std::move(better);
        part_ = towards;
        if (!std::exchange(has_failed, false)) raise *= 2;
        continue;
      }
      has_failed = true;
      raise /= 4;
      if (raise < options_.smallest_part) return std::nullopt;
    }
    return shape;
  }

  /// None where a body may have to be borne by what presses on it.
  std::vector<PressingCollider> pressing() const {
    for (const Body& body : drawn_->bodies)
      for (int axis = 0; axis < drawn_->dimension; ++axis)
        if (is_free_along(*drawn_, body, axis)) return {};
    return pressing_colliders(*drawn_, drawn_->rest_positions);
  }

  /// Colliders whose activation distance the scene leaves to us are felt from nearer than they are drawn.
  bool keep_colliders_off() {
    for (const PressingCollider& collider : pressing()) {
      const auto found = std::ranges::find(description_.colliders, collider.name, &ColliderDescription::name);
      if (found == description_.colliders.end() || found->activation_distance) continue;
      const double distance = shorter_distance(collider.gap);
      found->activation_distance = distance;
      kept_off_.emplace_back(collider.name, distance);
      warnings_.push_back(description_.place + ": stress-free shape: there is none if on the drawn shape " +
                          in_words(collider, *drawn_) + ": this one is for a \"" + collider.name +
                          "\" with activation_distance = " + format_number(distance) +
                          ", which does not press");
    }
    if (kept_off_.empty()) return false;
    draw();
    return true;
  }

  [[noreturn]] void refuse() const {
    std::string failure = failure_, cure = "take smaller loads or a stiffer body, or fix it at more places";
    for (const PressingCollider& collider : pressing()) {
      failure += "; on the drawn shape " + in_words(collider, *drawn_);
      cure.insert(0, "with an activation_distance below " + format_short(collider.gap) + " m \"" +
                         collider.name + "\" does not press; or draw it farther away, or ");
    }
    throw InputError(description_.place + ": stress-free shape",
                     "a shape that the loads deform into the drawn shape",
                     "none beyond " + format_short(100 * part_) + " % of the loads: " + failure, cure);
  }

  std::unique_ptr<RestBalance> balance(const RestAndDeformed& shape, double part) {
    try {
      auto made = std::make_unique<RestBalance>(
          with_rest(description_, parameters_, shape.rest, &target_.rest), names_, shape, part);
      if (made->is_in_domain()) return made;
      failure_ = made->is_apart() ? "elements would be inverted"
                                  : "drawn bodies would overlap their contact partners";
    } catch (const InputError& error) {
      failure_ = error.what();
    }
    return nullptr;
  }

  /// Steps are shortened until the next one, by the same matrix, would be shorter: the natural test of
  /// Deuflhard 2004, "Newton Methods for Nonlinear Problems", ch. 3.
  std::optional<RestAndDeformed> newton(RestAndDeformed shape, double part) {
    std::unique_ptr<RestBalance> now = balance(shape, part);
    double wanted = loosest;
    int creeping_steps = 0;
    for (int k = 0; now && k < options_.max_iterations; ++k) {
      if (!goes_on({.share = part_, .towards = part, .iterations = iterations_})) throw Interrupted();
      ++iterations_;
      try {
        now->form();
        const VectorX b = -now->preconditioned(now->residual());
        const GmresReport solution =
            gmres([&](const VectorX& z) { return now->preconditioned(now->product(z)); }, b, wanted,
                  options_.max_products);
        if (!(solution.left < least_accuracy)) {
          failure_ = "the stress-free shape is not determined by the deformed one";
          return std::nullopt;
        }
        const double length = solution.x.cwiseAbs().maxCoeff(), now_left = b.norm();
        double t = 1;
        for (;;) {
          RestAndDeformed next = now->moved(shape, t * solution.x);
          std::unique_ptr<RestBalance> there = balance(next, part);
          const double left = there ? now->preconditioned(there->residual()).norm() : 0;
          if (there && (length <= options_.step * size_ || left <= (1 - t / 4) * now_left)) {
            const double share = left / now_left;
            wanted = std::clamp(beside_square * share * share, tightest, loosest);
            shape = std::move(next);
            if (length <= options_.step * size_) {
              unstable_modes_ = now->unstable_modes();
              return shape;
            }
            now = std::move(there);
            creeping_steps = t <= creeping_step ? creeping_steps + 1 : 0;
            break;
          }
          t /= 2;
          if (t < shortest_step) {
            if (there) failure_ = no_change_comes_nearer;
            return std::nullopt;
          }
        }
        if (creeping_steps == most_creeping_steps) {
          failure_ = no_change_comes_nearer;
          return std::nullopt;
        }
      } catch (const InputError& error) {
        failure_ = error.what();
        return std::nullopt;
      }
    }
    if (now) failure_ = std::to_string(options_.max_iterations) + " iterations find no equilibrium";
    return std::nullopt;
  }

  void check_is_stable(Index unstable_modes) const {
    if (unstable_modes > 0)
      throw InputError(
          description_.place + ": stress-free shape", "a drawn shape that is a stable equilibrium",
          "one with " + std::to_string(unstable_modes) + " unstable mode" + (unstable_modes == 1 ? "" : "s"),
          "unstable equilibria cannot be reached: take smaller loads or a stiffer body");
  }

  /// The end of a run of the scene in its own load steps.
  Simulation end_of(Description scene) const {
    scene.newton.tolerance = std::min(scene.newton.tolerance, force_tolerance);
    Simulation simulation(std::move(scene));
    int iterations = 0;
    while (!simulation.is_finished()) {
      const StepReport report = simulation.step([&](const NewtonReport&) {
        return goes_on({.is_judging = true, .share = simulation.state().load, .iterations = ++iterations});
      });
      if (report.status == StepReport::Status::interrupted) throw Interrupted();
      if (report.status == StepReport::Status::not_converged)
        throw InputError(description_.place + ": stress-free shape",
                         "a run from the shape found that converges",
                         "one that does not at load factor " + format_short(simulation.state().load) + ": " +
                             report.reason,
                         "take more load steps");
    }
    return simulation;
  }

  /// Why no run begins in a rest shape; empty: one does.
  std::string what_is_in_the_way(const RestAndDeformed& shape) const {
    try {
      const World begins{with_rest(description_, parameters_, shape.rest)};
      return {};
    } catch (const InputError& error) {
      const World drawn{with_rest(description_, parameters_, shape.rest, &target_.rest)};
      const std::string around = collider_around(drawn, drawn.rest_positions);
      return around.empty() ? error.what() : around;
    }
  }

  /// A rest shape that reaches into a collider, moved out of it along an axis along which it may be anywhere.
  RestAndDeformed lifted(const RestAndDeformed& shape) const {
    RestAndDeformed out = shape;
    const World world{with_rest(description_, parameters_, shape.rest, &target_.rest)};
    VectorX x = world.rest_positions;
    for (const auto& collider : world.colliders) {
      const ColliderBarrier::Nearest nearest = collider->nearest(x, {});
      if (nearest.distance > 0) continue;
      const Body& body = world.body_of(collider->points().places.nodes_of(nearest.point)[0]);
      const double way = 0.5 * collider->activation_distance() - nearest.distance;
      for (int i = 0; i < 2 * world.dimension; ++i) {
        const int axis = i / 2;
        if (!is_free_along(world, body, axis)) continue;
        Vector3 by = Vector3::Zero();
        by[axis] = i % 2 == 0 ? way : -way;
        VectorX moved = x;
        const Eigen::Index first = Eigen::Index{body.first_node} * world.dimension,
                           count = Eigen::Index{body.num_nodes} * world.dimension;
        moved.segment(first, count) = places_moved(x.segment(first, count), by, world.dimension);
        if (!(collider->nearest(moved, {}).distance > 0)) continue;
        x = moved;
        VectorX& rest = out.rest[static_cast<std::size_t>(&body - world.bodies.data())];
        rest = places_moved(rest, by, world.dimension);
        break;
      }
    }
    return out;
  }

  /// By a run of the scene from the shape found, which begins there, or as drawn where none can begin there.
  RestShape judged(const RestAndDeformed& found) {
    check_is_stable(unstable_modes_);
    const RestAndDeformed shape = lifted(found);
    const std::string in_the_way = what_is_in_the_way(shape);
    if (in_the_way.empty()) keep_distances(World{with_rest(description_, parameters_, shape.rest)}, true);
    RestShape result;
    result.scene =
        with_rest(description_, parameters_, shape.rest, in_the_way.empty() ? nullptr : &target_.rest);
    result.size = size_;
    result.iterations = iterations_;
    result.warnings = warnings_;
    result.kept_off = kept_off_;
    const Simulation simulation = end_of(result.scene);
    check_is_stable(simulation.frame().unstable_modes.value_or(0));
    const World& world = simulation.world();
    if (!in_the_way.empty())
      result.warnings.push_back(description_.place + ": stress-free shape: it lies " + in_the_way +
                                ", where no run can start: use the drawn shape as the " +
                                "initial_positions of its bodies");
    const VectorX x = places_moved(simulation.state().positions, world.origin, world.dimension);
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
      const Eigen::Index first = Eigen::Index{world.bodies[b].first_node} * world.dimension;
      const VectorX& drawn = target_.rest[b];
      const VectorX deformed = x.segment(first, drawn.size()),
                    sought = shape.deformed.segment(first, drawn.size());
      if (const double distance = largest_distance(deformed, sought, world.dimension);
          !(distance <= result.distance))
        result.distance = distance;
      const std::string name = names_[b].substr(5, names_[b].rfind('.') - 5);
      if (const double moved = largest_distance(sought, drawn, world.dimension);
          moved > options_.meets * size_)
        result.warnings.push_back(description_.place + ": stress-free shape: \"" + name +
                                  "\" comes to stand " + format_short(moved) +
                                  " m from the drawn position, where its contact carries it");
      result.bodies.push_back({name, shape.rest[b], deformed});
    }
    if (!(result.distance <= options_.meets * size_))
      throw InputError(description_.place + ": stress-free shape",
                       "a run from the shape found that ends in the target",
                       "one that ends " + format_short(result.distance) + " m beside it",
                       "the loads have another equilibrium: use more load steps");
    return result;
  }

  RestShapeOptions options_;
  Description description_;
  std::unique_ptr<World> drawn_;
  std::vector<std::string> names_;
  std::vector<Parameter> parameters_;
  RestAndDeformed target_;
  double size_ = 0;
  std::vector<std::string> warnings_;
  std::vector<std::pair<std::string, double>> kept_off_;
  double part_ = 0;  ///< part of the loads for which there is a shape
  int iterations_ = 0;
  Index unstable_modes_ = 0;  ///< unstable modes of the shape found
  std::string failure_ = "nothing was tried";
};

}  // namespace

std::string RestShapeProgress::text() const {
  const auto percent = [](double part) { return format_short(100 * part) + " %"; };
  return (is_judging ? "a run from the shape found, at " + percent(share) + " of the loads"
                     : "a shape for " + percent(share) + " of the loads, towards " + percent(towards)) +
         ", iteration " + std::to_string(iterations);
}

RestShape find_rest_shape(Description description, const RestShapeOptions& options) {
  return Search(std::move(description), options).found();
}

}  // namespace resilin
