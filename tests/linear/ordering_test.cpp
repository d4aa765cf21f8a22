#include "resilin/linear/ordering.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <random>
#include <set>
#include <string>
#include <thread>

namespace resilin {
namespace {

using Pairs = std::set<std::pair<Index, Index>>;

NodeGraph graph_of(Index num_nodes, const Pairs& pairs) {
  std::vector<std::vector<Index>> neighbours(static_cast<std::size_t>(num_nodes));
  for (const auto& [i, j] : pairs) {
    if (i == j) continue;
    neighbours[static_cast<std::size_t>(i)].push_back(j);
    neighbours[static_cast<std::size_t>(j)].push_back(i);
  }
  NodeGraph graph;
  graph.begin = {0};
  for (std::vector<Index>& row : neighbours) {
    std::ranges::sort(row);
    row.erase(std::ranges::unique(row).begin(), row.end());
    graph.neighbours.insert(graph.neighbours.end(), row.begin(), row.end());
    graph.begin.push_back(static_cast<Index>(graph.neighbours.size()));
  }
  return graph;
}

/// A cube of nodes, each with the 26 around it.
NodeGraph cube(Index n) {
  Pairs pairs;
  const auto node = [n](Index x, Index y, Index z) { return (z * n + y) * n + x; };
  for (Index z = 0; z < n; ++z)
    for (Index y = 0; y < n; ++y)
      for (Index x = 0; x < n; ++x)
        for (Index dz = -1; dz <= 1; ++dz)
          for (Index dy = -1; dy <= 1; ++dy)
            for (Index dx = -1; dx <= 1; ++dx) {
              const Index a = x + dx, b = y + dy, c = z + dz;
              if (std::min({a, b, c}) >= 0 && std::max({a, b, c}) < n && node(a, b, c) > node(x, y, z))
                pairs.emplace(node(x, y, z), node(a, b, c));
            }
  return graph_of(n * n * n, pairs);
}

bool holds_every_node_once(std::vector<Index> order, Index count) {
  std::ranges::sort(order);
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != static_cast<Index>(i)) return false;
  return static_cast<Index>(order.size()) == count;
}

/// Graphs unlike any mesh: hubs, cliques of all sizes on a chain, trees, islands, couplings by chance.
TEST(FillReducingOrder, HoldsEveryNodeOfStrangeGraphsOnce) {
  std::mt19937 random(3);
  const auto below = [&random](Index count) {
    return std::uniform_int_distribution<Index>(0, count - 1)(random);
  };
  for (int sample = 0; sample < 60; ++sample) {
    const Index n = 2 + below(sample % 10 == 0 ? 3000 : 300);
    Pairs pairs;
    const int kind = sample % 6;
    for (Index i = 1; i < n; ++i) {
      if (kind == 0) pairs.emplace(0, i);                    // a hub
      if (kind == 1) pairs.emplace(below(i), i);             // a tree
      if (kind == 2 && i % 7 != 0) pairs.emplace(i - 1, i);  // islands
      if (kind == 3) pairs.emplace(i - 1, i);                // a chain, with cliques below
      if (kind == 4)
        for (int k = 0; k < 3; ++k) pairs.emplace(below(i), i);
      if (kind == 5 && n < 200)
        for (Index j = 0; j < i; ++j)
          if (below(10) > 0) pairs.emplace(j, i);
    }
    if (kind == 3)
      for (Index first = 0, size = 2; first + size < n; first += size, size *= 2)
        for (Index i = first; i < std::min(first + size, first + 64); ++i)
          for (Index j = first; j < i; ++j) pairs.emplace(j, i);
    SCOPED_TRACE("sample " + std::to_string(sample));
    EXPECT_TRUE(holds_every_node_once(fill_reducing_order(graph_of(n, pairs)), n));
  }
}

std::atomic<int> num_received = 0;

/// Sends SIGTERM to this process again and again, each time when the last one has been received.
/// @return  how many; -1 when one was lost
int send_until(const std::atomic<bool>& is_over) {
  using Clock = std::chrono::steady_clock;
  for (int sent = 1;; ++sent) {
    ::kill(::getpid(), SIGTERM);
    const Clock::time_point begin = Clock::now();
    while (num_received < sent) {
      if (Clock::now() - begin > std::chrono::seconds(20)) return -1;
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
    if (is_over) return sent;
  }
}

/// Whoever receives it: the thread that orders, or another one.
TEST(FillReducingOrder, LeavesSignalsToTheProgram) {
  const NodeGraph graph = cube(22);
  const std::vector<Index> quiet = fill_reducing_order(graph);
  struct sigaction action = {}, before = {};
  action.sa_handler = [](int) { ++num_received; };
  sigaction(SIGTERM, &action, &before);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, SIGTERM);
  for (const bool is_received_here : {true, false}) {
    num_received = 0;
    std::atomic<bool> is_over = false;
    int sent = 0;
    if (is_received_here) pthread_sigmask(SIG_BLOCK, &only, nullptr);  // by the sender, as of now
    std::thread sender([&] { sent = send_until(is_over); });
    pthread_sigmask(is_received_here ? SIG_UNBLOCK : SIG_BLOCK, &only, nullptr);
    while (num_received == 0) std::this_thread::yield();
    EXPECT_EQ(fill_reducing_order(graph), quiet);
    is_over = true;
    sender.join();
    pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
    EXPECT_GT(sent, 1) << (is_received_here ? "here" : "by another thread");
  }
  sigaction(SIGTERM, &before, nullptr);
}

}  // namespace
}  // namespace resilin
