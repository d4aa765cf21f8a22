#include "resilin/energy/mass.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/parallel.hpp"
#include "resilin/mesh/cell_positions.hpp"
#include "resilin/mesh/shape_integrals.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 2048, slots_per_chunk = 8192;

/// Volumes that the nodes of a cell stand for, from integral N_a N_b dV.
void lump(const ElementInfo& element, std::span<const double> products, std::span<double> volumes) {
  const std::size_t n = volumes.size();
  double volume = 0, diagonal = 0;
  for (std::size_t a = 0; a < n; ++a) {
    volumes[a] = 0;
    for (std::size_t b = 0; b < n; ++b) volumes[a] += products[a * n + b];
    volume += volumes[a];
    diagonal += products[a * (n + 1)];
  }
  if (element.degree == 1) return;
  for (std::size_t a = 0; a < n; ++a) volumes[a] = volume * products[a * (n + 1)] / diagonal;
}

/// The slopes of sum_a c_a volumes_a by the products, `volumes` being those that `lump` makes of them.
void lump_slopes(const ElementInfo& element, std::span<const double> products, std::span<const double> c,
                 std::span<double> slopes) {
  const std::size_t n = c.size();
  if (element.degree == 1) {
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) slopes[a * n + b] = c[a];
    return;
  }
  double volume = 0, diagonal = 0, weighted = 0;
  for (std::size_t i = 0; i < n * n; ++i) volume += products[i];
  for (std::size_t a = 0; a < n; ++a) {
    diagonal += products[a * (n + 1)];
    weighted += c[a] * products[a * (n + 1)];
  }
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      slopes[a * n + b] =
          weighted / diagonal + (a == b ? volume / diagonal * (c[a] - weighted / diagonal) : 0.0);
}

/// y = M x in the chunks of the pattern's product plan, as products with matrices of blocks are.
template <int dimension, class Entry>
void multiply_slots(const MassMatrix& mass, const Entry& entry, const VectorX& x, VectorX& y) {
  const BlockPattern& pattern = *mass.pattern;
  const BlockPattern::ProductPlan& plan = pattern.product_plan;
  const Index num_nodes = pattern.num_nodes();
  const auto node = [](auto& v, Index i) {
    return v.template segment<dimension>(Eigen::Index{i} * dimension);
  };
  VectorX work = VectorX::Zero(Eigen::Index{dimension} * (num_nodes + plan.chunk_places.back()));
  parallel_tasks(static_cast<std::size_t>(plan.num_chunks()), [&](std::size_t chunk) {
    for (Index i = plan.chunk_begin[chunk]; i < plan.chunk_begin[chunk + 1]; ++i) {
      const auto row = static_cast<std::size_t>(i);
      for (auto s = static_cast<std::size_t>(pattern.row_begin[row]);
           s < static_cast<std::size_t>(pattern.row_begin[row + 1]); ++s) {
        const Index j = pattern.columns[s];
        const double m = entry(mass.slots[s]);
        node(work, i) += m * node(x, j);
        if (j != i) node(work, plan.targets[s]) += m * node(x, i);
      }
    }
  });
  parallel_for(static_cast<std::size_t>(num_nodes), nodes_per_chunk,
               [&](std::size_t first, std::size_t last) {
                 for (std::size_t i = first; i < last; ++i) {
                   Vector<dimension> sum = node(work, static_cast<Index>(i));
                   for (auto k = static_cast<std::size_t>(plan.gather_begin[i]);
                        k < static_cast<std::size_t>(plan.gather_begin[i + 1]); ++k)
                     sum += node(work, num_nodes + plan.gather_places[k]);
                   node(y, static_cast<Index>(i)) = sum;
                 }
               });
}

}  // namespace

template <class Entry>
void MassMatrix::multiply_with(const Entry& entry, const VectorX& x, VectorX& y) const {
  y.resize(x.size());
  const auto node = [this](auto& v, Index i) { return v.segment(Eigen::Index{i} * dim, dim); };
  if (is_lumped()) {
    parallel_for(static_cast<std::size_t>(nodal.size()), nodes_per_chunk,
                 [&](std::size_t first, std::size_t last) {
                   for (auto i = static_cast<Index>(first); i < static_cast<Index>(last); ++i)
                     node(y, i) = nodal[i] * node(x, i);
                 });
    return;
  }
  dim == 3 ? multiply_slots<3>(*this, entry, x, y) : multiply_slots<2>(*this, entry, x, y);
}

