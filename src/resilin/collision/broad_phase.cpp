#include "resilin/collision/broad_phase.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t vertices_per_chunk = 1 << 13;
constexpr std::size_t blocks_per_search = 128;

/// Turns blocks that meet into pairs of parts.
struct PairSink {
  const BlockTree& first;
  const BlockTree& second;
  bool is_same;
  std::vector<Candidate> pairs;

  static void take(void* state, std::size_t first_block, std::size_t second_block, std::uint64_t bits) {
    PairSink& sink = *static_cast<PairSink*>(state);
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::size_t>(__builtin_ctzll(bits));
      const Index a = sink.first.part(first_block * boxes_per_block + bit / boxes_per_block);
      const Index b = sink.second.part(second_block * boxes_per_block + bit % boxes_per_block);
      sink.pairs.push_back(sink.is_same && a > b ? Candidate{b, a} : Candidate{a, b});
    }
  }
};

/// All pairs of all searches in rising order: by counting those of each first part, in linear time.
void merge_rising(const std::vector<std::vector<Candidate>>& found, std::size_t num_first_parts,
                  std::vector<Candidate>& sorted) {
  std::vector<std::size_t> next(num_first_parts + 1, 0);
  for (const auto& pairs : found)
    for (const Candidate& pair : pairs) ++next[static_cast<std::size_t>(pair[0]) + 1];
  for (std::size_t part = 0; part < num_first_parts; ++part) next[part + 1] += next[part];
  sorted.resize(next.back());
  for (const auto& pairs : found)
    for (const Candidate& pair : pairs) sorted[next[static_cast<std::size_t>(pair[0])]++] = pair;
  std::size_t begin = 0;  // `next` has become the end of each first part
  for (std::size_t part = 0; part < num_first_parts; begin = next[part++])
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
              sorted.begin() + static_cast<std::ptrdiff_t>(next[part]));
}

void find_pairs(const BoxKernels& kernels, const BlockTree& first, const BlockTree& second,
                const MeetingView& meetings, std::size_t num_first_parts, std::vector<Candidate>& pairs) {
  pairs.clear();
  if (first.empty() || second.empty()) return;
  const bool is_same = &first == &second;
  const std::size_t count = first.num_leaf_blocks();
  std::vector<std::vector<Candidate>> found((count + blocks_per_search - 1) / blocks_per_search);
  parallel_for(count, blocks_per_search, [&](std::size_t begin, std::size_t end) {
    PairSink sink{first, second, is_same, {}};
    kernels.meet(first.view(), begin, end, second.view(), is_same, meetings, {&sink, PairSink::take});
    found[begin / blocks_per_search] = std::move(sink.pairs);
  });
  merge_rising(found, num_first_parts, pairs);
}

/// The middle of the places: boxes in single precision are the sharper the nearer they are to it.
std::array<double, 3> middle(std::span<const MovingPoint> points) {
  std::array<double, 3> center{};
  if (points.empty()) return center;
  for (std::size_t i = 0; i < 3; ++i) {
    double low = points[0].x[i], high = low;
    for (const MovingPoint& point : points) {
      low = std::min(low, point.x[i]);
      high = std::max(high, point.x[i]);
    }
    center[i] = 0.5 * low + 0.5 * high;
  }
  return center;
}

[[noreturn]] void refuse_place(std::size_t vertex, const MovingPoint& point) {
  std::ostringstream text;
  text << "BroadPhase::find: vertex " << vertex << ": expected finite coordinates below 1e30 m, got ("
       << point.x[0] << ", " << point.x[1] << ", " << point.x[2] << ") that moves by (" << point.p[0] << ", "
       << point.p[1] << ", " << point.p[2] << ")";
  throw std::invalid_argument(text.str());
}

}  // namespace

BroadPhase::BroadPhase(CollisionSurface surface, BodyMeetings meetings, std::span<const MovingPoint> points,
                       InstructionSet set)
    : surface_(std::move(surface)), meetings_(std::move(meetings)), set_(set) {
  rebuild(points);
}

void BroadPhase::rebuild(std::span<const MovingPoint> points) {
  points_ = BlockTree(surface_.points, 1, surface_.bodies, points);
  edges_ = BlockTree(surface_.edges, 2, surface_.bodies, points);
  triangles_ = BlockTree(surface_.triangles, 3, surface_.bodies, points);
}

const SurfaceCandidates& BroadPhase::find(std::span<const MovingPoint> points, double distance) {
  const BoxKernels& kernels = box_kernels(set_);
  const std::array<double, 3> origin = middle(points);
  vertex_rows_.resize(points.size());
  std::vector<std::size_t> bad((points.size() + vertices_per_chunk - 1) / vertices_per_chunk, points.size());
  parallel_for(points.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    const std::size_t found = kernels.enclose_vertices(points.data(), begin, end, origin.data(),
                                                       0.5 * distance, vertex_rows_.data());
    if (found != end) bad[begin / vertices_per_chunk] = found;
  });
  for (const std::size_t vertex : bad)
    if (vertex < points.size()) refuse_place(vertex, points[vertex]);
  for (BlockTree* tree : {&points_, &edges_, &triangles_})
    if (!tree->empty()) tree->refit(kernels, vertex_rows_);
  const MeetingView meetings = {meetings_.table(), meetings_.num_bodies()};
  const std::size_t num_points = surface_.points.size();
  if (surface_.dim == 2) {
    find_pairs(kernels, points_, edges_, meetings, num_points, candidates_.point_edge);
  } else {
    find_pairs(kernels, points_, triangles_, meetings, num_points, candidates_.point_triangle);
    find_pairs(kernels, edges_, edges_, meetings, surface_.edges.size() / 2, candidates_.edge_edge);
  }
  return candidates_;
}

}  // namespace resilin
