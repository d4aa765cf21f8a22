#include "resilin/simulation/potential.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "resilin/contact/friction_contact.hpp"
#include "resilin/energy/cell_term.hpp"
#include "resilin/energy/history_term.hpp"
#include "resilin/energy/lagged_term.hpp"
#include "resilin/linear/dependents.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/simulation/end_of_stage.hpp"

namespace resilin {
namespace {

/// Part of a gap in balance, relative to the activation distance, below which colliders wait next; and the
/// gap at which there is no room.
constexpr double share_of_balanced_gap = 0.1, no_relative_gap = 1e-9;

/// So often may terms disagree about how far they go, until they stay where they are.
constexpr int most_rounds_of_delay = 50;
constexpr double round_off_of_delay = 1e-12;  ///< rounding of a delay, relative to it

/// Share of the sum of |parts| of a force: what is smaller cannot be told from rounding.
constexpr double forces_round_off = 10 * std::numeric_limits<double>::epsilon();

/// A touch by a force up to so many times the rounding of all forces is grazing.
constexpr double grazing_touch = 1e4;
/// Forces on nodes that answer a touch, relative to it: of supports, of inertia.
constexpr double largest_answer = 10;

Eigen::Index count_history(std::span<const std::shared_ptr<const Energy>> terms) {
  Eigen::Index count = 0;
  for (const auto& term : terms)
    if (const HistoryTerm* of = term->history_term()) count += of->num_history_values();
  return count;
}

/// The internal variables of a term, which begin at `first`; this moves on to those of the next.
VectorX next_of(const VectorX& history, const HistoryTerm& term, Eigen::Index& first) {
  const Eigen::Index count = term.num_history_values();
  first += count;
  return history.segment(first - count, count);
}

}  // namespace

Potential Potential::at(const World& world, const State& state) {
  return in_stage(world, state, conditions_of(state), static_stage(state.positions));
}

Potential Potential::at(const World& world, const Conditions& conditions, const VectorX& positions) {
  return in_stage(world, VectorX(), conditions, static_stage(positions));
}

Potential::Potential(std::span<const std::shared_ptr<const Energy>> terms,
                     std::span<const std::uint8_t> is_fixed, const Conditions& conditions, const Stage& stage,
                     ProcessGroup share, VectorX history, const Dependents* dependents)
    : share_(std::move(share)),
      is_fixed_(is_fixed),
      dependents_(dependents),
      conditions_(conditions),
      time_to_end_(stage.time_to_end()),
      end_slope_(stage.end_slope()),
      base_positions_(stage.is_static() ? VectorX() : stage.base_positions),
      history_(std::move(history)) {
  const Eigen::Index num_history_values = count_history(terms);
  if (history_.size() == 0) history_.setZero(num_history_values);
  if (history_.size() != num_history_values)
    throw std::logic_error("Potential: the history is not that of the terms");
  Eigen::Index first = 0;
  for (const auto& term : terms) {
    const HistoryTerm* with_history = term->history_term();
    history_terms_.push_back(with_history);
    std::unique_ptr<Energy> own =
        with_history == nullptr
            ? term->begin_stage(stage)
            : with_history->begin_stage_after(next_of(history_, *with_history, first), stage);
    if (acts_as_impulse(term->properties().category) && EndOfStage::is_needed(stage)) {
      const Energy& inner = own ? *own : *term;
      own = std::make_unique<EndOfStage>(inner, std::move(own), stage);
    }
    terms_.push_back(own ? own.get() : term.get());
    if (!own) continue;
    if (LaggedTerm* lagged = own->lagged_term()) lagged_terms_.push_back(lagged);
    own_.push_back(std::move(own));
  }
  for (LaggedTerm* term : lagged_terms_) term->see(terms_);
  along_.resize(terms_.size());
  for (const Energy* term : terms_) {
    const CellMatrices* matrices = term->cell_matrices();
    const auto taker = std::ranges::find_if(terms_, [matrices](const Energy* other) {
      const CellTerm* cells = other->cell_term();
      return matrices != nullptr && cells != nullptr && cells->takes(*matrices);
    });
    is_taken_.push_back(taker != terms_.end());
    if (is_taken_.back()) along_[static_cast<std::size_t>(taker - terms_.begin())].push_back(matrices);
  }
}

bool Potential::form_lag(const VectorX& x) {
  bool is_changed = false;
  for (LaggedTerm* term : lagged_terms_) is_changed |= term->form_lag(x, conditions_);
  return is_changed;
}

bool Potential::relax_lag() {
  bool is_changed = false;
  for (LaggedTerm* term : lagged_terms_) is_changed |= term->relax_lag();
  return is_changed;
}

void Potential::couple_lag(bool is_coupled) {
  for (LaggedTerm* term : lagged_terms_) term->couple_lag(is_coupled);
}

void Potential::follow(const VectorX& x, const VectorX& p, double t) {
  for (LaggedTerm* term : lagged_terms_) term->follow(x, p, t);
}

void Potential::prepare(const VectorX& x, const VectorX& p) {
  for (const auto& term : own_) term->prepare(x, p, conditions_);
}

double Potential::difference(const VectorX& from, const VectorX& to) const {
  double sum = 0;
  for (const Energy* term : terms_) sum += term->difference(from, to, conditions_);
  return share_.sum(sum);
}

double Potential::magnitude(const VectorX& x) const {
  double sum = 0;
  for (const Energy* term : terms_) sum += term->magnitude(x, conditions_);
  return share_.sum(sum);
}

void Potential::gradient(const VectorX& x, VectorX& gradient) const {
  gradient.setZero(x.size());
  for (const Energy* term : terms_) term->add_gradient(x, conditions_, gradient);
  share_.add_copies(gradient);
  if (dependents_ != nullptr) dependents_->add_forces(gradient);
}

void Potential::gradient_magnitude(const VectorX& x, VectorX& magnitude) const {
  magnitude.setZero(x.size());
  for (const Energy* term : terms_) term->add_gradient_magnitude(x, conditions_, magnitude);
  share_.add_copies(magnitude);
  if (dependents_ != nullptr) dependents_->add_magnitudes(magnitude);
}

void Potential::hessian(const VectorX& x, Projection projection, BlockMatrix& hessian) const {
  for (std::size_t i = 0; i < terms_.size(); ++i) add_hessian_of(i, {}, x, projection, hessian);
}

void Potential::add_hessian_of(std::size_t i, const VectorX& internal, const VectorX& x,
                               Projection projection, BlockMatrix& hessian) const {
  if (is_taken_[i]) return;
  if (const CellTerm* cells = terms_[i]->cell_term()) {
    cells->add_hessian_at(internal, x, conditions_, projection, hessian, along_[i]);
  } else {
    terms_[i]->add_hessian(x, conditions_, projection, hessian);
  }
}

namespace {

void append(VectorX& all, const VectorX& more) {
  const Eigen::Index size = all.size();
  all.conservativeResize(size + more.size());
  all.tail(more.size()) = more;
}

}  // namespace

VectorX Potential::internal_values(const VectorX& x) const {
  VectorX all;
  for (const Energy* term : terms_)
    if (const CellTerm* cells = term->cell_term()) append(all, cells->internal_values(x));
  return all;
}

VectorX Potential::predicted_internal_values(const VectorX& x, const VectorX& p, double t) const {
  VectorX all;
  for (const Energy* term : terms_)
    if (const CellTerm* cells = term->cell_term()) append(all, cells->predicted_internal_values(x, p, t));
  return all;
}

void Potential::hessian_at(const VectorX& internal, const VectorX& x, Projection projection,
                           BlockMatrix& hessian) const {
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const CellTerm* cells = terms_[i]->cell_term();
    const Eigen::Index count = cells == nullptr ? 0 : cells->num_internal_values();
    add_hessian_of(i, internal.segment(first, count), x, projection, hessian);
    first += count;
  }
}