void MassMatrix::multiply(const VectorX& x, VectorX& y) const {
  multiply_with([](double m) { return m; }, x, y);
}

void MassMatrix::multiply_magnitude(const VectorX& x, VectorX& y) const {
  multiply_with([](double m) { return std::abs(m); }, x, y);
}

void MassMatrix::add_to(double factor, BlockMatrix& A) const {
  const int block_size = dim * dim;
  const auto add_scaled_identity = [&](Offset slot, double mass) {
    double* block = A.values.data() + slot * block_size;
    for (int k = 0; k < dim; ++k) block[k * (dim + 1)] += factor * mass;
  };
  if (is_lumped()) {
    parallel_for(static_cast<std::size_t>(nodal.size()), nodes_per_chunk,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t i = first; i < last; ++i)
                     add_scaled_identity(A.pattern->row_begin[i], nodal[static_cast<Eigen::Index>(i)]);
                 });
    return;
  }
  parallel_for(slots.size(), slots_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) add_scaled_identity(static_cast<Offset>(s), slots[s]);
  });
}

MassMatrix MassMatrix::times(double factor) const {
  MassMatrix product = *this;
  product.nodal *= factor;
  for (double& slot : product.slots) slot *= factor;
  return product;
}

void MassMatrix::add_slopes(const VectorX& w, const VectorX& y, VectorX& slopes) const {
  const auto node = [this](const VectorX& v, Index i) { return v.segment(Eigen::Index{i} * dim, dim); };
  if (is_lumped()) {
    for (Index i = 0; i < static_cast<Index>(nodal.size()); ++i) slopes[i] += node(w, i).dot(node(y, i));
    return;
  }
  for (Index i = 0; i < pattern->num_nodes(); ++i)
    for (Offset s = pattern->row_begin[static_cast<std::size_t>(i)];
         s < pattern->row_begin[static_cast<std::size_t>(i) + 1]; ++s) {
      const Index j = pattern->columns[static_cast<std::size_t>(s)];
      slopes[s] += node(w, i).dot(node(y, j));
      if (j != i) slopes[s] += node(w, j).dot(node(y, i));
    }
}

void MassMatrix::add_change(const VectorX& entries, const VectorX& y, VectorX& out) const {
  MassMatrix change{.dim = dim, .nodal = {}, .pattern = pattern, .slots = {}};
  if (is_lumped())
    change.nodal = entries;
  else
    change.slots.assign(entries.begin(), entries.end());
  VectorX product;
  change.multiply(y, product);
  out += product;
}

void add_cell_masses(MassMatrix& mass, const ElementInfo& element, std::span<const Index> cells,
                     const VectorX& rest_positions, double density, bool is_consistent) {
  constexpr std::size_t cells_per_chunk = 512;
  const auto n = static_cast<std::size_t>(element.num_nodes);
  const bool needs_products = !mass.is_lumped() && is_consistent;
  const std::size_t numbers_per_cell = n + (needs_products ? n * n : 0);  // lumped volumes, then products
  const auto add = [&mass](Index i, Index j, double entry) {
    mass.slots[static_cast<std::size_t>(mass.pattern->slot(std::min(i, j), std::max(i, j)))] += entry;
  };
  const auto integrate = [&](std::size_t first, std::size_t last) {
    ShapeIntegrals integrals(element);
    std::vector<double> X, products(n * n), numbers((last - first) * numbers_per_cell);
    for (std::size_t cell = first; cell < last; ++cell) {
      const std::span of_cell =
          std::span(numbers).subspan((cell - first) * numbers_per_cell, numbers_per_cell);
      cell_positions(element.dim, cells.subspan(cell * n, n), rest_positions, X);
      integrals.of_products(X, products);
      lump(element, products, of_cell.first(n));
      if (needs_products) std::ranges::copy(products, of_cell.subspan(n).begin());
    }
    return numbers;
  };
  parallel_in_order(cells.size() / n, cells_per_chunk, integrate,
                    [&](std::size_t first, const std::vector<double>& numbers) {
                      for (std::size_t k = 0; k * numbers_per_cell < numbers.size(); ++k) {
                        const std::span<const Index> nodes = cells.subspan((first + k) * n, n);
                        const double* lumped = numbers.data() + k * numbers_per_cell;
                        const double* products = lumped + n;
                        for (std::size_t a = 0; a < n; ++a) {
                          mass.nodal[nodes[a]] += density * lumped[a];
                          if (mass.is_lumped()) continue;
                          if (!is_consistent) add(nodes[a], nodes[a], density * lumped[a]);
                          for (std::size_t b = a; b < n && needs_products; ++b)
                            add(nodes[a], nodes[b], density * products[a * n + b]);
                        }
                      }
                    });
}

