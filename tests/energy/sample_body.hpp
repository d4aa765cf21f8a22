#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "resilin/element/catalog.hpp"
#include "resilin/energy/elastic.hpp"
#include "sample_fibres.hpp"

namespace resilin::testing {

/// A block of n^dim cells of Kuhn simplices with edges of 0.1 m, its inner vertices moved, its vertices in
/// random order.
struct Body {
  int dim;
  std::vector<Index> cells;
  VectorX X;

  explicit Body(int dimension, int n = 3) : dim(dimension) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> shift(-0.015, 0.015);
    const int nz = dim == 3 ? n : 0, side = n + 1;
    std::vector<Index> number(static_cast<std::size_t>(side * side * (nz + 1)));
    for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<Index>(i);
    std::shuffle(number.begin(), number.end(), random);
    const auto id = [&](int i, int j, int k) {
      return number[static_cast<std::size_t>(i + side * (j + side * k))];
    };
    X.resize(static_cast<Eigen::Index>(number.size()) * dim);
    for (int k = 0; k <= nz; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          const int place[3] = {i, j, k};
          for (int c = 0; c < dim; ++c) X[id(i, j, k) * dim + c] = 0.1 * place[c] + shift(random);
        }
    const std::vector<std::array<int, 3>> orders =
        dim == 3 ? std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                                   {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}
                 : std::vector<std::array<int, 3>>{{0, 1, 2}, {1, 0, 2}};
    for (int k = 0; k < std::max(nz, 1); ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          for (const auto& order : orders) {
            int at[3] = {i, j, k};
            std::vector<Index> cell = {id(at[0], at[1], at[2])};
            for (int s = 0; s < dim; ++s) {
              ++at[order[static_cast<std::size_t>(s)]];
              cell.push_back(id(at[0], at[1], at[2]));
            }
            if (!(volume(cell) > 0)) std::swap(cell[0], cell[1]);
            cells.insert(cells.end(), cell.begin(), cell.end());
          }
  }

  double volume(const std::vector<Index>& cell) const {
    const ElementInfo& element = *find_element("P1", dim);
    std::vector<double> positions;
    for (const Index node : cell)
      for (int c = 0; c < dim; ++c) positions.push_back(X[node * dim + c]);
    return point_geometry(element, element.quadrature("", "quadrature").points[0], positions).weight;
  }

  /// Rest positions moved at random; `amount` 0.02 inverts nothing, 0.12 does.
  VectorX moved(double amount, unsigned seed = 2) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    VectorX x = X;
    for (double& value : x) value += amount * normal(random);
    return x;
  }
};

inline ElasticEnergy make_energy(const Body& body, const LawInfo& law,
                                 InstructionSet set = preferred_instruction_set()) {
  const auto constants = law.constants_from(hooke_from_young_poisson(1e5 /* Pa */, 0.45));
  const auto fibres = fibres_for(law, {Vector3(0.8, 0.6, 0), Vector3(0.6, -0.8, 0)});
  return {body.dim, "P1", body.cells, body.X, law, constants, {fibres, fibres.size()}, set};
}

}  // namespace resilin::testing