bool Potential::has_potential(const VectorX& x) const {
  std::vector<const Energy*> doubtful;
  for (const Energy* term : terms_)
    if (!term->properties().has_potential) doubtful.push_back(term);
  if (share_.all(doubtful.empty())) return true;
  // A symmetric tangent T has a.T b = b.T a for any a, b. The force is quadratic in x: its central difference
  // is T, for a step of any length.
  const auto tangent_times = [&](const VectorX& p) {
    VectorX after = VectorX::Zero(x.size()), before = after;
    for (const Energy* term : doubtful) {
      term->add_gradient(x + p, conditions_, after);
      term->add_gradient(x - p, conditions_, before);
    }
    VectorX product = 0.5 * (after - before);
    share_.add_copies(product);
    return product;
  };
  const double extent = share_.largest(x.maxCoeff()) - share_.smallest(x.minCoeff());
  const Eigen::Index dim = share_.is_whole() ? 1 : x.size() / share_.num_nodes();
  VectorX a(x.size()), b(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool is_free = is_fixed_[static_cast<std::size_t>(i)] == 0;
    const auto number = static_cast<double>(share_.number_of(static_cast<Index>(i / dim)) * dim + i % dim);
    a[i] = is_free ? extent * std::sin(1.0 + 12.9898 * number) : 0;
    b[i] = is_free ? extent * std::cos(2.0 + 78.233 * number) : 0;
  }
  const VectorX Ta = tangent_times(a), Tb = tangent_times(b);
  constexpr double round_off = 1e-9;
  const double gap = std::abs(share_.dot(a, Tb) - share_.dot(b, Ta));
  return gap <= round_off * (share_.norm(a) * share_.norm(Tb) + share_.norm(b) * share_.norm(Ta));
}

