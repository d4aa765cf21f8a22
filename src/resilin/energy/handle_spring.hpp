#pragma once

#include <vector>

#include "resilin/energy/dead_load.hpp"

namespace resilin {

/// Springs that pull nodes towards moving points: E = k/2 sum_i |x_i - (X_i + t u + v (time - from))|^2.
class HandleSpring final : public BasicEnergy {
 public:
  struct Motion {
    Vector3 displacement = Vector3::Zero();  ///< u: where the far end stands, from the rest position [m]
    Vector3 velocity = Vector3::Zero();      ///< v: how it moves on [m/s]
    double start = 0;                        ///< since when it moves [s]
  };

  HandleSpring(std::string name, int dim, std::vector<Index> nodes, double stiffness, Motion motion,
               VectorX rest_positions, ActiveTime active = {});

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.is_quadratic = true}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX&, const Conditions& c, Projection, BlockMatrix& hessian) const override;
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;
  std::vector<EnergyParameter> parameters() const override {
    return {{"stiffness"},
            {"displacement", dim_},
            {"velocity", dim_},
            {"rest_positions", rest_positions_.size()}};
  }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  const std::vector<Index>& nodes() const { return nodes_; }

 private:
  /// Vector from the far end to the node.
  Vector3 stretch(Index node, const VectorX& x, const Conditions& c) const;
  /// Derivative of the far end by the displacement or, according to `name`, the velocity.
  double slope_of_end(std::string_view name, const Conditions& c) const {
    return name == "velocity" ? c.time - motion_.start : active_.function.factor(c.time, c.load);
  }

  std::string name_;
  int dim_;
  std::vector<Index> nodes_;
  double stiffness_;  ///< [N/m]
  Motion motion_;
  VectorX rest_positions_;
  ActiveTime active_;
};

}  // namespace resilin
