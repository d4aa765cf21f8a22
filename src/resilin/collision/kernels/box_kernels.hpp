#pragma once

#include <cstddef>
#include <cstdint>

#include "resilin/collision/moving_point.hpp"
#include "resilin/core/instruction_set.hpp"

namespace resilin {

/// Number of boxes in a block, for every instruction set.
constexpr std::size_t boxes_per_block = 8;

/// One box: its least coordinates and the negatives of its largest ones, so that the box around two boxes is
/// the least of each number, and an empty one is all +infinity. Single precision, rounded outwards.
struct alignas(32) BoxRow {
  float bounds[8];  ///< low x, y, z; 0; -high x, y, z; 0
};

/// Eight boxes, one in each column: low x, y, z, -high x, y, z.
struct alignas(64) BoxBlock {
  float rows[6][boxes_per_block];
};

/// A tree of blocks: those of level 0 hold parts of the surface, each box of a block of level l + 1 is around
/// a block of level l. The one block of the last level is the root.
struct BlockTreeView {
  const BoxBlock* blocks;            ///< blocks of all levels
  const std::size_t* level_begin;    ///< number of the first block of each level
  int num_levels;                    ///< at least 2
  const std::int32_t* child_bodies;  ///< [block][box]: the body of all that is in the box, -1 of several
  const std::int32_t* vertices;      ///< vertices of the parts in level 0: [block][vertex of the part][box]
  int vertices_per_part;
};

/// Blocks of the tree that may be in contact, by their bodies: a table of num_bodies x num_bodies.
struct MeetingView {
  const unsigned char* table;
  std::int32_t num_bodies;
};

/// Takes the boxes that meet and whose parts share no vertex: bit 8 i + j for box i of the first block and
/// box j of the second.
struct BlockSink {
  void* state;
  void (*take)(void* state, std::size_t first_block, std::size_t second_block, std::uint64_t bits);
};

struct BoxKernels {
  /// The boxes around the ways of vertices, relative to `origin`, larger by `margin` on all sides. Returns
  /// the first vertex at a place that is no number, or `end`.
  std::size_t (*enclose_vertices)(const MovingPoint*, std::size_t begin, std::size_t end,
                                  const double origin[3], double margin, BoxRow* rows);
  /// Blocks [begin, end) of level 0 from the boxes of the vertices of their parts, which stand as in
  /// BlockTreeView, -1 for a place without a part; and the box around each block.
  void (*enclose_parts)(const std::int32_t* vertices, int vertices_per_part, const BoxRow* vertex_rows,
                        std::size_t begin, std::size_t end, BoxBlock* blocks, BoxRow* around);
  /// A level from the `count` boxes around the blocks of the level below, and the boxes around it.
  void (*enclose_blocks)(const BoxRow* below, std::size_t count, BoxBlock* blocks, BoxRow* around);
  /// For the blocks [begin, end) of level 0 of the first tree all blocks of the second with a box that meets
  /// one of theirs. With `is_same` both trees are one, and each two boxes are taken once.
  void (*meet)(const BlockTreeView& first, std::size_t begin, std::size_t end, const BlockTreeView& second,
               bool is_same, const MeetingView&, const BlockSink&);
};

const BoxKernels& box_kernels(InstructionSet set);

template <InstructionSet set>
const BoxKernels& compiled_box_kernels();

}  // namespace resilin