double Potential::max_step(const VectorX& x, const VectorX& p) const {
  double step = 1;
  for (const Energy* term : terms_) step = std::min(step, term->max_step(x, p, conditions_));
  return share_.smallest(step);
}

bool Potential::add_second_order_forces(const VectorX& x, const VectorX& p, VectorX& forces) const {
  bool are_any = false;
  for (const Energy* term : terms_) are_any |= term->add_second_order_forces(x, p, conditions_, forces);
  are_any = share_.any(are_any);
  if (are_any) share_.add_copies(forces);
  if (are_any && dependents_ != nullptr) dependents_->add_forces(forces);
  return are_any;
}

VectorX Potential::force_scales(const VectorX& x, const VectorX& gradient,
                                const ConnectedComponents& parts) const {
  VectorX scales = parts.norms(gradient, is_fixed_, Unknowns::fixed);
  VectorX force;
  for (const Energy* term : terms_) {
    if (term->properties().category == EnergyCategory::elastic) continue;
    force.setZero(x.size());
    term->add_gradient(x, conditions_, force);
    share_.add_copies(force);
    scales = scales.cwiseMax(parts.norms(force, is_fixed_, Unknowns::all));
  }
  return scales;
}

VectorX Potential::distinct_acting_scales(const VectorX& x, const VectorX& known_roundings,
                                          const ConnectedComponents& parts) const {
  struct Acting {
    VectorX sizes, roundings;
    bool may_answer;  // a touch, or is one
  };
  std::vector<Acting> all;
  VectorX roundings = VectorX::Zero(parts.count());
  if (share_.any(known_roundings.size() > 0)) {
    roundings = known_roundings;
    VectorX forces;
    gradient(x, forces);
    all.push_back({parts.norms(forces, is_fixed_, Unknowns::fixed), roundings, true});
  }
  VectorX touches = VectorX::Zero(parts.count());
  VectorX force, magnitude, at_base;
  for (const Energy* term : terms_) {
    const EnergyCategory category = term->properties().category;
    if (category == EnergyCategory::elastic) continue;
    force.setZero(x.size());
    magnitude.setZero(x.size());
    term->add_gradient(x, conditions_, force);
    term->add_gradient_magnitude(x, conditions_, magnitude);
    share_.add_copies(force);
    share_.add_copies(magnitude);
    VectorX rounding = forces_round_off * parts.norms(magnitude, is_fixed_, Unknowns::all);
    VectorX sizes = parts.norms(force, is_fixed_, Unknowns::all);
    // Even motion has no inertial force, but momentum; over the step that is a force, too.
    if (category == EnergyCategory::inertia) {
      at_base.setZero(x.size());
      term->add_gradient(base_positions_, conditions_, at_base);
      share_.add_copies(at_base);
      sizes = sizes.cwiseMax(parts.norms(force - at_base, is_fixed_, Unknowns::all));
      // Accelerations and velocities are what all forces left, their rounding included.
      rounding = rounding.cwiseMax(roundings);
    }
    if (acts_as_impulse(category)) touches = touches.cwiseMax(sizes);
    const bool may_answer = acts_as_impulse(category) || category == EnergyCategory::inertia;
    all.push_back({std::move(sizes), std::move(rounding), may_answer});
  }
  VectorX scales = VectorX::Zero(parts.count());
  for (Index part = 0; part < parts.count(); ++part) {
    // Positions have no digits for a grazing touch: neither it nor what answers it is a load.
    const bool is_grazing = touches[part] <= grazing_touch * roundings[part];
    const double answer = is_grazing ? largest_answer * touches[part] : 0;
    for (const auto& [sizes, rounding, may_answer] : all)
      if (sizes[part] > std::max(rounding[part], may_answer ? answer : 0.0))
        scales[part] = std::max(scales[part], sizes[part]);
  }
  return scales;
}

