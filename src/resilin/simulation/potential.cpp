#include "resilin/simulation/potential.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "resilin/energy/pressure.hpp"

namespace resilin {

Potential::Potential(const World& world, const Conditions& conditions, const Inertia* inertia,
                     std::span<const std::unique_ptr<Energy>> more_terms)
    : world_(world), conditions_(conditions), inertia_(inertia), more_terms_(more_terms) {}

template <class Function>
void Potential::for_each_term(const Function& function) const {
  for (const auto& energy : world_.elastic) function(*energy);
  for (const auto& energy : world_.external) function(*energy);
  for (const auto& collider : world_.colliders) function(static_cast<const Energy&>(*collider));
  if (inertia_ != nullptr) function(static_cast<const Energy&>(*inertia_));
  for (const auto& term : more_terms_) function(*term);
}

double Potential::difference(const VectorX& from, const VectorX& to) const {
  double sum = 0;
  for_each_term([&](const Energy& energy) { sum += energy.difference(from, to, conditions_); });
  return sum;
}

double Potential::magnitude(const VectorX& x) const {
  double sum = 0;
  for_each_term([&](const Energy& energy) { sum += std::abs(energy.value(x, conditions_)); });
  return sum;
}

void Potential::gradient(const VectorX& x, VectorX& gradient) const {
  gradient.setZero(x.size());
  for_each_term([&](const Energy& energy) { energy.add_gradient(x, conditions_, gradient); });
}

void Potential::gradient_magnitude(const VectorX& x, VectorX& magnitude) const {
  magnitude.setZero(x.size());
  for_each_term([&](const Energy& energy) { energy.add_gradient_magnitude(x, conditions_, magnitude); });
}

void Potential::hessian(const VectorX& x, Projection projection, BlockMatrix& hessian) const {
  for_each_term([&](const Energy& energy) { energy.add_hessian(x, conditions_, projection, hessian); });
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
  for_each_term([&](const Energy& energy) { append(all, energy.internal_values(x)); });
  return all;
}

VectorX Potential::predicted_internal_values(const VectorX& x, const VectorX& p, double t) const {
  VectorX all;
  for_each_term([&](const Energy& energy) { append(all, energy.predicted_internal_values(x, p, t)); });
  return all;
}

void Potential::hessian_at(const VectorX& internal, const VectorX& x, Projection projection,
                           BlockMatrix& hessian) const {
  Eigen::Index first = 0;
  for_each_term([&](const Energy& energy) {
    const Eigen::Index count = energy.num_internal_values();
    energy.add_hessian_at(internal.segment(first, count), x, conditions_, projection, hessian);
    first += count;
  });
}

bool Potential::has_potential(const VectorX& x) const {
  std::vector<const Energy*> pressures;
  for (const auto& energy : world_.external) {
    if (dynamic_cast<const Pressure*>(energy.get()) != nullptr) pressures.push_back(energy.get());
  }
  if (pressures.empty()) return true;
  // A symmetric tangent T has a.T b = b.T a for any a, b. The force is quadratic in x: its central difference
  // is T, for a step of any length.
  const auto tangent_times = [&](const VectorX& p) {
    VectorX after = VectorX::Zero(x.size()), before = after;
    for (const Energy* pressure : pressures) {
      pressure->add_gradient(x + p, conditions_, after);
      pressure->add_gradient(x - p, conditions_, before);
    }
    return VectorX(0.5 * (after - before));
  };
  const double extent = x.maxCoeff() - x.minCoeff();
  VectorX a(x.size()), b(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool is_free = world_.is_fixed[static_cast<std::size_t>(i)] == 0;
    a[i] = is_free ? extent * std::sin(1.0 + 12.9898 * static_cast<double>(i)) : 0;
    b[i] = is_free ? extent * std::cos(2.0 + 78.233 * static_cast<double>(i)) : 0;
  }
  const VectorX Ta = tangent_times(a), Tb = tangent_times(b);
  constexpr double round_off = 1e-9;
  return std::abs(a.dot(Tb) - b.dot(Ta)) <= round_off * (a.norm() * Tb.norm() + b.norm() * Ta.norm());
}

double Potential::max_step(const VectorX& x, const VectorX& p) const {
  double step = 1;
  for_each_term([&](const Energy& energy) { step = std::min(step, energy.max_step(x, p, conditions_)); });
  return step;
}

double Potential::force_scale(const VectorX& x, const VectorX& gradient) const {
  double scale = 0;
  VectorX force;
  const auto include = [&](const Energy& energy) {
    force.setZero(x.size());
    energy.add_gradient(x, conditions_, force);
    scale = std::max(scale, force.norm());
  };
  for (const auto& energy : world_.external) include(*energy);
  for (const auto& collider : world_.colliders) include(*collider);
  if (inertia_ != nullptr) include(*inertia_);
  for (const auto& term : more_terms_) include(*term);
  double reaction = 0;
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    if (world_.is_fixed[static_cast<std::size_t>(i)] != 0) reaction += gradient[i] * gradient[i];
  }
  return std::max(scale, std::sqrt(reaction));
}

}  // namespace resilin
