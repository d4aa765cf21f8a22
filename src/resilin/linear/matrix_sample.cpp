#include "resilin/linear/matrix_sample.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 2048;

/// The diagonal of a node's diagonal block, then a row of the next block, or zeros.
template <int dim>
void read_sample(const BlockMatrix& A, std::size_t node, double scale, float* numbers) {
  const Offset begin = A.pattern->row_begin[node];
  const bool has_next = A.pattern->row_begin[node + 1] > begin + 1;
  const double *diagonal = A.block(begin), *next = diagonal + dim * dim;
  for (int d = 0; d < dim; ++d) {
    numbers[d] = static_cast<float>(scale * diagonal[d * (dim + 1)]);
    numbers[dim + d] = has_next ? static_cast<float>(scale * next[d]) : 0.0F;
  }
}

template <int dim>
bool nodes_are_near(const BlockMatrix& A, double scale, double share, const float* numbers, std::size_t begin,
                    std::size_t end) {
  for (std::size_t node = begin; node < end; ++node) {
    float now[2 * dim], largest = 0, change = 0;
    read_sample<dim>(A, node, scale, now);
    const float* const before = numbers + node * 2 * dim;
    for (int d = 0; d < dim; ++d) largest = std::max(largest, before[d]);
    for (int k = 0; k < 2 * dim; ++k) change = std::max(change, std::abs(now[k] - before[k]));
    if (!(change <= static_cast<float>(share) * largest)) return false;
  }
  return true;
}

}  // namespace

void MatrixSample::take(const BlockMatrix& A) {
  pattern_ = A.pattern;
  const auto num_nodes = static_cast<std::size_t>(A.num_nodes());
  numbers_.resize(2 * num_nodes * static_cast<std::size_t>(A.dim));
  struct Largest {
    double value = 0;
    void operator+=(const Largest& other) { value = std::max(value, other.value); }
  };
  const double largest =
      parallel_sum<Largest>(num_nodes, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
        Largest part;
        for (std::size_t node = begin; node < end; ++node)
          for (int d = 0; d < A.dim; ++d) part += {A.block(A.pattern->row_begin[node])[d * (A.dim + 1)]};
        return part;
      }).value;
  scale_ = largest > 0 ? 1 / largest : 1;
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node)
      A.dim == 3 ? read_sample<3>(A, node, scale_, &numbers_[6 * node])
                 : read_sample<2>(A, node, scale_, &numbers_[4 * node]);
  });
}

bool MatrixSample::is_near(const BlockMatrix& A, double share) const {
  if (pattern_ == nullptr || pattern_ != A.pattern) return false;
  struct AllNear {
    bool are_near = true;
    void operator+=(const AllNear& other) { are_near = are_near && other.are_near; }
  };
  return parallel_sum<AllNear>(
             static_cast<std::size_t>(A.num_nodes()), nodes_per_chunk,
             [&](std::size_t begin, std::size_t end) {
               return AllNear{A.dim == 3 ? nodes_are_near<3>(A, scale_, share, numbers_.data(), begin, end)
                                         : nodes_are_near<2>(A, scale_, share, numbers_.data(), begin, end)};
             })
      .are_near;
}

}  // namespace resilin
