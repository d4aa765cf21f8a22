// Interpolation by an embedding, in every frame.
#include <cstring>
#include <type_traits>

#include "resilin/core/parallel.hpp"
#include "resilin/mesh/embedding.hpp"

namespace resilin {
namespace {

constexpr std::size_t points_per_chunk = 2048;

/// A place in a register: three coordinates and one to spare.
template <class Real>
using Quad = Eigen::Matrix<Real, 4, 1>;

template <class Real>
Quad<Real> quad_of(const double* place, int dim) {
  Quad<Real> quad = Quad<Real>::Zero();
  for (int i = 0; i < dim; ++i) quad[i] = static_cast<Real>(place[i]);
  return quad;
}

/// Writes a place for each point of [begin, end). The spare number lies where the next point comes, but for
/// the last one, behind which is another chunk's.
template <class Real, class PlaceOf>
void store_places(std::size_t begin, std::size_t end, Real* out, const PlaceOf& place_of) {
  for (std::size_t p = begin; p + 1 < end; ++p) {
    const Quad<Real> place = place_of(p);
    std::memcpy(out + 3 * p, place.data(), sizeof(place));
  }
  if (begin == end) return;
  const Quad<Real> place = place_of(end - 1);
  for (std::size_t i = 0; i < 3; ++i) out[3 * (end - 1) + i] = place.data()[i];
}

/// Calls `body` with the number of nodes as a constant, so that its inner loop is unrolled.
template <class Body>
void with_constant_width(std::size_t width, const Body& body) {
  switch (width) {
    case 3:
      return body(std::integral_constant<std::size_t, 3>{});
    case 4:
      return body(std::integral_constant<std::size_t, 4>{});
    default:
      return body(width);
  }
}

}  // namespace

template <class Real>
void Embedding::apply_to(const VectorX& x, std::span<Real> out) const {
  std::vector<Quad<Real>> places(used_nodes_.size());
  for (std::size_t i = 0; i < used_nodes_.size(); ++i)
    places[i] = quad_of<Real>(x.data() + Eigen::Index{used_nodes_[i]} * dim_, dim_);
  std::vector<Quad<Real>> columns;  // columns of F at each used node
  if (gradients_) {
    std::vector<Matrix<3>> F(used_nodes_.size());
    gradients_->evaluate(x, F);
    for (const Matrix<3>& f : F)
      for (int k = 0; k < 3; ++k) columns.push_back(quad_of<Real>(f.col(k).data(), 3));
  }
  with_constant_width(width(), [&](auto width) {
    parallel_for(cell_.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
      const auto linear = [&](std::size_t p) {
        Quad<Real> sum = Quad<Real>::Zero();
        for (std::size_t a = 0; a < width; ++a)
          sum += static_cast<Real>(weights_[p * width + a]) * places[local_[p * width + a]];
        return sum;
      };
      const auto smooth = [&](std::size_t p) {
        Quad<Real> sum = linear(p);
        for (std::size_t a = 0; a < width; ++a) {
          const Vector3& arm = arms_[p * width + a];
          const Quad<Real>* F = columns.data() + 3 * std::size_t{local_[p * width + a]};
          for (int k = 0; k < 3; ++k) sum += static_cast<Real>(arm[k]) * F[k];
        }
        return sum;
      };
      if (gradients_) {
        store_places(begin, end, out.data(), smooth);
      } else {
        store_places(begin, end, out.data(), linear);
      }
    });
  });
}

void Embedding::apply(const VectorX& x, std::span<double> out) const { apply_to<double>(x, out); }
void Embedding::apply(const VectorX& x, std::span<float> out) const { apply_to<float>(x, out); }

void Embedding::interpolate(std::span<const double> values, std::span<float> out) const {
  parallel_for(cell_.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      double sum = 0;
      for (std::size_t i = p * width(); i < (p + 1) * width(); ++i)
        sum += weights_[i] * values[static_cast<std::size_t>(nodes_[i])];
      out[p] = static_cast<float>(sum);
    }
  });
}

}  // namespace resilin