double Potential::energy(EnergyCategory category, const VectorX& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (terms_[i]->properties().category == category)
      sum += history_terms_[i] != nullptr ? history_terms_[i]->stored_energy(x)
                                          : terms_[i]->value(x, conditions_);
  return share_.sum(sum);
}

double Potential::difference_without(EnergyCategory category, const VectorX& from, const VectorX& to) const {
  double sum = 0;
  for (const Energy* term : terms_)
    if (term->properties().category != category) sum += term->difference(from, to, conditions_);
  return share_.sum(sum);
}

VectorX Potential::gradient_of(EnergyCategory category, const VectorX& x) const {
  VectorX gradient = VectorX::Zero(x.size());
  for (const Energy* term : terms_)
    if (term->properties().category == category) term->add_gradient(x, conditions_, gradient);
  share_.add_copies(gradient);
  return gradient;
}

VectorX Potential::impulses(const VectorX& x) const {
  VectorX gradient = VectorX::Zero(x.size());
  for (const Energy* term : terms_)
    if (acts_as_impulse(term->properties().category)) term->add_gradient(x, conditions_, gradient);
  share_.add_copies(gradient);
  return gradient;
}

double Potential::heat_of_friction(const VectorX& from, const VectorX& x, double duration) const {
  double sum = 0;
  for (const Energy* term : terms_)
    if (term->properties().category == EnergyCategory::friction) sum += term->dissipation(from, x, duration);
  return share_.sum(sum);
}

std::vector<VectorX> Potential::gradients_without(EnergyCategory category, const VectorX& x) const {
  std::vector<VectorX> gradients;
  for (const Energy* term : terms_) {
    if (term->properties().category == category) continue;
    gradients.push_back(VectorX::Zero(x.size()));
    term->add_gradient(x, conditions_, gradients.back());
    share_.add_copies(gradients.back());
  }
  return gradients;
}

