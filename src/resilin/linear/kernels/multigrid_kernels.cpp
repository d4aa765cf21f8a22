// Inner loops of the multigrid, compiled like block_kernels.cpp and under the same rule: nothing of the
// standard library or of Eigen.
#include "resilin/linear/kernels/multigrid_kernels.hpp"

#include "resilin/linear/kernels/float_lanes.hpp"

namespace resilin::detail {
namespace {

using namespace RESILIN_SIMD_NAMESPACE;

/// to = block * x, its padding zero.
template <int size>
RESILIN_INLINE void multiply_block(const float* block, const float* x, float* to) {
  constexpr int lanes = lanes_of(size);
  const Lane<lanes> v = load<lanes>(x);
  float result[lanes] = {};
  for (int r = 0; r < size; ++r) result[r] = sum_of<size>(load<lanes>(block + r * size) * v);
  store<lanes>(to, load<lanes>(result));
}

/// sum[r] += (block * x)[r], the lanes not yet added up.
template <int size>
RESILIN_INLINE void accumulate_block(const float* block, const float* x, Lane<lanes_of(size)>* sum) {
  constexpr int lanes = lanes_of(size);
  const Lane<lanes> v = load<lanes>(x);
  for (int r = 0; r < size; ++r) sum[r] += load<lanes>(block + r * size) * v;
}

/// block^T * x.
template <int size>
RESILIN_INLINE Lane<lanes_of(size)> multiply_transposed(const float* block, const float* x) {
  constexpr int lanes = lanes_of(size);
  Lane<lanes> sum = load<lanes>(block) * x[0];
  for (int r = 1; r < size; ++r) sum += load<lanes>(block + r * size) * x[r];
  return sum;
}

template <int size>
void sweep_forward(const LevelView& level, NodeRange nodes, float* r, float* x) {
  constexpr int lanes = lanes_of(size), block_size = size * size;
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    float x_i[lanes];
    multiply_block<size>(level.inverse_diagonal + i * block_size, r + i * lanes, x_i);
    store<lanes>(x + i * lanes, load<lanes>(x_i));
    for (int64_t k = level.row_begin[i]; k < level.row_begin[i + 1]; ++k) {
      float* r_j = r + int64_t(level.columns[k]) * lanes;
      store<lanes>(r_j, load<lanes>(r_j) - multiply_transposed<size>(level.upper + k * block_size, x_i));
    }
  }
}

/// The product of an upper row with x, by component.
template <int size>
RESILIN_INLINE void multiply_upper_row(const LevelView& level, int64_t row, const float* x, float* result) {
  constexpr int lanes = lanes_of(size), block_size = size * size;
  Lane<lanes> sum[size] = {};
  for (int64_t k = level.row_begin[row]; k < level.row_begin[row + 1]; ++k)
    accumulate_block<size>(level.upper + k * block_size, x + int64_t(level.columns[k]) * lanes, sum);
  for (int c = 0; c < size; ++c) result[c] = sum_of<size>(sum[c]);
}

template <int size>
void negate_upper(const LevelView& level, NodeRange nodes, const float* x, float* r) {
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    float product[size];
    multiply_upper_row<size>(level, i, x, product);
    for (int c = 0; c < size; ++c) r[i * lanes_of(size) + c] = -product[c];
  }
}

template <int size>
void subtract_lower(const LevelView& level, NodeRange nodes, const float* x, float* b) {
  constexpr int lanes = lanes_of(size), block_size = size * size;
  for (int64_t i = nodes.first; i < nodes.last; ++i)
    for (int64_t k = level.row_begin[i]; k < level.row_begin[i + 1]; ++k) {
      float* b_j = b + int64_t(level.columns[k]) * lanes;
      store<lanes>(b_j,
                   load<lanes>(b_j) - multiply_transposed<size>(level.upper + k * block_size, x + i * lanes));
    }
}

