#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <unordered_map>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Numbers for places: the same for exactly the same place (-0 is 0), from 0 in the order of their coming.
class PlaceIndex {
 public:
  Index number_of(const Vector3& place) {
    const Vector3 unsigned_zero = place.array() + 0.0;
    const auto [found, is_new] = numbers_.try_emplace(
        {unsigned_zero.x(), unsigned_zero.y(), unsigned_zero.z()}, static_cast<Index>(places_.size()));
    if (is_new) places_.push_back(unsigned_zero);
    return found->second;
  }

  std::size_t size() const { return places_.size(); }
  const std::vector<Vector3>& places() const { return places_; }

 private:
  struct Hash {
    std::size_t operator()(const std::array<double, 3>& place) const {
      std::size_t hash = 0;
      for (const double coordinate : place)
        hash = (hash ^ std::hash<double>()(coordinate)) * std::size_t{0x9e3779b97f4a7c15u};
      return hash ^ hash >> 32;
    }
  };

  std::unordered_map<std::array<double, 3>, Index, Hash> numbers_;
  std::vector<Vector3> places_;
};

}  // namespace resilin
