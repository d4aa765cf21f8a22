#include "resilin/linear/sweep_order.hpp"

#include <algorithm>
#include <numeric>
#include <ranges>

#include "resilin/linear/ordering.hpp"

namespace resilin {
namespace {

/// Layers with the entries of the matrix that stand in their rows.
struct WeighedLayers : LayeredOrder {
  std::vector<Offset> couplings;
  Offset all = 0;

  explicit WeighedLayers(const NodeGraph& graph) : LayeredOrder(reverse_cuthill_mckee(graph)) {
    for (std::size_t layer = 0; layer < count(); ++layer) {
      couplings.push_back(0);
      for (Index k = layer_begin[layer]; k < layer_begin[layer + 1]; ++k)
        couplings.back() += 1 + (graph.begin[node_at[k] + 1] - graph.begin[node_at[k]]) / 2;
      all += couplings.back();
    }
  }
  std::size_t count() const { return layer_begin.size() - 1; }
};

constexpr std::size_t layers_at_least =
    2;  // least number of layers of a chunk: else its neighbours would meet in it

SweepOrder in_one_chunk(const WeighedLayers& layers) {
  SweepOrder order{.node_at = layers.node_at,
                   .chunks = ColoredChunks::whole(static_cast<Index>(layers.node_at.size())),
                   .along_layers = std::vector<Index>(layers.node_at.size())};
  std::iota(order.along_layers.begin(), order.along_layers.end(), 0);
  return order;
}

/// @param chunk_of  the chunk of each layer
/// @param turn_of   the turn of each chunk, those of the first colour first
/// @param sequence  of the nodes within chunks
SweepOrder in_chunks(const WeighedLayers& layers, const std::vector<std::size_t>& chunk_of,
                     const std::vector<std::size_t>& turn_of, std::size_t num_first,
                     std::vector<Index> sequence) {
  std::vector<std::size_t> turn_of_node(sequence.size());
  for (std::size_t layer = 0; layer < layers.count(); ++layer)
    for (Index k = layers.layer_begin[layer]; k < layers.layer_begin[layer + 1]; ++k)
      turn_of_node[layers.node_at[k]] = turn_of[chunk_of[layer]];
  std::ranges::stable_sort(sequence, {}, [&](Index node) { return turn_of_node[node]; });
  SweepOrder order{.node_at = std::move(sequence), .chunks = {}, .along_layers = {}};
  order.chunks.color_begin = {0, num_first, turn_of.size()};
  const auto positions = std::views::iota(Index{0}, static_cast<Index>(order.node_at.size()));
  for (std::size_t turn = 0; turn < turn_of.size(); ++turn) {
    const auto [first, last] = std::ranges::equal_range(
        positions, turn, {}, [&](Index position) { return turn_of_node[order.node_at[position]]; });
    order.chunks.chunks.push_back({*first, *first + static_cast<Index>(last - first)});
  }
  const std::vector<Index> position = inverse_of(order.node_at);
  for (const Index node : layers.node_at) order.along_layers.push_back(position[node]);
  return order;
}

}  // namespace

SweepOrder two_color_order(const NodeGraph& graph, Offset least_couplings) {
  constexpr Offset enough_chunks = 48, most_chunks = 64;
  constexpr Offset large = 20000;  // rows whose neighbours mostly lie in other chunks fall out of the cache
  constexpr std::size_t least_chunks = 4;  // below, a colour has nothing to share
  const WeighedLayers layers(graph);
  const Offset wanted =
      std::max({least_couplings, std::min(large, layers.all / enough_chunks), layers.all / most_chunks});
  std::vector<std::size_t> chunk_of;
  Offset couplings = 0, rest = layers.all;
  for (std::size_t layer = 0, in_chunk = 0, chunk = 0; layer < layers.count(); ++layer) {
    chunk_of.push_back(chunk);
    couplings += layers.couplings[layer];
    const bool is_full = ++in_chunk >= layers_at_least && couplings >= wanted;
    if (!is_full || layers.count() - 1 - layer < layers_at_least || rest - couplings < wanted) continue;
    rest -= couplings;
    couplings = 0;
    in_chunk = 0;
    ++chunk;
  }
  const std::size_t num_chunks = chunk_of.empty() ? 0 : chunk_of.back() + 1;
  if (num_chunks < least_chunks) return in_one_chunk(layers);
  const std::size_t num_first = (num_chunks + 1) / 2;
  std::vector<std::size_t> turn_of;
  for (std::size_t k = 0; k < num_chunks; ++k) turn_of.push_back(k / 2 + (k % 2 == 0 ? 0 : num_first));
  return in_chunks(layers, chunk_of, turn_of, num_first, layers.node_at);
}

SweepOrder two_ended_order(const NodeGraph& graph, Offset least_couplings) {
  constexpr std::size_t layers_for_two = 16, layers_for_each_more = 60;  // costs some 3 % of the iterations
  const WeighedLayers layers(graph);
  const std::size_t by_layers =
      layers.count() < layers_for_two ? 1 : std::max<std::size_t>(2, layers.count() / layers_for_each_more);
  const std::size_t num_regions = std::min(by_layers, static_cast<std::size_t>(layers.all / least_couplings));
  if (num_regions < 2) return in_one_chunk(layers);

  // Regions and what lies between them by turns, the former of equal work.
  std::vector<std::size_t> chunk_of;
  Offset passed = 0;
  for (std::size_t layer = 0, chunk = 0, in_chunk = 0; layer < layers.count(); ++layer, ++in_chunk) {
    const bool is_between = chunk % 2 == 1, is_last = chunk == 2 * num_regions - 2;
    const auto end = layers.all * static_cast<Offset>(chunk / 2 + 1) / static_cast<Offset>(num_regions);
    if (is_between ? in_chunk >= layers_at_least
                   : !is_last && in_chunk >= layers_at_least && passed + layers.couplings[layer] > end) {
      ++chunk;
      in_chunk = 0;
    }
    chunk_of.push_back(chunk);
    passed += layers.couplings[layer];
  }
  const std::size_t num_chunks = chunk_of.back() + 1;
  if (num_chunks % 2 == 0) return in_one_chunk(layers);  // the last region has come to nothing
  const std::size_t num_first = (num_chunks + 1) / 2;
  std::vector<std::size_t> turn_of;
  for (std::size_t k = 0; k < num_chunks; ++k) turn_of.push_back(k / 2 + (k % 2 == 0 ? 0 : num_first));

  // The first region leads to what lies behind it as it is; so do those of bodies that lie in one region.
  std::vector<Index> led, ends, sequence;
  std::vector<int> is_led(layers.node_at.size(), 0);
  const auto for_layers = [&](const auto& is_meant, const auto& visit) {
    for (std::size_t layer = 0; layer < layers.count(); ++layer)
      if (is_meant(chunk_of[layer]))
        for (Index k = layers.layer_begin[layer]; k < layers.layer_begin[layer + 1]; ++k)
          visit(layers.node_at[k]);
  };
  for_layers([](std::size_t chunk) { return chunk == 0 || chunk % 2 == 1; },
             [&](Index node) { is_led[node] = 1; });
  for_layers([](std::size_t chunk) { return chunk % 2 == 1; }, [&](Index node) { led.push_back(node); });
  const std::size_t num_between = led.size();
  append_layers(graph, 0, is_led, 1, led, ends);
  for (const Index node : std::views::drop(led, static_cast<Offset>(num_between))) is_led[node] = 2;
  for (const Index node : layers.node_at)
    if (is_led[node] < 2) sequence.push_back(node);
  sequence.insert(sequence.end(), led.rbegin(), led.rend() - static_cast<Offset>(num_between));
  return in_chunks(layers, chunk_of, turn_of, num_first, std::move(sequence));
}

}  // namespace resilin