template <int size>
void sweep_backward(const LevelView& level, NodeRange nodes, const float* b, float* x) {
  constexpr int lanes = lanes_of(size), block_size = size * size;
  for (int64_t i = int64_t(nodes.last) - 1; i >= nodes.first; --i) {
    float product[size], rest[lanes] = {};
    multiply_upper_row<size>(level, i, x, product);
    for (int c = 0; c < size; ++c) rest[c] = b[i * lanes + c] - product[c];
    multiply_block<size>(level.inverse_diagonal + i * block_size, rest, x + i * lanes);
  }
}

template <int size>
void multiply_add(const LevelView& level, NodeRange nodes, const float* x, float* y) {
  constexpr int lanes = lanes_of(size), block_size = size * size;
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    const float* x_i = x + i * lanes;
    Lane<lanes> sum[size] = {};
    accumulate_block<size>(level.diagonal + i * block_size, x_i, sum);
    for (int64_t k = level.row_begin[i]; k < level.row_begin[i + 1]; ++k) {
      const int64_t j = level.columns[k];
      accumulate_block<size>(level.upper + k * block_size, x + j * lanes, sum);
      float* y_j = y + j * lanes;
      store<lanes>(y_j, load<lanes>(y_j) + multiply_transposed<size>(level.upper + k * block_size, x_i));
    }
    for (int c = 0; c < size; ++c) y[i * lanes + c] += sum_of<size>(sum[c]);
  }
}

template <int size>
void apply_inverse_diagonal(const LevelView& level, NodeRange nodes, const float* r, float* x) {
  constexpr int lanes = lanes_of(size), block_size = size * size;
  for (int64_t i = nodes.first; i < nodes.last; ++i)
    multiply_block<size>(level.inverse_diagonal + i * block_size, r + i * lanes, x + i * lanes);
}

template <int fine, int coarse>
void restrict_add(const TransferView& transfer, NodeRange nodes, const float* from, float* to) {
  constexpr int fine_lanes = lanes_of(fine), lanes = lanes_of(coarse);
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    float scaled[fine];
    for (int r = 0; r < fine; ++r) scaled[r] = transfer.blocks.scales[i] * from[i * fine_lanes + r];
    for (int64_t k = transfer.row_begin[i]; k < transfer.row_begin[i + 1]; ++k) {
      const int16_t* block = transfer.blocks.numbers + k * fine * coarse;
      float* target = to + int64_t(transfer.columns[k]) * lanes;
      Lane<lanes> sum = load<lanes>(target);
      for (int r = 0; r < fine; ++r) sum += load<lanes>(block + r * coarse) * scaled[r];
      store<lanes>(target, sum);
    }
  }
}

template <int fine, int coarse>
void prolong_add(const TransferView& transfer, NodeRange nodes, const float* from, float* to) {
  constexpr int fine_lanes = lanes_of(fine), lanes = lanes_of(coarse);
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    Lane<lanes> sum[fine] = {};
    for (int64_t k = transfer.row_begin[i]; k < transfer.row_begin[i + 1]; ++k) {
      const Lane<lanes> x = load<lanes>(from + int64_t(transfer.columns[k]) * lanes);
      for (int r = 0; r < fine; ++r)
        sum[r] += load<lanes>(transfer.blocks.numbers + (k * fine + r) * coarse) * x;
    }
    for (int r = 0; r < fine; ++r)
      to[i * fine_lanes + r] += transfer.blocks.scales[i] * sum_of<coarse>(sum[r]);
  }
}

template <class Place>
RESILIN_INLINE const Place* places_in(const PlacesView& places) {
  if constexpr (sizeof(Place) == 1)
    return places.narrow;
  else
    return places.wide;
}

/// Calls visit<is_transposed>(block, column) for the entries of a row of A, columns ascending.
template <class Place, int size, class Visit>
RESILIN_INLINE void for_row(const LevelView& level, const TransferView& transfer, int64_t row,
                            const Visit& visit) {
  constexpr int block_size = size * size;
  for (int64_t k = transfer.lower_begin[row]; k < transfer.lower_begin[row + 1]; ++k) {
    const int64_t column = transfer.lower_columns[k];
    visit.template operator()<true>(
        level.upper + (level.row_begin[column] + places_in<Place>(transfer.lower_places)[k]) * block_size,
        column);
  }
  visit.template operator()<false>(level.diagonal + row * block_size, row);
  for (int64_t k = level.row_begin[row]; k < level.row_begin[row + 1]; ++k)
    visit.template operator()<false>(level.upper + k * block_size, int64_t(level.columns[k]));
}

