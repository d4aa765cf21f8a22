// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/collision/kernels/box_kernels.hpp"

#include "resilin/core/simd_intrinsics.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

/// Eight numbers, in registers of the instruction set.
struct Floats {
  static constexpr int num_registers = RESILIN_SIMD_WIDTH == 2 ? 2 : 1;
  using Register = float __attribute__((vector_size(32 / num_registers), may_alias));

  Register v[num_registers];

  static RESILIN_INLINE Floats load(const float* p) {
    Floats x;
    __builtin_memcpy(x.v, p, sizeof x.v);
    return x;
  }
  static RESILIN_INLINE Floats all(float number) {
    Floats x;
    for (Register& part : x.v) part = number - Register{};
    return x;
  }
  RESILIN_INLINE void store(float* p) const { __builtin_memcpy(p, v, sizeof v); }
};

RESILIN_INLINE Floats lesser(Floats a, const Floats& b) {
  for (int k = 0; k < Floats::num_registers; ++k) a.v[k] = a.v[k] < b.v[k] ? a.v[k] : b.v[k];
  return a;
}
RESILIN_INLINE Floats no_box() { return Floats::all(__builtin_inff()); }

/// A float that is not above x: 1.2e-7 of it is two roundings, the last number serves near zero.
RESILIN_INLINE float not_above(double x) {
  const float rounded = static_cast<float>(x);
  return rounded - (__builtin_fabsf(rounded) * 1.2e-7F + 1e-37F);
}

std::size_t enclose_vertices(const MovingPoint* points, std::size_t begin, std::size_t end,
                             const double origin[3], double margin, BoxRow* rows) {
  std::size_t bad = end;
  for (std::size_t v = begin; v < end; ++v) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double x = points[v].x[i], y = x + points[v].p[i];
      const double low = x < y ? x : y, high = x < y ? y : x;
      const double size = __builtin_fabs(low) + __builtin_fabs(high);
      const double out =
          margin + 1e-15 * (size + __builtin_fabs(origin[i]));  // bounds the rounding of these sums
      sum += size;
      rows[v].bounds[i] = not_above(low - origin[i] - out);
      rows[v].bounds[4 + i] = not_above(origin[i] - high - out);
    }
    rows[v].bounds[3] = rows[v].bounds[7] = 0;
    if (!(sum < 1e30) && bad == end) bad = v;
  }
  return bad;
}

RESILIN_INLINE void store_column(const Floats& box, std::size_t column, BoxBlock& block) {
  float bounds[8];
  box.store(bounds);
  for (std::size_t i = 0; i < 3; ++i) {
    block.rows[i][column] = bounds[i];
    block.rows[3 + i][column] = bounds[4 + i];
  }
}

template <std::size_t vertices_per_part>
RESILIN_INLINE void enclose(const std::int32_t* vertices, const BoxRow* vertex_rows, std::size_t begin,
                            std::size_t end, BoxBlock* blocks, BoxRow* around) {
  for (std::size_t b = begin; b < end; ++b) {
    Floats all = no_box();
    for (std::size_t i = 0; i < boxes_per_block; ++i) {
      const std::int32_t* part = vertices + b * vertices_per_part * boxes_per_block + i;
      Floats box = no_box();
      if (part[0] >= 0)
        for (std::size_t k = 0; k < vertices_per_part; ++k)
          box = lesser(box, Floats::load(vertex_rows[part[k * boxes_per_block]].bounds));
      all = lesser(all, box);
      store_column(box, i, blocks[b]);
    }
    all.store(around[b].bounds);
  }
}

void enclose_parts(const std::int32_t* vertices, int vertices_per_part, const BoxRow* vertex_rows,
                   std::size_t begin, std::size_t end, BoxBlock* blocks, BoxRow* around) {
  if (vertices_per_part == 1) enclose<1>(vertices, vertex_rows, begin, end, blocks, around);
  if (vertices_per_part == 2) enclose<2>(vertices, vertex_rows, begin, end, blocks, around);
  if (vertices_per_part == 3) enclose<3>(vertices, vertex_rows, begin, end, blocks, around);
}

void enclose_blocks(const BoxRow* below, std::size_t count, BoxBlock* blocks, BoxRow* around) {
  for (std::size_t b = 0; b * boxes_per_block < count; ++b) {
    Floats all = no_box();
    for (std::size_t i = 0; i < boxes_per_block; ++i) {
      const std::size_t child = b * boxes_per_block + i;
      const Floats box = child < count ? Floats::load(below[child].bounds) : no_box();
      all = lesser(all, box);
      store_column(box, i, blocks[b]);
    }
    all.store(around[b].bounds);
  }
}

/// The largest rows that a box may have to meet this one.
struct Bounds {
  Floats rows[6];

  RESILIN_INLINE Bounds(const BoxBlock& block, std::size_t column) {
    for (std::size_t i = 0; i < 6; ++i) rows[i] = Floats::all(-block.rows[i < 3 ? i + 3 : i - 3][column]);
  }
};

/// Registers of whole numbers: all bits of one set where something holds for a box.
using Truth = decltype(Floats::Register{} < Floats::Register{});

/// One bit for each box of a block.
RESILIN_INLINE unsigned bits_of(const Truth holds[Floats::num_registers]) {
  unsigned bits = 0;
  for (int k = 0; k < Floats::num_registers; ++k) {
#if defined(__AVX2__) && RESILIN_SIMD_WIDTH >= 4
    bits |= static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(holds[k])));
#elif defined(__SSE2__) && RESILIN_SIMD_WIDTH == 2
    bits |= static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(holds[k]))) << (4 * k);
