#pragma once

#include <cstddef>
#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// Rows of a matrix in chunks that take turns by colour: those of one colour run at the same time and must
/// not write to the same place, the colours one after another. Chunks depend on the matrix alone, so that the
/// bits are the same for any number of threads.
///
/// Source: Iwashita, Nakashima, Takahashi 2012 (block multi-colour ordering).
struct ColoredChunks {
  struct Rows {
    Index first, last;  ///< [first, last)
  };
  std::vector<Rows> chunks;              ///< those of the first colour first
  std::vector<std::size_t> color_begin;  ///< the first chunk of every colour, then their number

  /// Everything in one chunk.
  static ColoredChunks whole(Index num_rows) { return {.chunks = {{0, num_rows}}, .color_begin = {0, 1}}; }

  /// Calls body(rows) for every chunk, the first colour first.
  template <class Body>
  void forward(const Body& body) const {
    for (std::size_t color = 0; color + 1 < color_begin.size(); ++color)
      run(color_begin[color], color_begin[color + 1], body);
  }
  /// The last colour first.
  template <class Body>
  void backward(const Body& body) const {
    for (std::size_t color = color_begin.size() - 1; color-- > 0;)
      run(color_begin[color], color_begin[color + 1], body);
  }
  /// All colours at once, for rows that write to places of their own alone.
  template <class Body>
  void at_once(const Body& body) const {
    run(0, chunks.size(), body);
  }

 private:
  template <class Body>
  void run(std::size_t begin, std::size_t end, const Body& body) const {
    parallel_tasks(end - begin, [&](std::size_t k) { body(chunks[begin + k]); });
  }
};

}  // namespace resilin
