#include "resilin/sensitivity/earlier_solutions.hpp"

#include <algorithm>
#include <utility>

namespace resilin {

// By differences of first, second ... order, which hold what each solution adds to those after it: the
// solutions themselves are all but parallel.
VectorX EarlierSolutions::nearest(const BlockMatrix& A, const VectorX& b) const {
  std::vector<VectorX> basis = solutions_;
  for (std::size_t order = 1; order < basis.size(); ++order)
    for (std::size_t k = basis.size() - 1; k >= order; --k) basis[k] -= basis[k - 1];
  const auto size = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd products(size, size);
  VectorX right(size), image;
  for (Eigen::Index k = 0; k < size; ++k) {
    VectorX& direction = basis[static_cast<std::size_t>(k)];
    const double length = direction.norm();
    if (length > 0) direction /= length;
    multiply(A, direction, image);
    for (Eigen::Index i = 0; i <= k; ++i)
      products(i, k) = products(k, i) = basis[static_cast<std::size_t>(i)].dot(image);
    right[k] = direction.dot(b);
  }
  if (size == 0) return {};
  const VectorX shares = products.completeOrthogonalDecomposition().solve(right);
  // Minimum of the energy p.A p / 2 - b.p, which nothing leaves at zero.
  if (!shares.allFinite() || !(0.5 * shares.dot(products * shares) < right.dot(shares))) return {};
  VectorX found = VectorX::Zero(b.size());
  for (Eigen::Index k = 0; k < size; ++k) found += shares[k] * basis[static_cast<std::size_t>(k)];
  return found;
}

void EarlierSolutions::take(VectorX solution) {
  if (solutions_.size() < most_kept) solutions_.emplace_back();
  std::ranges::rotate(solutions_, solutions_.end() - 1);
  solutions_.front() = std::move(solution);
}

}  // namespace resilin
