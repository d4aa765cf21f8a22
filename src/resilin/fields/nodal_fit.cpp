#include "resilin/fields/nodal_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

constexpr int columns = 3;  // components that are solved for at a time
constexpr double tolerance = 1e-13;
constexpr std::size_t rows_per_chunk = 1024;

/// Solves M X = B, one number of M per pair of nodes, for `columns` right-hand sides at once: b and x hold
/// them node by node. Conjugate gradients with M's diagonal, each side with steps of its own.
class ColumnsByGradients final : public LinearSolver {
 public:
  std::string_view name() const override { return "columns"; }
  bool is_direct() const override { return false; }
  void analyze(const BlockMatrix&, const VectorX&) override {}

  /// Rows of both triangles, so that a product writes each row once.
  LinearReport factorize(const BlockMatrix& M) override {
    const BlockPattern& upper = *M.pattern;
    const auto n = static_cast<std::size_t>(upper.num_nodes());
    begin_.assign(n + 1, 0);
    const auto for_each = [&](const auto& entry) {
      for (std::size_t i = 0; i < n; ++i)
        for (Offset s = upper.row_begin[i]; s < upper.row_begin[i + 1]; ++s) {
          const auto j = static_cast<std::size_t>(upper.columns[static_cast<std::size_t>(s)]);
          entry(i, j, *M.block(s));
          if (i != j) entry(j, i, *M.block(s));
        }
    };
    for_each([&](std::size_t row, std::size_t, double) { ++begin_[row + 1]; });
    for (std::size_t i = 0; i < n; ++i) begin_[i + 1] += begin_[i];
    nodes_.resize(begin_[n]);
    values_.resize(begin_[n]);
    inverse_diagonal_.resize(n);
    std::vector<std::size_t> end(begin_.begin(), begin_.end() - 1);
    for_each([&](std::size_t row, std::size_t column, double value) {
      nodes_[end[row]] = static_cast<Index>(column);
      values_[end[row]++] = value;
      if (row == column) inverse_diagonal_[row] = 1 / value;
    });
    return {};
  }

  LinearReport solve(const BlockMatrix& M, const VectorX& b, VectorX& x, double relative_tolerance) override {
    const auto n = static_cast<std::size_t>(M.num_nodes());
    x = VectorX::Zero(b.size());
    r_ = b;
    p_ = VectorX::Zero(b.size());
    q_.resize(b.size());
    LinearReport report;
    Sums first = residuals(n), now = first;
    Sums beta;
    const auto is_done = [&] {
      for (std::size_t k = 0; k < columns; ++k)
        if (now.squares[k] > relative_tolerance * relative_tolerance * first.squares[k]) return false;
      return true;
    };
    for (; report.iterations < most_iterations && !is_done(); ++report.iterations) {
      next_direction(n, beta);
      const Sums pMp = multiply_direction(n);
      std::array<double, columns> alpha{};
      for (std::size_t k = 0; k < columns; ++k)
        alpha[k] = pMp.products[k] > 0 ? now.products[k] / pMp.products[k] : 0;
      parallel_for(n, rows_per_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin * columns; i < end * columns; ++i) {
          const auto at = static_cast<Eigen::Index>(i);
          x[at] += alpha[i % columns] * p_[at];
          r_[at] -= alpha[i % columns] * q_[at];
        }
      });
      const Sums after = residuals(n);
      for (std::size_t k = 0; k < columns; ++k)
        beta.products[k] = now.products[k] > 0 ? after.products[k] / now.products[k] : 0;
      now = after;
    }
    if (!is_done()) report.status = LinearReport::Status::not_converged;
    return report;
  }

 private:
  static constexpr int most_iterations = 1000;

  struct Sums {
    std::array<double, columns> products{}, squares{};
    Sums& operator+=(const Sums& other) {
      for (std::size_t k = 0; k < columns; ++k)
        products[k] += other.products[k], squares[k] += other.squares[k];
      return *this;
    }
  };

  /// r.D^-1 r and r.r of each column.
  Sums residuals(std::size_t n) const {
    return parallel_sum<Sums>(n, rows_per_chunk, [&](std::size_t begin, std::size_t end) {
      Sums sums;
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < columns; ++k) {
          const double r = r_[static_cast<Eigen::Index>(i * columns + k)];
          sums.products[k] += inverse_diagonal_[i] * r * r;
          sums.squares[k] += r * r;
        }
      return sums;
    });
  }

  /// p = D^-1 r + beta p
  void next_direction(std::size_t n, const Sums& beta) {
    parallel_for(n, rows_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < columns; ++k) {
          const auto at = static_cast<Eigen::Index>(i * columns + k);
          p_[at] = inverse_diagonal_[i] * r_[at] + beta.products[k] * p_[at];
        }
    });
  }

  /// q = M p, and p.q of each column.
  Sums multiply_direction(std::size_t n) {
    return parallel_sum<Sums>(n, rows_per_chunk, [&](std::size_t begin, std::size_t end) {
      Sums sums;
      for (std::size_t i = begin; i < end; ++i) {
        std::array<double, columns> row{};
        for (std::size_t s = begin_[i]; s < begin_[i + 1]; ++s) {
          const double* p = p_.data() + std::size_t{columns} * static_cast<std::size_t>(nodes_[s]);
          for (std::size_t k = 0; k < columns; ++k) row[k] += values_[s] * p[k];
        }
        for (std::size_t k = 0; k < columns; ++k) {
          const auto at = static_cast<Eigen::Index>(i * columns + k);
          q_[at] = row[k];
          sums.products[k] += p_[at] * row[k];
        }
      }
      return sums;
    });
  }

  std::vector<std::size_t> begin_;
  std::vector<Index> nodes_;
  std::vector<double> values_, inverse_diagonal_;
  VectorX r_, p_, q_;
};

