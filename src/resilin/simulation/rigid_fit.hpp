#pragma once

#include "resilin/world/world.hpp"

namespace resilin {

/// The rotation R with the largest sum of t . R r, from A = sum of t r^T in 2D or 3D.
Eigen::MatrixXd nearest_rotation(const Eigen::MatrixXd& A);

/// Whether no unknown of a body is fixed; vertices that no cell uses aside.
bool is_free(const World& world, const Body& body, std::span<const std::uint8_t> is_fixed);

/// Bodies in the shapes that they have in `shape`, each moved as a rigid one to where it is nearest to
/// `target`, in the measure of the mass: there inertia, which alone acts on a free body as a whole, is
/// balanced. Such as are not free stand as in x.
VectorX rigidly_fitted(const World& world, std::span<const std::uint8_t> is_fixed, const VectorX& shape,
                       const VectorX& target, const VectorX& x);

}  // namespace resilin
