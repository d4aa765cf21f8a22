#include "resilin/mesh/node_gradients.hpp"

#include <algorithm>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 256;

/// int dN_b/dX dV over a cell for each of its nodes, and the cell's volume.
struct CellIntegrals {
  std::vector<Vector3> gradients;
  double volume = 0;
};

CellIntegrals integrate(const ElementInfo& element, std::span<const double> rest_positions) {
  CellIntegrals integrals{std::vector<Vector3>(static_cast<std::size_t>(element.num_nodes), Vector3::Zero())};
  const auto dim = static_cast<std::size_t>(element.dim);
  for (const QuadraturePoint& point : element.quadrature("", "").points) {
    const PointGeometry geometry = point_geometry(element, point, rest_positions);
    integrals.volume += geometry.weight;
    for (std::size_t b = 0; b < integrals.gradients.size(); ++b)
      for (std::size_t k = 0; k < dim; ++k)
        integrals.gradients[b][static_cast<Eigen::Index>(k)] +=
            geometry.weight * geometry.gradients[b * dim + k];
  }
  return integrals;
}

}  // namespace

NodeGradients::NodeGradients(const ElementInfo& element, std::span<const Index> cells,
                             const VectorX& rest_positions, std::span<const Index> nodes)
    : dim_(element.dim), first_(nodes.size() + 1, 0) {
  struct Entry {
    Index node, neighbor;
    Vector3 gradient;
  };
  std::vector<Index> wanted(static_cast<std::size_t>(rest_positions.size() / dim_), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    wanted[static_cast<std::size_t>(nodes[i])] = static_cast<Index>(i);

  std::vector<Entry> entries;
  std::vector<double> volumes(nodes.size(), 0.0), corners;
  const auto width = static_cast<std::size_t>(element.num_nodes);
  for (std::size_t first = 0; first < cells.size(); first += width) {
    const auto cell = cells.subspan(first, width);
    if (std::ranges::none_of(cell, [&](Index node) { return wanted[static_cast<std::size_t>(node)] >= 0; }))
      continue;
    corners.clear();
    for (const Index node : cell)
      for (int i = 0; i < dim_; ++i) corners.push_back(rest_positions[Eigen::Index{node} * dim_ + i]);
    const CellIntegrals integrals = integrate(element, corners);
    for (const Index node : cell) {
      const Index a = wanted[static_cast<std::size_t>(node)];
      if (a < 0) continue;
      volumes[static_cast<std::size_t>(a)] += integrals.volume;
      for (std::size_t b = 0; b < width; ++b) entries.push_back({a, cell[b], integrals.gradients[b]});
    }
  }
  std::ranges::stable_sort(entries, [](const Entry& a, const Entry& b) {
    return a.node != b.node ? a.node < b.node : a.neighbor < b.neighbor;
  });
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Entry& entry = entries[i];
    const Vector3 share = entry.gradient / volumes[static_cast<std::size_t>(entry.node)];
    const bool is_repeated =
        i > 0 && entries[i - 1].node == entry.node && entries[i - 1].neighbor == entry.neighbor;
    if (is_repeated) {
      gradients_.back() += share;
    } else {
      neighbors_.push_back(entry.neighbor);
      gradients_.push_back(share);
      first_[static_cast<std::size_t>(entry.node) + 1] = neighbors_.size();
    }
  }
}

void NodeGradients::evaluate(const VectorX& x, std::span<Matrix<3>> F) const {
  parallel_for(F.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      F[a].setZero();
      for (std::size_t i = first_[a]; i < first_[a + 1]; ++i)
        F[a].topRows(dim_) += x.segment(Eigen::Index{neighbors_[i]} * dim_, dim_) * gradients_[i].transpose();
    }
  });
}

}  // namespace resilin