Potential::Gain Potential::gain(const VectorX& from, const Conditions& before, const VectorX& to) const {
  Gain gain;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const Energy* term = terms_[i];
    if (const HistoryTerm* of = history_terms_[i]) {
      gain.beyond_work += of->stored_difference(from, to);
      continue;
    }
    const std::optional<double> work = term->driven_work(from, before, to, conditions_);
    gain.beyond_work += work ? term->value(to, conditions_) - term->value(from, before) - *work
                             : term->difference(from, to, conditions_);
    gain.is_driven |= work.has_value();
  }
  gain.beyond_work = share_.sum(gain.beyond_work);
  return gain;
}

bool Potential::is_in_domain(const VectorX& x) const {
  double sum = 0;
  for (const Energy* term : terms_) sum += term->value(x, conditions_);
  return share_.all(std::isfinite(sum));
}

// Turning or swinging colliders may be clear of bodies now and later, but not between: all are asked again
// about the time that they have agreed on.
double Potential::least_delay(const VectorX& x) const {
  const double behind = conditions_.delay;
  double delay = 0;
  for (int round = 0; round < most_rounds_of_delay; ++round) {
    Conditions wanted = conditions_;
    wanted.time -= delay;
    wanted.delay -= delay;
    double more = 0;
    for (const Energy* term : terms_) more = std::max(more, term->least_delay(x, wanted));
    more = share_.largest(more);
    if (more <= round_off_of_delay * behind) return delay;
    delay += more;
    if (delay >= behind) break;
  }
  return behind;
}

void Potential::lead_colliders(int dim, const VectorX& x) {
  dim_ = dim;
  Conditions after = conditions_;
  after.delay = 0;
  const bool is_felt = std::ranges::any_of(terms_, [&](const Energy* term) {
    return own_way(*term, conditions_.delay) && term->value(x, after) != term->value(x, conditions_);
  });
  leads_colliders_ = share_.any(is_felt) || least_delay(x) > 0;
  if (!leads_colliders_) conditions_ = after;
}

std::optional<RigidPlace> Potential::own_way(const Energy& term, double way) const {
  const FrictionSource* source = term.friction_source();
  const ColliderMotion* motion = source == nullptr ? nullptr : source->motion_of_its_own();
  if (motion == nullptr || motion->keeps_place()) return std::nullopt;
  // The very places, rounding and all, that the term will have.
  const double end = conditions_.time + time_to_end_, delay = conditions_.delay;
  const RigidPlace from = motion->place(end - delay);
  RigidPlace own = motion->place(end - (delay - way));
  if (own.turn == from.turn) return RigidPlace{.turn = std::nullopt, .shift = own.shift - from.shift};
  const Eigen::Matrix3d as_made = Eigen::Matrix3d::Identity();
  own.turn = own.turn.value_or(as_made) * from.turn.value_or(as_made).transpose();
  own.shift -= own.turned(from.shift);
  return own;
}

VectorX Potential::end_of(const VectorX& x) const {
  return end_slope_ == 1 ? x : VectorX(end_slope_ * x - (end_slope_ - 1) * base_positions_);
}

VectorX Potential::seen_from(const RigidPlace& own_way, const VectorX& x, const VectorX& p) const {
  if (!own_way.turn) return p - (own_way.shift.head(dim_) / end_slope_).replicate(x.size() / dim_, 1);
  const VectorX from = end_of(x), to = end_of(x + p);
  VectorX seen(x.size());
  for (Index node = 0; node < static_cast<Index>(x.size() / dim_); ++node) {
    const Vector3 end = own_way.inverse(node_position(dim_, node, to));
    seen.segment(Eigen::Index{node} * dim_, dim_) =
        (end - node_position(dim_, node, from)).head(dim_) / end_slope_;
  }
  return seen;
}

// Steps that lead colliders are not judged by the energy: of each gap they may leave a tenth, one after the
// other.
double Potential::smallest_relative_gap(const VectorX& x) const {
  const VectorX end = end_of(x);
  Conditions at_end = conditions_;
  at_end.time += time_to_end_;
  double smallest = std::numeric_limits<double>::infinity();
  for (const Energy* term : terms_)
    if (const FrictionSource* source = term->friction_source())
      smallest = std::min(smallest, source->relative_gap(end, at_end));
  return share_.smallest(smallest);
}

