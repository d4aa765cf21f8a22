#include "resilin/contact/friction.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

using Slip = Eigen::Vector2d;

constexpr double not_turned =
    0.9;  ///< the cosine of the angle between normals of what is taken for one contact
/// Along a surface, of length 1 and at right angles; in 2D the second is zero.
using Tangents = Eigen::Matrix<double, 3, 2>;

Tangents tangents(int dim, const Vector3& normal) {
  Tangents T = Tangents::Zero();
  if (dim == 2) {
    T.col(0) = Vector3(-normal.y(), normal.x(), 0);
    return T;
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  T.col(0) = normal.cross(Vector3::Unit(axis)).normalized();
  T.col(1) = normal.cross(Vector3(T.col(0)));
  return T;
}

/// Length of the way of a point whose velocity goes evenly from a to b, in a time of one. By Simpson's rule
/// on both sides of where it is slowest: exact along a line, turned back or not.
double length_of_way(const Slip& a, const Slip& b) {
  const Slip d = b - a;
  const double slowest = d.squaredNorm() > 0 ? std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
  const auto speed = [&](double time) { return (a + time * d).norm(); };
  const auto part = [&](double from, double to) {
    return (to - from) / 6 * (speed(from) + 4 * speed(0.5 * (from + to)) + speed(to));
  };
  return part(0, slowest) + part(slowest, 1);
}

Slip unit(const Slip& u) {
  const double y = u.norm();
  return y > 0 ? Slip(u / y) : Slip::Zero();
}

FrictionContacts contacts_of(std::span<const FrictionSource* const> sources,
                             const std::vector<TimeFunction>& factors, const VectorX& x, const VectorX& start,
                             const Conditions& c) {
  FrictionContacts all;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    all.begin_source(s, factors[s].factor(c.time, 1));
    sources[s]->add_friction_contacts(x, start, c, all);
  }
  return all;
}

/// Between whom.
auto parties(const FrictionContacts::Entry& entry) {
  std::vector<Index> nodes;
  for (const WeightedNode& each : entry.nodes) nodes.push_back(each.node);
  return std::pair(entry.source, std::move(nodes));
}

/// Index of each contact among the earlier ones, if it was there and has not turned. Several contacts of the
/// same pair, such as a body's edge with edges of an obstacle, keep their order.
std::vector<std::optional<std::size_t>> same_contacts(const FrictionContacts& before,
                                                      const FrictionContacts& now) {
  std::vector<std::optional<std::size_t>> same(now.size());
  std::multimap<std::pair<std::size_t, std::vector<Index>>, std::size_t> known;
  for (std::size_t k = 0; k < before.size(); ++k) known.emplace(parties(before[k]), k);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const auto key = parties(now[i]);
    const auto found = known.lower_bound(key);
    if (found == known.end() || found->first != key) continue;
    if (before[found->second].contact.normal.dot(now[i].contact.normal) > not_turned) same[i] = found->second;
    known.erase(found);
  }
  return same;
}

/// sum_k weight_k step_k [m].
Vector3 way_along(int dim, const FrictionContacts::Entry& entry, const VectorX& step) {
  Vector3 sum = Vector3::Zero();
  for (const auto& [node, weight] : entry.nodes) sum += weight * node_position(dim, node, step);
  return sum;
}

Vector3 tangential(const Vector3& vector, const Vector3& normal) {
  return vector - vector.dot(normal) * normal;
}

}  // namespace

std::unique_ptr<Energy> Friction::begin_stage(const Stage& stage) const {
  if (!(stage.time_of_slip() > 0)) return nullptr;
  return std::make_unique<LaggedFriction>(*this, stage);
}

FrictionContacts Friction::contacts(const VectorX& x, const Conditions& c) const {
  std::vector<const FrictionSource*> sources;
  for (const auto& source : sources_) sources.push_back(source.get());
  return contacts_of(sources, factors_, x, x, c);
}

std::optional<double> Friction::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                            const Conditions& after) const {
  const double duration = (after.time - after.delay) - (before.time - before.delay);
  const auto most = [&](const VectorX& x, const Conditions& c) {
    const FrictionContacts all = contacts(x, c);
    double work = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const FrictionContact& contact = all[i].contact;
      work += contact.limit * duration * tangential(contact.velocity, contact.normal).norm();
    }
    return work;
  };
  const double work = std::max(most(from, before), most(to, after));
  return work > 0 ? std::optional(work) : std::nullopt;
}

void Friction::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  const FrictionContacts all = contacts(x, {});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const FrictionContacts::Entry entry = all[i];
    const Tangents T = tangents(dim_, entry.contact.normal);
    for (int k = 0; k < dim_ - 1; ++k) held.push_back({{entry.nodes.begin(), entry.nodes.end()}, T.col(k)});
  }
}

LaggedFriction::LaggedFriction(const Friction& friction, const Stage& stage)
    : friction_(friction),
      start_(stage.base_positions),
      still_(stage.still_end()),
      time_(stage.time_of_slip()),
      slip_{friction.speed() * stage.time_of_slip()},
      is_mean_(stage.is_mean) {
  for (const auto& source : friction.sources()) sources_.push_back(source.get());
}

