#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <vector>

#include "resilin/element/catalog.hpp"

namespace resilin {

/// The unit square or cube cut into cells of one element, its inner nodes moved at random. Middles of edges
/// stay midway, or leave it by `curvature` of an edge's length.
struct ElementMesh {
  int dim;
  VectorX X;
  std::vector<Index> cells;

  ElementMesh(const ElementInfo& element, int n, double curvature = 0) : dim(element.dim) {
    const int side = n + 1;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-0.15 / n, 0.15 / n);
    std::vector<Vector3> points;
    for (int k = 0; k < (dim == 3 ? side : 1); ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          Vector3 X_node = Vector3(i, j, k) / n;
          const std::array<int, 3> at = {i, j, k};
          for (int c = 0; c < dim; ++c)
            if (const int m = at[static_cast<std::size_t>(c)]; m > 0 && m < n) X_node[c] += uniform(random);
          points.push_back(X_node);
        }
    const auto id = [side](int i, int j, int k) { return static_cast<Index>(i + side * (j + side * k)); };
    for (int k = 0; k < (dim == 3 ? n : 1); ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) add_cube(element, {i, j, k}, id);
    if (element.degree == 2) add_middles(element, curvature, points, random);
    X.resize(static_cast<Eigen::Index>(points.size()) * dim);
    for (std::size_t v = 0; v < points.size(); ++v)
      X.segment(static_cast<Eigen::Index>(v) * dim, dim) = points[v].head(dim);
  }

  bool is_on_boundary(Index node) const {
    for (int c = 0; c < dim; ++c) {
      const double x = X[Eigen::Index{node} * dim + c];
      if (x < 1e-9 || x > 1 - 1e-9) return true;
    }
    return false;
  }

  /// Rest positions moved at random.
  VectorX moved(double amount, unsigned seed = 2) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    VectorX x = X;
    for (double& value : x) value += amount * normal(random);
    return x;
  }

 private:
  template <class Id>
  void add_cube(const ElementInfo& element, std::array<int, 3> at, const Id& id) {
    const auto [i, j, k] = at;
    if (!is_simplex(element.shape)) {
      for (int level = 0; level < (dim == 3 ? 2 : 1); ++level)
        for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
          cells.push_back(id(i + a, j + b, k + level));
      return;
    }
    std::array<int, 3> axes = {0, 1, 2};
    do {  // one simplex for each order of the axes (Kuhn)
      if (dim == 2 && axes[2] != 2) continue;
      std::array<int, 3> corner = at;
      std::vector<Index> cell = {id(i, j, k)};
      for (int s = 0; s < dim; ++s) {
        ++corner[static_cast<std::size_t>(axes[static_cast<std::size_t>(s)])];
        cell.push_back(id(corner[0], corner[1], corner[2]));
      }
      const bool is_odd = (axes[0] > axes[1]) != ((axes[0] > axes[2]) != (axes[1] > axes[2]));
      if (is_odd) std::swap(cell[0], cell[1]);
      cells.insert(cells.end(), cell.begin(), cell.end());
    } while (std::ranges::next_permutation(axes).found);
  }

  void add_middles(const ElementInfo& element, double curvature, std::vector<Vector3>& points,
                   std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-curvature, curvature);
    const auto corners = static_cast<std::size_t>(element.num_corners());
    std::map<std::pair<Index, Index>, Index> middle_of;
    std::vector<Index> quadratic;
    for (std::size_t first = 0; first < cells.size(); first += corners) {
      for (std::size_t a = 0; a < corners; ++a) quadratic.push_back(cells[first + a]);
      for (std::size_t node = corners; node < element.nodes.size(); ++node) {
        std::vector<Index> ends;  // the corners midway between which the node lies
        for (std::size_t a = 0; a < corners; ++a)
          for (std::size_t b = a + 1; b < corners; ++b)
            if ((0.5 * (element.nodes[a] + element.nodes[b]) - element.nodes[node]).norm() < 1e-12)
              ends = {cells[first + a], cells[first + b]};
        const auto [found, is_new] =
            middle_of.try_emplace(std::minmax(ends[0], ends[1]), static_cast<Index>(points.size()));
        if (is_new) {
          const Vector3 &a = points[static_cast<std::size_t>(ends[0])],
                        &b = points[static_cast<std::size_t>(ends[1])];
          Vector3 middle = 0.5 * (a + b);
          const bool is_inner =
              ((middle.head(dim).array() > 1e-9) && (middle.head(dim).array() < 1 - 1e-9)).all();
          for (int c = 0; c < dim && is_inner; ++c) middle[c] += uniform(random) * (b - a).norm();
          points.push_back(middle);
        }
        quadratic.push_back(found->second);
      }
    }
    cells = quadratic;
  }
};

}  // namespace resilin
