#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "resilin/core/memory.hpp"
#include "resilin/linear/multifrontal_analysis.hpp"

namespace resilin {

/// Two stacks of numbers, kept from one factorisation to the next.
class UpdateStacks {
 public:
  void reserve(const MultifrontalAnalysis::StackSizes& sizes, int numbers_per_block) {
    for (int k = 0; k < 2; ++k) {
      const Offset size = sizes.blocks[k] * numbers_per_block;
      if (size > capacity_[k]) {
        numbers_[k] = make_numbers(static_cast<std::size_t>(size));
        capacity_[k] = size;
      }
      used_[k] = 0;
    }
  }
  double* push(int stack, Offset size) {
    double* top = numbers_[stack].get() + used_[stack];
    used_[stack] += size;
    return top;
  }
  void pop(int stack, Offset size) { used_[stack] -= size; }
  /// Room for all columns of one front; the same, with what it holds, until more is asked for.
  double* scratch(Offset size) {
    if (size > scratch_capacity_) {
      scratch_.reset();
      scratch_ = make_numbers(static_cast<std::size_t>(size));
      scratch_capacity_ = size;
    }
    return scratch_.get();
  }

 private:
  std::unique_ptr<double[]> numbers_[2];
  Offset capacity_[2] = {0, 0}, used_[2] = {0, 0};
  std::unique_ptr<double[]> scratch_;
  Offset scratch_capacity_ = 0;
};

/// As many stacks as subtrees are being factorised at the same time.
class StackPool {
 public:
  std::unique_ptr<UpdateStacks> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<UpdateStacks>();
    std::unique_ptr<UpdateStacks> stacks = std::move(free_.back());
    free_.pop_back();
    return stacks;
  }
  void give_back(std::unique_ptr<UpdateStacks> stacks) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(stacks));
  }
  void clear() { free_.clear(); }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<UpdateStacks>> free_;
};

}  // namespace resilin