void LaggedFriction::see(std::span<const Energy* const> terms) {
  for (const Energy* term : terms)
    if (const FrictionSource* own = term->friction_source())
      for (const FrictionSource*& source : sources_)
        if (own->is_copy_of(*source)) source = own;
}

bool LaggedFriction::form_lag(const VectorX& x, const Conditions& c) {
  if (coupled_) {
    coupled_ = contacts_of(sources_, friction_.factors(), x, start_, c);
    return coupled_->size() > 0;
  }
  before_.contacts = std::exchange(contacts_, contacts_of(sources_, friction_.factors(), x, start_, c));
  before_.directions = std::exchange(directions_, {});
  before_.of_contact = same_contacts(before_.contacts, contacts_);
  if (!before_.directions.empty()) {
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const auto known = before_.of_contact[i];
      const Tangents T = tangents(friction_.dim(), contacts_[i].contact.normal);
      const Slip u = slip(contacts_[i], T, x);
      directions_.push_back(known ? before_.directions[*known]
                                  : Vector3(slip_.slope_over_slip(u.norm()) * (T * u)));
    }
  }
  return before_.contacts.size() > 0 || contacts_.size() > 0;
}

std::vector<double> LaggedFriction::change_of_limits() {
  std::vector<double> changes(numbers_.size(), 0.0);
  const auto add = [&](const FrictionContacts& contacts, double sign) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const std::size_t number = numbers_.try_emplace(parties(contacts[i]), numbers_.size()).first->second;
      if (number == changes.size()) changes.push_back(0);
      changes[number] += sign * contacts[i].contact.limit;
    }
  };
  add(contacts_, 1);
  add(before_.contacts, -1);
  return changes;
}

// One share for all: forces across and along surfaces hang on each other from contact to contact. Limits say
// how rounds go on, for the forces of contacts that stick turn around by all of these wherever they slip a
// little.
bool LaggedFriction::relax_lag() {
  if (coupled_) return false;
  const double share = relaxation_.next_share(change_of_limits());
  if (share == 1) return false;
  std::vector<bool> is_left(before_.contacts.size(), true);
  for (std::size_t i = 0; i < before_.of_contact.size(); ++i) {
    if (const auto known = before_.of_contact[i]) {
      contacts_.mix(i, share, before_.contacts[*known]);
      is_left[*known] = false;
    } else {
      contacts_.scale_limit(i, share);
    }
  }
  for (std::size_t k = 0; k < is_left.size() && share < 1; ++k) {
    if (!is_left[k]) continue;
    FrictionContacts::Entry entry = before_.contacts[k];
    entry.contact.limit *= 1 - share;
    contacts_.begin_source(entry.source);
    contacts_.add(entry.contact, entry.nodes);
    if (!directions_.empty()) directions_.push_back(before_.directions[k]);
  }
  return true;
}

void LaggedFriction::couple_lag(bool is_coupled) {
  coupled_.reset();
  if (is_coupled) coupled_.emplace();
}

// With c = f1(y) / y the force over its limit is w = c u. Of w / c = u, linear in w and in u, a step du makes
// w + dw = c (u + du) + c'/c (u.du / y) w.
void LaggedFriction::follow(const VectorX& x, const VectorX& p, double t) {
  if (coupled_) return;
  std::vector<Vector3> followed(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const FrictionContacts::Entry entry = contacts_[i];
    const Tangents T = tangents(friction_.dim(), entry.contact.normal);
    const Slip u = slip(entry, T, x), du = T.transpose() * way_along(friction_.dim(), entry, p);
    const Slip w = direction(i, T, u);
    const double y = u.norm();
    const Slip end = slip_.slope_over_slip(y) * (u + du) - slip_.fall_of_slope(y) * unit(u).dot(du) * w;
    followed[i] = T * (w + t * (end - w));
    const double length = followed[i].norm();
    if (length > 1) followed[i] /= length;
  }
  directions_ = std::move(followed);
}

Vector3 LaggedFriction::way(const FrictionContacts::Entry& entry, const VectorX& from,
                            const VectorX& to) const {
  const int dim = friction_.dim();
  Vector3 sum = Vector3::Zero();
  for (const auto& [node, weight] : entry.nodes)
    sum += weight * (node_position(dim, node, to) - node_position(dim, node, from));
  return sum;
}

Eigen::Vector2d LaggedFriction::slip(const FrictionContacts::Entry& entry, const Tangents& T,
                                     const VectorX& x) const {
  return T.transpose() * (way(entry, still_, x) - time_ * entry.contact.velocity);
}

Slip LaggedFriction::direction(std::size_t contact, const Tangents& T, const Slip& slip) const {
  if (coupled_ || directions_.empty()) return slip_.slope_over_slip(slip.norm()) * slip;
  return T.transpose() * directions_[contact];
}

