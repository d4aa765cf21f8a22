#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/element/element.hpp"
#include "resilin/mesh/node_gradients.hpp"

namespace resilin {

/// Fine points carried by coarse cells.
///
///   x(X) = sum_a N_a(X) x_a
///
/// N_a are the shape functions of the cell that contains X at rest, so the weights of a point sum to one and
/// reproduce every affine map exactly; of P2 cells every quadratic one. A point in no cell belongs to the
/// cell that is nearest to it in space, whose shape functions are continued (those of P2 and Q1 by their
/// affine part at the nearest place of the cell, so that they stay tame far away).
///
/// The smooth variant adds, at cells of first order, what makes it exact for quadratic maps where F_a is:
///
///   x(X) = sum_a N_a (x_a + 1/2 F_a (X - X_a)),   F_a = sum_cells V F / sum_cells V over the cells at node
///   a.
///
/// It hides the facets of the coarse cells. P2 cells are quadratic already: for them it changes nothing.
class Embedding {
 public:
  /// @param cells           nodes of the cells, element.num_nodes each, in the numbering of `rest_positions`
  /// @param rest_positions  dim numbers per node [m]
  /// @param points          at rest; in 2D the third coordinate is passed over [m]
  /// @throws InputError     when there are no cells or a point is not finite
  Embedding(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
            std::span<const Vector3> points, bool is_smooth = false);

  int dimension() const { return dim_; }
  bool is_smooth() const { return gradients_.has_value(); }
  Index num_points() const { return static_cast<Index>(cell_.size()); }
  int nodes_per_point() const { return nodes_per_point_; }

  /// For a point: its cell, the cell's nodes and their weights N_a.
  Index cell(Index point) const { return cell_[static_cast<std::size_t>(point)]; }
  std::span<const Index> nodes(Index point) const { return std::span(nodes_).subspan(first(point), width()); }
  std::span<const double> weights(Index point) const {
    return std::span(weights_).subspan(first(point), width());
  }

  /// Interpolation of a point from nodal positions, x = sum_k w_k x_(node_k), the smooth variant's part
  /// included: appends each node once, but such whose weight is rounding, with weights that sum to one.
  void append_weights(Index point, std::vector<Index>& nodes, std::vector<double>& weights) const;

  /// Distance of the points outside all cells.
  struct Outside {
    Index count = 0;              ///< count of points that are farther off than rounding
    Index point = -1;             ///< the worst; -1 when all are inside
    double distance = 0;          ///< distance of the worst from the nearest cell [m]
    double relative_to_edge = 0;  ///< the same by the mean edge of that cell
  };
  const Outside& outside() const { return outside_; }

  /// Present positions of the points: 3 numbers each, the third zero in 2D. Parallel, the same bits on any
  /// number of threads; float carries the coordinates to about seven digits.
  /// @param x    dim numbers per node [m]
  /// @param out  3 num_points() numbers
  void apply(const VectorX& x, std::span<double> out) const;
  void apply(const VectorX& x, std::span<float> out) const;

  /// The same weights on a number per node, such as a stress.
  void interpolate(std::span<const double> values, std::span<float> out) const;

 private:
  std::size_t width() const { return static_cast<std::size_t>(nodes_per_point_); }
  std::size_t first(Index point) const { return static_cast<std::size_t>(point) * width(); }
  void find_cells(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                  std::span<const Vector3> points);
  void number_used_nodes(Index num_nodes);
  void add_smoothing(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                     std::span<const Vector3> points);
  template <class Real>
  void apply_to(const VectorX& x, std::span<Real> out) const;

  int dim_ = 3;
  int nodes_per_point_ = 4;
  Outside outside_;
  std::vector<Index> cell_;
  std::vector<Index> nodes_;                ///< [point][a]
  std::vector<double> weights_;             ///< N_a at [point][a]
  std::vector<Index> used_nodes_;           ///< those that some point needs, rising
  std::vector<std::uint32_t> local_;        ///< number in used_nodes_ of each of nodes_
  std::optional<NodeGradients> gradients_;  ///< gradients of the smooth variant: F_a of used_nodes_
  std::vector<Vector3> arms_;  ///< arms of the smooth variant: 1/2 N_a (X - X_a) at [point][a] [m]
};

}  // namespace resilin