namespace {

/// Calls `body(nodes, X, products, add)` for each cell, `add(a, b)` being the place of its entry in `mass`.
template <class Body>
void for_each_cell(const CellMasses& of, const MassMatrix& mass, ShapeIntegrals& integrals,
                   const Body& body) {
  const auto n = static_cast<std::size_t>(of.element.num_nodes);
  std::vector<double> X, products(n * n);
  for (std::size_t first = 0; first < of.cells.size(); first += n) {
    const std::span<const Index> nodes = of.cells.subspan(first, n);
    cell_positions(of.element.dim, nodes, of.rest_positions, X);
    integrals.of_products(X, products);
    const auto place = [&](std::size_t a, std::size_t b) {
      if (mass.is_lumped()) return Eigen::Index{nodes[a]};
      const auto [row, column] = std::minmax({nodes[a], nodes[b]});
      return Eigen::Index{mass.pattern->slot(row, column)};
    };
    body(nodes, X, products, place);
  }
}

}  // namespace

void CellMasses::add_change(const MassMatrix& mass, double density_change, const VectorX& rest_change,
                            VectorX& entries) const {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  std::vector<double> dX, d_products(n * n), c(n), slopes(n * n);
  for_each_cell(*this, mass, integrals,
                [&](std::span<const Index> nodes, const std::vector<double>& X,
                    const std::vector<double>& products, const auto& place) {
                  std::ranges::fill(d_products, 0.0);
                  if (rest_change.size() > 0) {
                    cell_positions(element.dim, nodes, rest_change, dX);
                    integrals.add_change_of_products(X, dX, d_products);
                  }
                  for (std::size_t i = 0; i < n * n; ++i)
                    d_products[i] = density * d_products[i] + density_change * products[i];
                  if (!mass.is_lumped() && is_consistent) {
                    for (std::size_t a = 0; a < n; ++a)
                      for (std::size_t b = a; b < n; ++b) entries[place(a, b)] += d_products[a * n + b];
                    return;
                  }
                  // Lumped volumes are of first degree in the products, and so is their slope of degree 0.
                  for (std::size_t a = 0; a < n; ++a) {
                    std::ranges::fill(c, 0.0);
                    c[a] = 1;
                    lump_slopes(element, products, c, slopes);
                    for (std::size_t i = 0; i < n * n; ++i) entries[place(a, a)] += slopes[i] * d_products[i];
                  }
                });
}

double CellMasses::add_slopes(const MassMatrix& mass, const VectorX& entry_slopes,
                              VectorX& rest_slopes) const {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  std::vector<double> by_products(n * n), c(n), by_X(n * static_cast<std::size_t>(element.dim));
  double by_density = 0;
  for_each_cell(*this, mass, integrals,
                [&](std::span<const Index> nodes, const std::vector<double>& X,
                    const std::vector<double>& products, const auto& place) {
                  if (!mass.is_lumped() && is_consistent) {
                    for (std::size_t a = 0; a < n; ++a)
                      for (std::size_t b = 0; b < n; ++b)
                        by_products[a * n + b] = b < a ? 0 : entry_slopes[place(a, b)];
                  } else {
                    for (std::size_t a = 0; a < n; ++a) c[a] = entry_slopes[place(a, a)];
                    lump_slopes(element, products, c, by_products);
                  }
                  for (std::size_t i = 0; i < n * n; ++i) by_density += by_products[i] * products[i];
                  if (rest_slopes.size() == 0) return;
                  std::ranges::fill(by_X, 0.0);
                  integrals.add_slopes_of_products(X, by_products, by_X);
                  add_cell_values(element.dim, nodes, density, by_X, rest_slopes);
                });
  return by_density;
}

}  // namespace resilin
