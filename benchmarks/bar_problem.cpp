#include "bar_problem.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <numeric>

namespace resilin {
namespace {

/// Nodes of the simplices, dim + 1 for each. Node (i, j, k) has the number (i * (n + 1) + j) * (n + 1) + k.
template <int dim>
std::vector<Index> kuhn_cells(int n) {
  const auto node_at = [n](const std::array<int, dim>& place) {
    Index node = 0;
    for (int d = 0; d < dim; ++d) node = node * (n + 1) + place[d];
    return node;
  };
  std::vector<Index> cells;
  const int cubes = 4 * n * (dim == 3 ? n * n : n);
  for (int cube = 0; cube < cubes; ++cube) {
    std::array<int, dim> corner;
    for (int d = dim - 1, rest = cube; d >= 0; rest /= n, --d) corner[d] = d > 0 ? rest % n : rest;
    std::array<int, dim> path;
    std::iota(path.begin(), path.end(), 0);
    do {
      std::array<int, dim> place = corner;
      cells.push_back(node_at(place));
      for (const int axis : path) {
        ++place[axis];
        cells.push_back(node_at(place));
      }
    } while (std::next_permutation(path.begin(), path.end()));
  }
  return cells;
}

template <int dim>
VectorX grid_positions(int n) {
  const double h = 1.0 / n;
  const Index num_nodes = (4 * n + 1) * (dim == 3 ? (n + 1) * (n + 1) : n + 1);
  VectorX positions(num_nodes * dim);
  for (Index node = 0; node < num_nodes; ++node) {
    Index rest = node;
    for (int d = dim - 1; d > 0; rest /= n + 1, --d) positions[node * dim + d] = h * (rest % (n + 1));
    positions[node * dim] = h * rest;
  }
  return positions;
}

/// Stiffness of the pair (a, b) of a simplex: volume * (lambda g_a g_b^T + mu (g_b g_a^T + (g_a . g_b) I)).
template <int dim>
void add_stiffness(const BarOptions& options, const Index* nodes, BarProblem& bar) {
  const double E = options.youngs_modulus, nu = options.poissons_ratio;
  const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  Matrix<dim> Dm;
  const auto X = [&](int a) { return bar.node_positions.segment<dim>(nodes[a] * dim); };
  for (int c = 0; c < dim; ++c) Dm.col(c) = X(c + 1) - X(0);
  const double volume = std::abs(Dm.determinant()) / (dim == 3 ? 6 : 2);
  Eigen::Matrix<double, dim + 1, dim> gradients;
  gradients.template bottomRows<dim>() = Dm.inverse();
  gradients.row(0) = -gradients.template bottomRows<dim>().colwise().sum();
  const double node_mass = options.density * volume / (dim + 1);
  for (int a = 0; a <= dim; ++a) {
    const Vector<dim> g_a = gradients.row(a).transpose();
    for (int b = 0; b <= dim; ++b) {
      if (nodes[a] > nodes[b]) continue;
      const Vector<dim> g_b = gradients.row(b).transpose();
      Eigen::Matrix<double, dim, dim, Eigen::RowMajor> block = lambda * g_a * g_b.transpose() +
                                                               mu * g_b * g_a.transpose() +
                                                               mu * g_a.dot(g_b) * Matrix<dim>::Identity();
      block *= volume;
      bar.matrix.add_block(nodes[a], nodes[b], block.data());
    }
    bar.right_side[nodes[a] * dim + dim - 1] -= 9.81 * node_mass;
    if (options.time_step > 0)
      for (int d = 0; d < dim; ++d)
        bar.matrix.add_to_diagonal(nodes[a], d, node_mass / (options.time_step * options.time_step));
  }
}

template <int dim>
BarProblem make_bar(const BarOptions& options) {
  BarProblem bar;
  bar.node_positions = grid_positions<dim>(options.cells_per_height);
  const auto num_unknowns = bar.node_positions.size();
  const std::vector<Index> cells = kuhn_cells<dim>(options.cells_per_height);
  BlockPatternBuilder builder(static_cast<Index>(num_unknowns / dim));
  builder.add_cells(cells, dim + 1);
  bar.matrix = BlockMatrix(dim, std::make_shared<const BlockPattern>(builder.build()));
  bar.right_side = VectorX::Zero(num_unknowns);
  for (std::size_t cell = 0; cell < cells.size(); cell += dim + 1)
    add_stiffness<dim>(options, &cells[cell], bar);
  bar.is_fixed.assign(static_cast<std::size_t>(num_unknowns), 0);
  for (Offset k = 0; k < num_unknowns; ++k) {
    if (bar.node_positions[k / dim * dim] > 0) continue;
    bar.is_fixed[k] = 1;
    bar.right_side[k] = 0;
  }
  eliminate(bar.matrix, bar.is_fixed);
  return bar;
}

}  // namespace

BarProblem make_bar_problem(const BarOptions& options) {
  return options.dim == 3 ? make_bar<3>(options) : make_bar<2>(options);
}

}  // namespace resilin