Vector3 LaggedFriction::force(const FrictionContacts::Entry& entry, const VectorX& x) const {
  const Tangents T = tangents(friction_.dim(), entry.contact.normal);
  const Slip u = slip(entry, T, x);
  return -entry.contact.limit * slip_.slope_over_slip(u.norm()) * (T * u);
}

double LaggedFriction::value(const VectorX& x, const Conditions& c) const {
  double sum = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const FrictionContacts::Entry entry = contacts_[i];
    const Slip u = slip(entry, tangents(friction_.dim(), entry.contact.normal), x);
    sum += entry.contact.limit * slip_.length(u.norm());
  }
  return c.weight * sum;
}

// |u + du| - |u| = du.(2 u + du) / (|u + du| + |u|)
double LaggedFriction::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  double sum = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const FrictionContacts::Entry entry = contacts_[i];
    const Tangents T = tangents(friction_.dim(), entry.contact.normal);
    const Slip u = slip(entry, T, from), du = T.transpose() * way(entry, from, to);
    const double y = u.norm(), end = (u + du).norm();
    if (!(y + end > 0)) {
      if (std::isnan(y + end)) return y + end;
      continue;
    }
    const double change = du.dot(2 * u + du) / (y + end);
    sum += entry.contact.limit * slip_.length_change(y, end, change);
  }
  return c.weight * sum;
}

void LaggedFriction::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  if (coupled_) {
    add_gradient_of(contacts_of(sources_, friction_.factors(), x, start_, c), x, c, gradient);
  } else {
    add_gradient_of(contacts_, x, c, gradient);
  }
}

void LaggedFriction::add_gradient_of(const FrictionContacts& contacts, const VectorX& x, const Conditions& c,
                                     VectorX& gradient) const {
  const int dim = friction_.dim();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FrictionContacts::Entry entry = contacts[i];
    const Vector3 slope = -c.weight * force(entry, x);
    for (const auto& [node, weight] : entry.nodes)
      gradient.segment(Eigen::Index{node} * dim, dim) += weight * slope.head(dim);
  }
}

void LaggedFriction::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const int dim = friction_.dim();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const FrictionContacts::Entry entry = contacts_[i];
    const Vector3 slope = c.weight * force(entry, x).cwiseAbs();
    for (const auto& [node, weight] : entry.nodes)
      magnitude.segment(Eigen::Index{node} * dim, dim) += std::abs(weight) * slope.head(dim);
  }
}

// mu lambda T (c I + c'/(c y) (w u^T + u w^T) / 2) T^T, never negative for |w| <= 1: that of F.1 where w = c
// u. A contact whose w is shorter than 1 is not done with sticking, however far the search moved it: so kinks
// at u = 0 are seen from afar. Source: Chan, Golub & Mulet 1999, for the total variation.
void LaggedFriction::add_hessian(const VectorX& x, const Conditions& c, Projection,
                                 BlockMatrix& hessian) const {
  const int dim = friction_.dim();
  const FrictionContacts& contacts = coupled_ ? *coupled_ : contacts_;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FrictionContacts::Entry entry = contacts[i];
    const Tangents T = tangents(dim, entry.contact.normal);
    const Slip u = slip(entry, T, x), w = direction(i, T, u);
    const double y = u.norm();
    const Eigen::Matrix2d turned = w * unit(u).transpose();
    const Eigen::Matrix2d inner = slip_.slope_over_slip(y) * Eigen::Matrix2d::Identity() -
                                  0.5 * slip_.fall_of_slope(y) * (turned + turned.transpose());
    const Eigen::Matrix3d block = c.weight * entry.contact.limit * (T * inner * T.transpose());
    std::array<double, 9> values{};
    for (std::size_t k = 0; k < entry.nodes.size(); ++k)
      for (std::size_t l = k; l < entry.nodes.size(); ++l) {
        const double weight = entry.nodes[k].weight * entry.nodes[l].weight;
        for (int r = 0; r < dim; ++r)
          for (int s = 0; s < dim; ++s) values[static_cast<std::size_t>(r * dim + s)] = weight * block(r, s);
        hessian.add_block(entry.nodes[k].node, entry.nodes[l].node, values.data());
      }
  }
}

// The slip velocity goes evenly to that at the end, by the same way. The work of the force along the way is
// less where the velocity turns back: the rest is what the scheme adds to the motion.
double LaggedFriction::dissipation(const VectorX& from, const VectorX& to, double duration) const {
  double heat = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const FrictionContacts::Entry entry = contacts_[i];
    const Tangents T = tangents(friction_.dim(), entry.contact.normal);
    const Slip path = T.transpose() * (way(entry, from, to) - duration * entry.contact.velocity);
    const Slip u = slip(entry, T, to);
    const Slip end = time_ > 0 ? Slip(duration / time_ * u) : path;
    const double force = entry.contact.limit * std::min(1.0, slip_.slope_over_slip(u.norm()) * u.norm());
    heat += force * length_of_way(2 * path - end, end);
  }
  return heat;
}

}  // namespace resilin