std::vector<double> shape_values(const ElementInfo& element, std::span<const Vector3> places) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> values(places.size() * n);
  for (std::size_t i = 0; i < places.size(); ++i)
    element.shape_values(places[i], std::span(values).subspan(i * n, n));
  return values;
}

std::vector<Vector3> places_of(const QuadratureRule& rule) {
  std::vector<Vector3> places;
  for (const QuadraturePoint& point : rule.points) places.push_back(point.xi);
  return places;
}

}  // namespace

NodalFit::NodalFit(const Body& body) : num_nodes_(static_cast<std::size_t>(body.num_nodes)) {
  const ElementInfo& element = body.domains.element();
  const ElementInfo& corner = corner_element(element);
  const auto nodes_per_cell = static_cast<std::size_t>(element.num_nodes);
  num_points_ = static_cast<std::size_t>(body.domains.num_points());
  num_corners_ = static_cast<std::size_t>(corner.num_nodes);
  for (std::size_t begin = 0; begin < body.cells.size(); begin += nodes_per_cell)
    for (std::size_t a = 0; a < num_corners_; ++a)
      corners_.push_back(body.cells[begin + a] - body.first_node);
  point_volumes_ = body.domains.point_volumes();
  if (body.domains.have_rigid_ones()) {
    const std::vector<double> volumes = body.domains.deformable_volumes();
    for (std::size_t point = 0; point < point_volumes_.size(); ++point)
      if (volumes[point / num_points_] == 0) point_volumes_[point] = 0;
  }
  shape_at_points_ = shape_values(corner, places_of(body.domains.quadrature()));
  shape_at_nodes_ = shape_values(corner, element.nodes);

  BlockPatternBuilder builder(body.num_nodes);
  builder.add_cells(corners_, corner.num_nodes);
  matrix_ = BlockMatrix(1, std::make_shared<const BlockPattern>(builder.build()));
  add_matrix(body);
  find_nodes_between(body);
  solver_ = std::make_unique<ColumnsByGradients>();
  solver_->factorize(matrix_);
}