// A force that is many times the stiffness of contact, as where bodies are thrown, needs a small gap.
bool Potential::find_room_in_balance(const VectorX& x) {
  const double gap = smallest_relative_gap(x);
  if (!(gap > no_relative_gap)) return false;
  least_relative_gap_ = std::min(least_relative_gap_, share_of_balanced_gap * gap);
  return true;
}

void Potential::prepare_along(const VectorX& x, const VectorX& p, double way) {
  for (const auto& term : own_) {
    const std::optional<RigidPlace> own = own_way(*term, way);
    term->prepare(x, own ? seen_from(*own, x, p) : p, conditions_);
  }
}

double Potential::max_step_along(const VectorX& x, const VectorX& p, double way) const {
  double step = 1;
  for (const Energy* term : terms_) {
    const std::optional<RigidPlace> own = own_way(*term, way);
    step = std::min(step, term->max_step(x, own ? seen_from(*own, x, p) : p, conditions_));
  }
  return share_.smallest(step);
}

bool Potential::add_second_order_forces_along(const VectorX& x, const VectorX& p, double way,
                                              VectorX& forces) const {
  bool are_any = false;
  for (const Energy* term : terms_) {
    const std::optional<RigidPlace> own = own_way(*term, way);
    are_any |= term->add_second_order_forces(x, own ? seen_from(*own, x, p) : p, conditions_, forces);
  }
  are_any = share_.any(are_any);
  if (are_any) share_.add_copies(forces);
  return are_any;
}

// A rigid motion R x + s of everything turns the forces g of a term by R. So where a term goes on by it alone
// g becomes, to first order, R g less the Hessian times the motion of the nodes.
void Potential::add_pull(const VectorX& x, double way, Projection projection, BlockMatrix& room,
                         VectorX& forces) const {
  const VectorX stays = VectorX::Zero(x.size());
  VectorX pull = stays, gradient, product;
  for (const Energy* term : terms_) {
    const std::optional<RigidPlace> own = own_way(*term, way);
    if (!own) continue;
    gradient.setZero(x.size());
    term->add_gradient(x, conditions_, gradient);
    room.set_zero();
    term->add_hessian(x, conditions_, projection, room);
    multiply(room, seen_from(*own, x, stays), product);
    pull += product;
    if (!own->turn) continue;
    for (Index node = 0; node < static_cast<Index>(x.size() / dim_); ++node) {
      const Vector3 force = node_position(dim_, node, gradient);
      pull.segment(Eigen::Index{node} * dim_, dim_) += (own->turned(force) - force).head(dim_);
    }
  }
  share_.add_copies(pull);
  forces += pull;
}

VectorX start_of_history(const Terms& terms, const VectorX& positions, double duration) {
  VectorX history = VectorX::Zero(count_history(terms));
  advance_history(terms, positions, positions, duration, history);
  return history;
}

double advance_history(const Terms& terms, const VectorX& from, const VectorX& to, double duration,
                       VectorX& history) {
  double heat = 0;
  Eigen::Index first = 0;
  for (const auto& term : terms) {
    const HistoryTerm* of = term->history_term();
    if (of == nullptr) continue;
    const Eigen::Index at = first;
    const HistoryTerm::Advance done = of->advance(next_of(history, *of, first), from, to, duration);
    history.segment(at, done.history.size()) = done.history;
    heat += done.heat;
  }
  return heat;
}

Terms terms_without(EnergyCategory category, const Terms& terms) {
  Terms left;
  std::ranges::copy_if(terms, std::back_inserter(left),
                       [category](const auto& term) { return term->properties().category != category; });
  return left;
}

}  // namespace resilin
