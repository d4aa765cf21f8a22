#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "resilin/contact/barrier.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/inversion_bound.hpp"

namespace resilin {

/// Prevents inversion of elements whose law is finite for J <= 0: a barrier at the volume ratio J = 0, of no
/// effect on cells that keep a tenth of their volume.
///
///   E(x) = sum_points V k b(J),   b the clamped log barrier that is zero from J = 0.1 on
///
/// It is inactive from the inversion of a cell until all have a tenth of their volume: cells that are
/// entangled come apart only through each other, and no energy appears when it is there again. Theory:
/// docs/theory/real_time.md, eq. (R.4).
class FoldBarrier final : public BasicEnergy {
 public:
  static constexpr double activation_ratio = 0.1;

  /// @param stiffness  k, of all cells or of one cell after another [Pa]
  FoldBarrier(std::shared_ptr<const ElasticEnergy> body, std::vector<double> stiffness);

  std::string_view name() const override { return "fold barrier"; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::elastic}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  /// No point that is flat at either end loses more than nine tenths of its volume; all are upright.
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override;
  std::unique_ptr<Energy> begin_stage(const Stage& stage) const override;

  bool is_resting() const { return is_resting_; }
  void rest() { is_resting_ = true; }
  /// Begins or ends to rest as the cells at x ask for.
  void look_at(const VectorX& x);
  /// The same, where it is known that all cells have a tenth of their volume.
  void look_at_roomy(const VectorX& x) { known_ = {x, {}}, is_resting_ = false; }

 private:
  template <int dim>
  struct PointShape;
  using Points = std::vector<std::size_t>;  ///< by their numbers in ElementBlocks::weights; ascending
  struct Found {
    VectorX x;
    Points points;
    bool is_of(const VectorX& y) const { return x.size() > 0 && x == y; }
  };

  Points flat_points(const VectorX& x) const;  ///< with J < 0.1; none while it rests
  Points find_flat_points(const VectorX& x) const;
  bool is_upright(const Points& points, const VectorX& x) const;
  std::size_t lane_place(std::size_t point) const;  ///< lane of its cell
  double stiffness_of(std::size_t point) const;     ///< V k [J]
  template <int dim>
  PointShape<dim> shape_of(std::size_t point, const VectorX& x) const;
  double volume_ratio(std::size_t point, const VectorX& x) const;
  VolumeCubic volume_cubic(std::size_t point, const VectorX& x, const VectorX& end) const;
  template <int dim>
  void add_forces(const VectorX& x, bool is_magnitude, VectorX& forces) const;
  template <int dim>
  void add_point_hessians(const VectorX& x, Projection projection, BlockMatrix& hessian) const;

  std::shared_ptr<const ElasticEnergy> body_;
  std::vector<double> stiffness_;
  ClampedLogBarrier barrier_{.activation_distance = activation_ratio};
  bool is_resting_ = false;
  Found known_;  ///< where a stage begins
  mutable std::optional<std::array<Found, 2>>
      memory_;  ///< memory of a stage, in which places are asked for again
};

}  // namespace resilin