void NodalFit::add_matrix(const Body& body) {
  // Cells of one point are simplices of degree 1, whose points weigh the same in all of them.
  const bool has_enough_points = body.domains.quadrature().degree >= 2;
  const CellShape shape = body.domains.element().shape;
  const QuadratureRule& rule = has_enough_points ? body.domains.quadrature() : rule_of_degree(shape, 2);
  const std::vector<double> N = shape_values(corner_element(body.domains.element()), places_of(rule));
  std::vector<bool> is_corner(num_nodes_, false);
  for (std::size_t cell = 0; cell * num_corners_ < corners_.size(); ++cell) {
    const Index* nodes = corners_.data() + cell * num_corners_;
    if (point_volumes_[cell * num_points_] == 0) continue;  // in a rigid region
    for (std::size_t a = 0; a < num_corners_; ++a) {
      is_corner[static_cast<std::size_t>(nodes[a])] = true;
      for (std::size_t b = 0; b < num_corners_; ++b) {
        if (nodes[b] < nodes[a]) continue;
        double entry = 0;
        for (std::size_t q = 0; q < rule.points.size(); ++q) {
          const double volume = has_enough_points
                                    ? point_volumes_[cell * num_points_ + q]
                                    : point_volumes_[cell] * rule.points[q].weight / size(shape);
          entry += volume * N[q * num_corners_ + a] * N[q * num_corners_ + b];
        }
        *matrix_.block(matrix_.pattern->slot(nodes[a], nodes[b])) += entry;
      }
    }
  }
  for (Index node = 0; node < matrix_.num_nodes(); ++node)
    if (!is_corner[static_cast<std::size_t>(node)]) matrix_.add_to_diagonal(node, 0, 1);
}

void NodalFit::find_nodes_between(const Body& body) {
  const auto nodes_per_cell = static_cast<std::size_t>(body.domains.element().num_nodes);
  std::vector<bool> is_found(num_nodes_, false);
  for (std::size_t cell = 0; cell * nodes_per_cell < body.cells.size(); ++cell)
    for (std::size_t local = num_corners_; local < nodes_per_cell; ++local) {
      const auto node = static_cast<std::size_t>(body.cells[cell * nodes_per_cell + local] - body.first_node);
      if (!is_found[node]) between_.push_back({node, cell, local});
      is_found[node] = true;
    }
}

/// sum_q V_q N_a(xi_q) f_q of the components `first`, `first` + 1, ...
VectorX NodalFit::right_side(std::span<const double> point_values, std::size_t components,
                             std::size_t first) const {
  VectorX b = VectorX::Zero(Eigen::Index{matrix_.num_nodes()} * columns);
  const std::size_t count = std::min<std::size_t>(columns, components - first);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const std::size_t cell = i / num_corners_, a = i % num_corners_;
    for (std::size_t q = 0; q < num_points_; ++q) {
      const std::size_t point = cell * num_points_ + q;
      const double weight = point_volumes_[point] * shape_at_points_[q * num_corners_ + a];
      for (std::size_t k = 0; k < count; ++k)
        b[Eigen::Index{corners_[i]} * columns + static_cast<Eigen::Index>(k)] +=
            weight * point_values[point * components + first + k];
    }
  }
  return b;
}

std::vector<double> NodalFit::fit(std::span<const double> point_values, int num_components) {
  const auto components = static_cast<std::size_t>(num_components);
  std::vector<double> values(num_nodes_ * components, std::numeric_limits<double>::quiet_NaN());
  if (!std::ranges::all_of(point_values, [](double value) { return std::isfinite(value); })) return values;
  for (std::size_t first = 0; first < components; first += columns) {
    const VectorX b = right_side(point_values, components, first);
    VectorX x = VectorX::Zero(b.size());
    solver_->solve(matrix_, b, x, tolerance);
    for (std::size_t node = 0; node < num_nodes_; ++node)
      for (std::size_t k = 0; k < columns && first + k < components; ++k)
        values[node * components + first + k] = x[static_cast<Eigen::Index>(node * columns + k)];
  }
  for (const auto& [node, cell, local] : between_)
    for (std::size_t k = 0; k < components; ++k) {
      double value = 0;
      for (std::size_t a = 0; a < num_corners_; ++a) {
        const auto corner = static_cast<std::size_t>(corners_[cell * num_corners_ + a]);
        value += shape_at_nodes_[local * num_corners_ + a] * values[corner * components + k];
      }
      values[node * components + k] = value;
    }
  return values;
}

}  // namespace resilin