#else
    constexpr unsigned width = boxes_per_block / Floats::num_registers;
    for (unsigned i = 0; i < width; ++i)
      bits |= (holds[k][i] != 0 ? 1U : 0U) << (width * static_cast<unsigned>(k) + i);
#endif
  }
  return bits;
}

/// A condition on each box of a block.
struct Columns {
  Truth holds[Floats::num_registers];

  /// Those that meet the box with these bounds.
  RESILIN_INLINE Columns(const BoxBlock& block, const Bounds& bounds) {
    for (int k = 0; k < Floats::num_registers; ++k) {
      holds[k] = Floats::load(block.rows[0]).v[k] <= bounds.rows[0].v[k];
      for (int i = 1; i < 6; ++i) holds[k] &= Floats::load(block.rows[i]).v[k] <= bounds.rows[i].v[k];
    }
  }

  /// Leaves out the parts of the second block that share a vertex with part i of the first.
  template <int num_first, int num_second>
  RESILIN_INLINE void leave_out_sharing(const std::int32_t* first, std::size_t i,
                                        const std::int32_t* second) {
    for (int b = 0; b < num_second; ++b) {
      Truth vertices[Floats::num_registers];
      __builtin_memcpy(vertices, second + static_cast<std::size_t>(b) * boxes_per_block, sizeof vertices);
      for (int a = 0; a < num_first; ++a)
        for (int k = 0; k < Floats::num_registers; ++k)
          holds[k] &= vertices[k] != first[static_cast<std::size_t>(a) * boxes_per_block + i];
    }
  }

  RESILIN_INLINE unsigned bits() const { return bits_of(holds); }
};

RESILIN_INLINE std::size_t take_lowest(unsigned& bits) {
  const auto lowest = static_cast<std::size_t>(__builtin_ctz(bits));
  bits &= bits - 1;
  return lowest;
}

/// Two blocks of level 0: which of their boxes meet; of a block with itself each two once.
template <int num_first, int num_second>
RESILIN_INLINE std::uint64_t meeting_bits(const BlockTreeView& first, std::size_t a,
                                          const BlockTreeView& second, std::size_t b, const Bounds& around_b,
                                          bool is_same) {
  std::uint64_t bits = 0;
  for (unsigned rows = Columns(first.blocks[a], around_b).bits(); rows != 0;) {
    const std::size_t i = take_lowest(rows);
    Columns columns(second.blocks[b], Bounds(first.blocks[a], i));
    columns.leave_out_sharing<num_first, num_second>(first.vertices + a * num_first * boxes_per_block, i,
                                                     second.vertices + b * num_second * boxes_per_block);
    const unsigned mask = is_same ? ~((2U << i) - 1) : ~0U;
    bits |= std::uint64_t{columns.bits() & mask} << (boxes_per_block * i);
  }
  return bits;
}

template <int num_first, int num_second>
RESILIN_INLINE void search(const BlockTreeView& first, std::size_t begin, std::size_t end,
                           const BlockTreeView& second, bool is_same, const MeetingView& meetings,
                           const BlockSink& sink) {
  struct Entry {
    int level;
    std::size_t block;
  };
  Entry stack[128];  // at most seven wait on each of the levels, of which 2^31 parts have eleven
  for (std::size_t q = begin; q < end; ++q) {
    const std::size_t parent = first.level_begin[1] + q / boxes_per_block;
    const Bounds around(first.blocks[parent], q % boxes_per_block);
    const std::int32_t body = first.child_bodies[parent * boxes_per_block + q % boxes_per_block];
    const unsigned char* meets = meetings.table + static_cast<std::ptrdiff_t>(body) * meetings.num_bodies;
    std::size_t size = 0;
    stack[size++] = {second.num_levels - 1, 0};
    while (size > 0) {
      const Entry at = stack[--size];
      const std::size_t node = second.level_begin[at.level] + at.block;
      for (unsigned boxes = Columns(second.blocks[node], around).bits(); boxes != 0;) {
        const std::size_t i = take_lowest(boxes), child = at.block * boxes_per_block + i;
        const std::int32_t other = second.child_bodies[node * boxes_per_block + i];
        if (other >= 0 && meets[other] == 0) continue;
        if (is_same && ((child + 1) << (3 * (at.level - 1))) <= q) continue;  // taken from the other side
        if (at.level > 1) {
          stack[size++] = {at.level - 1, child};
        } else {
          const std::uint64_t bits = meeting_bits<num_first, num_second>(
              first, q, second, child, Bounds(second.blocks[node], i), is_same && child == q);
          if (bits != 0) sink.take(sink.state, q, child, bits);
        }
      }
    }
  }
}

void meet(const BlockTreeView& first, std::size_t begin, std::size_t end, const BlockTreeView& second,
          bool is_same, const MeetingView& meetings, const BlockSink& sink) {
  if (first.vertices_per_part == 2) return search<2, 2>(first, begin, end, second, is_same, meetings, sink);
  if (second.vertices_per_part == 2) return search<1, 2>(first, begin, end, second, is_same, meetings, sink);
  search<1, 3>(first, begin, end, second, is_same, meetings, sink);
}

constexpr BoxKernels kernels_of_boxes = {enclose_vertices, enclose_parts, enclose_blocks, meet};

}  // namespace
}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const BoxKernels& compiled_box_kernels() {
  return RESILIN_SIMD_NAMESPACE::kernels_of_boxes;
}
template const BoxKernels& compiled_box_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>();

}  // namespace resilin
