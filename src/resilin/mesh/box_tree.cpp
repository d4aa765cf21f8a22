#include "resilin/mesh/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace resilin {

BoxTree::BoxTree(std::span<const Box> boxes, std::size_t num_searches) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  if (items_.empty()) return;
  const auto count = static_cast<Index>(boxes.size());
  nodes_.reserve(num_searches > few_searches ? boxes.size() : 1);
  nodes_.emplace_back();
  build(boxes, num_searches > few_searches ? leaf_size : count, 0, 0, count);
  for (const Index item : items_) boxes_.push_back(boxes[static_cast<std::size_t>(item)]);
}

void BoxTree::build(std::span<const Box> boxes, Index most_in_leaf, Index node, Index first, Index last) {
  Box all, centers;
  const auto center = [&](Index item) -> Vector3 {
    const Box& box = boxes[static_cast<std::size_t>(item)];
    return 0.5 * (box.min + box.max);
  };
  for (Index i = first; i < last; ++i) {
    const Index item = items_[static_cast<std::size_t>(i)];
    all.add(boxes[static_cast<std::size_t>(item)].min);
    all.add(boxes[static_cast<std::size_t>(item)].max);
    centers.add(center(item));
  }
  Node made{.box = all, .first = first, .last = last};
  if (last - first > most_in_leaf) {
    Eigen::Index axis = 0;
    (centers.max - centers.min).maxCoeff(&axis);
    const Index middle = first + (last - first) / 2;
    std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + last,
                     [&](Index a, Index b) {
                       const double x = center(a)[axis], y = center(b)[axis];
                       return x != y ? x < y : a < b;
                     });
    made.left = static_cast<Index>(nodes_.size());
    nodes_.emplace_back();
    nodes_.emplace_back();
    build(boxes, most_in_leaf, made.left, first, middle);
    build(boxes, most_in_leaf, made.left + 1, middle, last);
  }
  nodes_[static_cast<std::size_t>(node)] = made;
}

}  // namespace resilin
