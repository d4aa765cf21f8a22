#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "resilin/collision/pair_kind.hpp"
#include "resilin/core/types.hpp"

namespace resilin::testing {

inline constexpr PairKind every_pair_kind[] = {PairKind::point_point, PairKind::point_edge,
                                               PairKind::point_triangle, PairKind::edge_edge};

inline std::string name_of(PairKind kind) {
  switch (kind) {
    case PairKind::point_point:
      return "point_point";
    case PairKind::point_edge:
      return "point_edge";
    case PairKind::point_triangle:
      return "point_triangle";
    case PairKind::edge_edge:
      break;
  }
  return "edge_edge";
}

/// Random pairs of a kind: well-shaped ones and every kind of degenerate ones.
template <int dim>
class SamplePairs {
 public:
  using Vertices = std::vector<Vector<dim>>;

  SamplePairs(PairKind kind, unsigned seed) : kind_(kind), random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector<dim> place(double size = 1) {
    Vector<dim> x;
    for (double& value : x) value = uniform(-size, size);
    return x;
  }
  Vertices plain() {
    Vertices x;
    for (int i = 0; i < num_vertices(kind_); ++i) x.push_back(place());
    return x;
  }

  /// One of the families below, all vertices times a size from 1e-6 to 1e6.
  Vertices degenerate() {
    Vertices x = plain();
    const auto last = x.size() - 1;
    switch (std::uniform_int_distribution<int>(0, 8)(random_)) {
      case 0:
        break;
      case 1:
        x[last] = x[last - 1];
        break;  // an edge of no length
      case 2:
        x[last] = x[0];
        break;  // coincident points
      case 3:
        x[0] += std::pow(10, uniform(-12, 2)) * place();
        break;  // far or near
      case 4:
        x[last] = x[last - 1] + std::pow(10, uniform(-14, 0)) * place();
        break;  // sliver
      case 5:   // parallel or nearly so, or in a line
        if (last >= 2) x[last] = x[last - 1] + uniform(-2, 2) * (x[1] - x[0]);
        if (uniform(0, 1) < 0.7) x[last] += std::pow(10, uniform(-16, 0)) * place();
        break;
      case 6:
        x[0] = 0.3 * x[last] + 0.7 * x[last - 1] + std::pow(10, uniform(-15, -1)) * place();
        break;  // on it
      case 7:   // on a grid: ties everywhere
        for (Vector<dim>& v : x) v = (2 * v).array().round().matrix();
        break;
      default:
        for (Vector<dim>& v : x) v = x[0] + std::pow(10, uniform(-9, 0)) * (v - x[0]);
        break;
    }
    const double size = std::pow(10, uniform(-6, 6));
    for (Vector<dim>& v : x) v *= size;
    return x;
  }

 private:
  PairKind kind_;
  std::mt19937 random_;
};

}  // namespace resilin::testing
