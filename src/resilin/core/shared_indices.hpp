#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A list of numbers that does not change: its own, or one that is held elsewhere. Copies share it.
class SharedIndices {
 public:
  SharedIndices() : SharedIndices(std::vector<Index>()) {}
  SharedIndices(std::vector<Index> own) : list_(std::make_shared<const std::vector<Index>>(std::move(own))) {}
  /// A list that is part of what `holder` holds, and keeps it alive.
  template <class Holder>
  SharedIndices(std::shared_ptr<Holder> holder, const std::vector<Index>& list)
      : list_(std::move(holder), &list) {}

  operator const std::vector<Index>&() const { return *list_; }
  auto begin() const { return list_->begin(); }
  auto end() const { return list_->end(); }
  const Index* data() const { return list_->data(); }
  std::size_t size() const { return list_->size(); }
  Index front() const { return list_->front(); }
  Index operator[](std::size_t i) const { return (*list_)[i]; }

 private:
  std::shared_ptr<const std::vector<Index>> list_;
};

}  // namespace resilin
