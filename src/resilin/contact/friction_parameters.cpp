#include "resilin/contact/friction.hpp"
#include "resilin/contact/friction_slopes.hpp"

namespace resilin {

std::vector<EnergyParameter> LaggedFriction::parameters() const {
  Eigen::Index num_coefficients = 0, num_stiffnesses = 0;
  for (const FrictionSource* source : sources_) {
    num_coefficients += source->num_coefficients();
    num_stiffnesses += source->num_stiffnesses();
  }
  std::vector<EnergyParameter> all = {{"lag", still_.size()},
                                      {"base_positions", still_.size()},
                                      {"coefficients", num_coefficients},
                                      {"barrier_stiffness", num_stiffnesses}};
  if (is_mean_) all.push_back({"target", still_.size()});
  for (const std::string_view name : ColliderMotion::parameter_names)
    all.push_back({name, 3 * static_cast<Eigen::Index>(sources_.size())});
  return all;
}

const FrictionSlopes& LaggedFriction::slopes_at(const VectorX& x, const Conditions& c) const {
  const double time = c.time - c.delay;
  if (!slopes_ || slopes_at_ != x || slopes_time_ != time) {
    slopes_ = std::make_shared<const FrictionSlopes>(friction_.dim(), sources_, x, start_, still_, time_,
                                                     slip_.eps, c);
    slopes_at_ = x;
    slopes_time_ = time;
  }
  return *slopes_;
}

// Facets are where the base of the stage has them, and slip is counted from there too unless the stage is one
// of a mean.
void LaggedFriction::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                          const Conditions& c, VectorX& slopes) const {
  const FrictionSlopes& at = slopes_at(x, c);
  const auto zero = [](Eigen::Index size) { return VectorX(VectorX::Zero(size)); };
  FrictionSlopes::Change found;
  const auto add = [&](VectorX FrictionSlopes::Change::* part) {
    found.*part = zero(slopes.size());
    at.add_slopes(w, c.weight, found);
    slopes += found.*part;
    found.*part = {};
  };
  if (name == "lag") return add(&FrictionSlopes::Change::lag);
  if (name == "coefficients") return add(&FrictionSlopes::Change::coefficients);
  if (name == "barrier_stiffness") return add(&FrictionSlopes::Change::stiffness);
  if (name == "target") return add(&FrictionSlopes::Change::still);
  if (name == "base_positions") {
    add(&FrictionSlopes::Change::start);
    if (!is_mean_) add(&FrictionSlopes::Change::still);
    return;
  }
  found.shifts = found.rates = zero(slopes.size());
  at.add_slopes(w, c.weight, found);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    const ColliderMotion* motion = sources_[s]->motion_of_its_own();
    if (motion == nullptr) continue;
    const auto first = 3 * static_cast<Eigen::Index>(s);
    const ColliderMotion::Slopes by = motion->slopes_by(name, c.time - c.delay);
    slopes.segment<3>(first) += by.shift.transpose() * found.shifts.segment<3>(first) +
                                by.rate.transpose() * found.rates.segment<3>(first);
  }
}

void LaggedFriction::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                          const Conditions& c, VectorX& gradient) const {
  FrictionSlopes::Change of;
  if (name == "lag") {
    of.lag = change;
  } else if (name == "coefficients") {
    of.coefficients = change;
  } else if (name == "barrier_stiffness") {
    of.stiffness = change;
  } else if (name == "target") {
    of.still = change;
  } else if (name == "base_positions") {
    of.start = change;
    if (!is_mean_) of.still = change;
  } else {
    of.shifts = of.rates = VectorX::Zero(change.size());
    for (std::size_t s = 0; s < sources_.size(); ++s) {
      const ColliderMotion* motion = sources_[s]->motion_of_its_own();
      if (motion == nullptr) continue;
      const auto first = 3 * static_cast<Eigen::Index>(s);
      const ColliderMotion::Slopes by = motion->slopes_by(name, c.time - c.delay);
      of.shifts.segment<3>(first) = by.shift * change.segment<3>(first);
      of.rates.segment<3>(first) = by.rate * change.segment<3>(first);
    }
  }
  slopes_at(x, c).add_forces(of, c.weight, gradient);
}

}  // namespace resilin