/// Rows of a block of size x coarse, their scale apart.
template <int size, int coarse>
RESILIN_INLINE void load_rows(const ShortNumbers& all, int64_t block, Lane<lanes_of(coarse)>* rows) {
  for (int k = 0; k < size; ++k) rows[k] = load<lanes_of(coarse)>(all.numbers + (block * size + k) * coarse);
}

/// to += block * B or block^T * B for a block of size x size and B of size x coarse by rows; those of `to`
/// are padded.
template <int size, int coarse, bool is_transposed>
RESILIN_INLINE void add_product(const float* block, const Lane<lanes_of(coarse)>* rows, float* to) {
  constexpr int lanes = lanes_of(coarse);
  constexpr int row_stride = is_transposed ? 1 : size, column_stride = is_transposed ? size : 1;
  for (int r = 0; r < size; ++r) {
    Lane<lanes> sum = load<lanes>(to + r * lanes);
    for (int k = 0; k < size; ++k) sum += rows[k] * block[r * row_stride + k * column_stride];
    store<lanes>(to + r * lanes, sum);
  }
}

template <class Place, int fine, int coarse>
void smooth_prolongation(const LevelView& level, const TransferView& transfer, NodeRange nodes, float damping,
                         float* row_work) {
  constexpr int lanes = lanes_of(coarse), block_size = fine * coarse, work_size = fine * lanes;
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    const int64_t begin = transfer.row_begin[i], end = transfer.row_begin[i + 1];
    for (int64_t k = 0; k < (end - begin) * work_size; ++k) row_work[k] = 0;
    const Place* place =
        places_in<Place>(transfer.smoothing_places) + transfer.lower_begin[i] + i + level.row_begin[i];
    const int own_place = place[transfer.lower_begin[i + 1] - transfer.lower_begin[i]];
    for_row<Place, fine>(level, transfer, i, [&]<bool is_transposed>(const float* block, int64_t j) {
      const Place here = *place++;
      if (here == Place(-1)) return;
      Lane<lanes> T[fine];
      load_rows<fine, coarse>(transfer.tentative, j, T);
      for (int r = 0; r < fine; ++r) T[r] *= transfer.tentative.scales[j];
      add_product<fine, coarse, is_transposed>(block, T, row_work + here * work_size);
    });
    for (int64_t k = 0; k < end - begin; ++k) {  // P_i = T_i - damping D_i^-1 (A T)_i, without padding
      Lane<lanes> AT[fine], T[fine] = {};
      for (int r = 0; r < fine; ++r) AT[r] = load<lanes>(row_work + k * work_size + r * lanes);
      float smoothed[work_size] = {};
      add_product<fine, coarse, false>(level.inverse_diagonal + i * fine * fine, AT, smoothed);
      if (k == own_place) load_rows<fine, coarse>(transfer.tentative, i, T);
      for (int r = 0; r < fine; ++r)
        store_row<coarse>(row_work + (k * fine + r) * coarse,
                          T[r] * transfer.tentative.scales[i] - load<lanes>(smoothed + r * lanes) * damping);
    }
    transfer.blocks.scales[i] =
        shorten(row_work, (end - begin) * block_size, transfer.blocks.numbers + begin * block_size);
  }
}

/// Adds the transpose of a block of P times a block of A P, its rows padded, to a block of the coarse matrix.
template <int fine, int coarse>
RESILIN_INLINE void add_transposed_product(const float* P, const float* AP, float* to) {
  constexpr int lanes = lanes_of(coarse);
  Lane<lanes> rows[fine];
  for (int r = 0; r < fine; ++r) rows[r] = load<lanes>(AP + r * lanes);
  for (int c = 0; c < coarse; ++c) {
    Lane<lanes> row = load<lanes>(to + c * coarse);
    for (int r = 0; r < fine; ++r) row += rows[r] * P[r * coarse + c];
    store_row<coarse>(to + c * coarse, row);
  }
}

