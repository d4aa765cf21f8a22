#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A box with sides along the axes.
struct Box {
  Vector3 min = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 max = Vector3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vector3& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
  bool contains(const Vector3& point) const {
    return (point.array() >= min.array()).all() && (point.array() <= max.array()).all();
  }
  bool meets(const Box& other) const {
    return (other.max.array() >= min.array()).all() && (other.min.array() <= max.array()).all();
  }
  double squared_distance(const Vector3& point) const {
    return (min - point).cwiseMax(point - max).cwiseMax(0.0).squaredNorm();
  }
};

/// A binary tree over boxes, split at the median of their centres along the longest side. Built in O(n log
/// n); the same for the same boxes, and with the same answers whether or not it is split at all.
class BoxTree {
 public:
  BoxTree() = default;
  /// @param num_searches  that will be made: for few of them looking at every box costs less than a tree
  explicit BoxTree(std::span<const Box> boxes,
                   std::size_t num_searches = std::numeric_limits<std::size_t>::max());

  /// Calls `visit(i)` for each box that contains the point.
  template <class Visit>
  void visit_containing(const Vector3& point, const Visit& visit) const {
    visit_where([&](const Box& box) { return box.contains(point); }, visit);
  }

  /// Calls `visit(i)` for each box that shares a point with another one.
  template <class Visit>
  void visit_meeting(const Box& other, const Visit& visit) const {
    visit_where([&](const Box& box) { return box.meets(other); }, visit);
  }

  /// Calls `visit(i)` for each box that is wanted; a box that is not holds none that are.
  template <class IsWanted, class Visit>
  void visit_where(const IsWanted& is_wanted, const Visit& visit) const {
    std::array<Index, max_depth> stack;
    std::size_t size = 0;
    if (!nodes_.empty()) stack[size++] = 0;
    while (size > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(stack[--size])];
      if (!is_wanted(node.box)) continue;
      if (node.is_leaf()) {
        for (auto i = static_cast<std::size_t>(node.first); i < static_cast<std::size_t>(node.last); ++i)
          if (is_wanted(boxes_[i])) visit(items_[i]);
      } else {
        stack[size++] = node.left;
        stack[size++] = node.left + 1;
      }
    }
  }

  /// The item with the least `squared_distance(i)`, which must not be less than that to its box; the first of
  /// several. -1 without items.
  /// @param hint  an item that may be near, -1 for none: makes the search faster and changes nothing else
  template <class SquaredDistance>
  Index nearest(const Vector3& point, const SquaredDistance& squared_distance, Index hint = -1) const {
    struct Entry {
      Index node;
      double bound;
    };
    std::array<Entry, max_depth> stack;
    std::size_t size = 0;
    const auto bound_of = [&](Index node) {
      return nodes_[static_cast<std::size_t>(node)].box.squared_distance(point);
    };
    if (!nodes_.empty()) stack[size++] = {0, bound_of(0)};
    Index best = hint;
    double least = hint < 0 ? std::numeric_limits<double>::infinity() : squared_distance(hint);
    while (size > 0) {
      const Entry entry = stack[--size];
      if (entry.bound > least) continue;
      const Node& node = nodes_[static_cast<std::size_t>(entry.node)];
      if (node.is_leaf()) {
        for (auto i = static_cast<std::size_t>(node.first); i < static_cast<std::size_t>(node.last); ++i) {
          if (boxes_[i].squared_distance(point) > least) continue;
          const Index item = items_[i];
          const double distance = squared_distance(item);
          if (distance < least || (distance == least && item < best)) {
            least = distance;
            best = item;
          }
        }
      } else {  // the nearer child last, so that it is taken first
        Entry near{node.left, bound_of(node.left)}, far{node.left + 1, bound_of(node.left + 1)};
        if (near.bound > far.bound) std::swap(near, far);
        stack[size++] = far;
        stack[size++] = near;
      }
    }
    return best;
  }

 private:
  struct Node {
    Box box;
    Index first = 0, last = 0;  ///< first and last of a leaf, in items_
    Index left = -1;            ///< child; the other one follows it
    bool is_leaf() const { return left < 0; }
  };
  static constexpr Index leaf_size = 4;
  static constexpr std::size_t few_searches = 32;  ///< a tree takes as long as looking 100 times at its boxes
  static constexpr std::size_t max_depth = 64;     ///< halving 2^31 items ends far above

  void build(std::span<const Box> boxes, Index most_in_leaf, Index node, Index first, Index last);

  std::vector<Node> nodes_;
  std::vector<Index> items_;
  std::vector<Box> boxes_;  ///< boxes of items_
};

}  // namespace resilin
