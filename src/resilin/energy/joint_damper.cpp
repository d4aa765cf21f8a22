#include "resilin/energy/joint_damper.hpp"

#include <cmath>

namespace resilin {
namespace {

class StageJointDamper final : public BasicEnergy {
 public:
  StageJointDamper(const JointDamper& damper, const JointCoordinate& coordinate, double damping,
                   const Stage& stage)
      : damper_(damper),
        coordinate_(coordinate),
        factor_(damping / stage.duration),
        base_positions_(stage.base_positions),
        shape_(stage.shape),
        slopes_(coordinate.slopes(stage.shape)) {}

  std::string_view name() const override { return damper_.name(); }
  EnergyProperties properties() const override { return damper_.properties(); }
  double value(const VectorX& x, const Conditions&) const override {
    const double way = coordinate_.rate(shape_, base_positions_, x);
    return 0.5 * factor_ * way * way;
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override {
    const double sum =
        coordinate_.rate(shape_, base_positions_, from) + coordinate_.rate(shape_, base_positions_, to);
    return 0.5 * factor_ * coordinate_.rate(shape_, from, to) * sum;
  }
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override {
    coordinate_.add_forces(factor_ * coordinate_.rate(shape_, base_positions_, x) * slopes_, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override {
    coordinate_.add_magnitudes(factor_ * coordinate_.rate(shape_, base_positions_, x) * slopes_, magnitude);
  }
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix& hessian) const override {
    coordinate_.add_blocks(factor_ * slopes_ * slopes_.transpose(), hessian);
  }

 private:
  const JointDamper& damper_;
  const JointCoordinate& coordinate_;
  double factor_;  ///< d / c
  VectorX base_positions_, shape_;
  JointCoordinate::Vector slopes_;
};

}  // namespace

double JointDamper::dissipation(const VectorX& from, const VectorX& to, double duration) const {
  const double change = coordinate_.change(from, to);
  return damping_ * change * change / duration;
}

std::unique_ptr<Energy> JointDamper::in_motion(const Stage& stage) const {
  return std::make_unique<StageJointDamper>(*this, coordinate_, damping_, stage);
}

}  // namespace resilin
