#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Exchange between processes that work on one scene (docs/theory/distribution.md). Each has some of the
/// cells with all nodes of these, so that nodes between processes have a copy on several; one copy is the
/// owner's. All processes call the same functions in the same order.
class Exchange {
 public:
  enum class Combine { sum, smallest };

  virtual ~Exchange() = default;
  virtual int rank() const = 0;
  virtual int num_ranks() const = 0;

  /// Each number becomes its sum over all processes, the same bits on each.
  virtual void sum(std::span<double> values) const = 0;
  /// Each number becomes the largest of all processes; nan counts as less than all others.
  virtual void largest(std::span<double> values) const = 0;

  /// Every copy of a node's numbers becomes the sum, or the smallest, of all its copies: the same bits on
  /// each process.
  /// @param values  as many numbers for each node of this process
  virtual void combine_copies(VectorX& values, Combine how) const = 0;

  virtual std::span<const std::uint8_t> owned() const = 0;     ///< by node: this copy is the owner's
  virtual std::span<const Index> numbers() const = 0;          ///< numbers of the nodes in the whole scene
  virtual std::span<const Offset> ranked_numbers() const = 0;  ///< the same, those of an owner in a row

  /// The bytes that one process gives, on all of them.
  virtual std::string tell(int from, const std::string& bytes) const = 0;
  /// The bytes of each process, on the first; elsewhere empty.
  virtual std::vector<std::string> gather(const std::string& bytes) const = 0;
};

/// The processes that work on one scene, as one of them sees them: which nodes it owns, and sums over all. As
/// a rule there is one process, for which every function gives back what it got, at no cost.
class ProcessGroup {
 public:
  ProcessGroup() = default;
  explicit ProcessGroup(std::shared_ptr<const Exchange> exchange) : exchange_(std::move(exchange)) {}

  bool is_whole() const { return exchange_ == nullptr; }
  /// Exchange of several processes.
  const Exchange& exchange() const { return *exchange_; }
  bool is_first() const { return is_whole() || exchange_->rank() == 0; }

  double sum(double value) const {
    if (!is_whole()) exchange_->sum({&value, 1});
    return value;
  }
  Vector3 sum(Vector3 value) const {
    if (!is_whole()) exchange_->sum({value.data(), 3});
    return value;
  }
  void sum(std::span<double> values) const {
    if (!is_whole()) exchange_->sum(values);
  }
  double largest(double value) const {
    if (!is_whole()) exchange_->largest({&value, 1});
    return value;
  }
  void largest(std::span<double> values) const {
    if (!is_whole()) exchange_->largest(values);
  }
  double smallest(double value) const { return is_whole() ? value : -largest(-value); }
  bool any(bool value) const { return is_whole() ? value : largest(value ? 1.0 : 0.0) > 0; }
  bool all(bool value) const { return is_whole() ? value : !any(!value); }

  /// Sums copies: values that are added up cell by cell, as forces are, become whole at nodes between
  /// processes.
  void add_copies(VectorX& values) const {
    if (!is_whole()) exchange_->combine_copies(values, Exchange::Combine::sum);
  }

  /// Each node is owned by one process.
  bool owns(Index node) const {
    return is_whole() || exchange_->owned()[static_cast<std::size_t>(node)] != 0;
  }
  /// For a share that is not the whole, with the copies of nodes that others own.
  Eigen::Index num_nodes() const { return static_cast<Eigen::Index>(exchange_->numbers().size()); }
  /// The node's number in the whole scene.
  Index number_of(Index node) const {
    return is_whole() ? node : exchange_->numbers()[static_cast<std::size_t>(node)];
  }

  /// Over the unknowns of the whole scene; of numbers that are the same in all copies of a node.
  double dot(const VectorX& a, const VectorX& b) const {
    if (is_whole()) return a.dot(b);
    return sum(owned_dot(a, b));
  }
  double norm(const VectorX& a) const;

 private:
  double owned_dot(const VectorX& a, const VectorX& b) const;

  std::shared_ptr<const Exchange> exchange_;
};

}  // namespace resilin
