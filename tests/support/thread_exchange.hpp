#pragma once

#include <algorithm>
#include <barrier>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "resilin/core/process_group.hpp"
#include "resilin/world/scene_cut.hpp"

namespace resilin::testing {

/// Messages between threads that stand for processes.
struct Table {
  explicit Table(int num_ranks)
      : barrier(num_ranks), numbers(static_cast<std::size_t>(num_ranks)), bytes(numbers.size()) {}
  std::barrier<> barrier;
  std::vector<std::vector<double>> numbers;
  std::vector<std::string> bytes;
  std::vector<const ScenePart*> parts = std::vector<const ScenePart*>(numbers.size());
};

/// Exchange between threads, each with a part of a scene.
class ThreadExchange final : public Exchange {
 public:
  ThreadExchange(int rank, const ScenePart& part, Table& table) : rank_(rank), part_(part), table_(table) {
    table_.parts[static_cast<std::size_t>(rank)] = &part;
    for (const std::int32_t owner : part.owners) owned_.push_back(owner == rank ? 1 : 0);
    table_.barrier.arrive_and_wait();
  }

  int rank() const override { return rank_; }
  int num_ranks() const override { return static_cast<int>(table_.numbers.size()); }
  void sum(std::span<double> values) const override {
    combine(values, [](double a, double b) { return a + b; });
  }
  void largest(std::span<double> values) const override {
    combine(values, [](double a, double b) { return a < b ? b : a; });
  }
  void combine_copies(VectorX& values, Combine how) const override {
    put({values.data(), static_cast<std::size_t>(values.size())});
    const auto dim = static_cast<std::size_t>(values.size()) / part_.numbers.size();
    std::map<Index, std::vector<double>> whole;
    for (std::size_t rank = 0; rank < table_.numbers.size(); ++rank) {
      const std::vector<Index>& numbers = table_.parts[rank]->numbers;
      for (std::size_t node = 0; node < numbers.size(); ++node) {
        const double* theirs = table_.numbers[rank].data() + node * dim;
        auto [entry, is_new] = whole.try_emplace(numbers[node], theirs, theirs + dim);
        for (std::size_t k = 0; k < dim && !is_new; ++k) {
          double& own = entry->second[k];
          own = how == Combine::sum ? own + theirs[k] : std::min(own, theirs[k]);
        }
      }
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(values.size()); ++i)
      values[static_cast<Eigen::Index>(i)] = whole.at(part_.numbers[i / dim])[i % dim];
    table_.barrier.arrive_and_wait();
  }
  std::span<const std::uint8_t> owned() const override { return owned_; }
  std::span<const Index> numbers() const override { return part_.numbers; }
  std::span<const Offset> ranked_numbers() const override { return part_.ranked_numbers; }
  std::string tell(int from, const std::string& bytes) const override {
    return gathered(bytes)[static_cast<std::size_t>(from)];
  }
  std::vector<std::string> gather(const std::string& bytes) const override {
    std::vector<std::string> all = gathered(bytes);
    return rank_ == 0 ? all : std::vector<std::string>();
  }

 private:
  void put(std::span<const double> values) const {
    table_.numbers[static_cast<std::size_t>(rank_)].assign(values.begin(), values.end());
    table_.barrier.arrive_and_wait();
  }
  template <class Function>
  void combine(std::span<double> values, const Function& function) const {
    put(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = table_.numbers[0][i];
      for (std::size_t rank = 1; rank < table_.numbers.size(); ++rank)
        values[i] = function(values[i], table_.numbers[rank][i]);
    }
    table_.barrier.arrive_and_wait();
  }
  std::vector<std::string> gathered(const std::string& bytes) const {
    table_.bytes[static_cast<std::size_t>(rank_)] = bytes;
    table_.barrier.arrive_and_wait();
    std::vector<std::string> all = table_.bytes;
    table_.barrier.arrive_and_wait();
    return all;
  }

  int rank_;
  const ScenePart& part_;
  Table& table_;
  std::vector<std::uint8_t> owned_;
};

/// Calls `work(world)` on one thread for each part of a scene.
/// @param cell_ranks  of each body, by cell
inline void on_parts(const World& whole, const std::vector<std::vector<std::int32_t>>& cell_ranks,
                     int num_ranks, const std::function<void(const World&)>& work) {
  const SceneCut cut(whole, cell_ranks, num_ranks);
  Table table(num_ranks);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < num_ranks; ++rank)
    threads.emplace_back([&, rank] {
      const ScenePart part = cut.part(rank);
      const World world(part, ProcessGroup(std::make_shared<const ThreadExchange>(rank, part, table)));
      work(world);
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace resilin::testing