template <class Place, int fine, int coarse>
void galerkin_product(const LevelView& level, const TransferView& transfer, NodeRange nodes, float* row_work,
                      int32_t* place_of, CoarseView to) {
  constexpr int lanes = lanes_of(coarse), block_size = fine * coarse, work_size = fine * lanes;
  int32_t first_place =
      0;  // first place of the row's columns, counted through all rows: places of rows before are less
  for (int64_t i = nodes.first; i < nodes.last; ++i) {
    const Place* target = places_in<Place>(transfer.coarse_places) + transfer.target_begin[i];
    int32_t width = 0;
    for_row<Place, fine>(level, transfer, i, [&]<bool is_transposed>(const float* block, int64_t j) {
      float scaled[fine * fine];
      for (int n = 0; n < fine * fine; ++n) scaled[n] = block[n] * transfer.blocks.scales[j];
      for (int64_t k = transfer.row_begin[j]; k < transfer.row_begin[j + 1]; ++k) {  // row i of A P
        int32_t& place = place_of[transfer.columns[k]];
        if (place < first_place) {
          place = first_place + width++;
          for (int n = 0; n < work_size; ++n) row_work[(place - first_place) * work_size + n] = 0;
        }
        Lane<lanes> P[fine];
        load_rows<fine, coarse>(transfer.blocks, k, P);
        add_product<fine, coarse, is_transposed>(scaled, P, row_work + (place - first_place) * work_size);
      }
    });
    first_place += width;
    for (int64_t k = transfer.row_begin[i]; k < transfer.row_begin[i + 1]; ++k) {  // P_i^T (A P)_i
      const int64_t group = transfer.columns[k];
      float P[block_size];
      for (int n = 0; n < block_size; ++n)
        P[n] = transfer.blocks.scales[i] * float(transfer.blocks.numbers[k * block_size + n]);
      float* diagonal = to.diagonal + group * coarse * coarse;
      float* upper = to.upper + (to.row_begin[group] - 2) * coarse * coarse;
      for (int column = 0; column < width; ++column) {
        const int64_t coarse_place = *target++;
        if (coarse_place == 0) continue;
        add_transposed_product<fine, coarse>(
            P, row_work + column * work_size,
            coarse_place == 1 ? diagonal : upper + coarse_place * coarse * coarse);
      }
    }
  }
}

#define RESILIN_BY_LEVEL(kernel)                     \
  {                                                  \
    {kernel<2>, kernel<3>}, { kernel<3>, kernel<6> } \
  }
#define RESILIN_BY_PLACES(kernel)                                                                           \
  {                                                                                                         \
      {{kernel<uint8_t, 2, 3>, kernel<uint8_t, 3, 3>}, {kernel<uint8_t, 3, 6>, kernel<uint8_t, 6, 6>}},     \
      {{kernel<uint16_t, 2, 3>, kernel<uint16_t, 3, 3>}, {kernel<uint16_t, 3, 6>, kernel<uint16_t, 6, 6>}}, \
  }
#define RESILIN_BY_TRANSFER(kernel)                              \
  {                                                              \
    {kernel<2, 3>, kernel<3, 3>}, { kernel<3, 6>, kernel<6, 6> } \
  }

constexpr MultigridKernels kernels = {
    RESILIN_BY_LEVEL(sweep_forward),
    RESILIN_BY_LEVEL(sweep_backward),
    RESILIN_BY_LEVEL(negate_upper),
    RESILIN_BY_LEVEL(subtract_lower),
    RESILIN_BY_LEVEL(multiply_add),
    RESILIN_BY_LEVEL(apply_inverse_diagonal),
    RESILIN_BY_TRANSFER(restrict_add),
    RESILIN_BY_TRANSFER(prolong_add),
    shorten,
    RESILIN_BY_PLACES(smooth_prolongation),
    RESILIN_BY_PLACES(galerkin_product),
};

}  // namespace

template <InstructionSet>
const MultigridKernels& compiled_multigrid_kernels() {
  return kernels;
}
template const MultigridKernels& compiled_multigrid_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>();

}  // namespace resilin::detail
