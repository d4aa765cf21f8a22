#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace resilin::testing {

/// Random numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  /// 0 to size - 1; 0 when size is 0.
  std::size_t below(std::size_t size) { return size == 0 ? 0 : static_cast<std::size_t>(engine_() % size); }

 private:
  std::mt19937_64 engine_;
};

/// `original` with one to four faults: flipped bits, cuts, numbers that are huge, negative or no numbers,
/// lines that are missing, doubled or exchanged, and pieces of `others`.
std::string mutated(const std::string& original, const std::vector<std::string>& others, Dice& dice);

}  // namespace resilin::testing
