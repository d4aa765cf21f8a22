#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "resilin/contact/collider_motion.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// A frictional contact on a body, with its normal force.
struct FrictionContact {
  Vector3 normal;                      ///< across the surfaces, of length 1
  double limit;                        ///< mu lambda [N]: of the friction, which slip overcomes
  Vector3 velocity = Vector3::Zero();  ///< velocity of the pressing side, where it is no body [m/s]
};

/// Contacts one after the other. A contact slips by sum_k weight_k (way of node_k), less the way of what
/// presses: of a node against an obstacle its own way, of points of two bodies what follows from their nodes.
class FrictionContacts {
 public:
  struct Entry {
    FrictionContact contact;
    std::size_t source;  ///< number of its source
    std::span<const WeightedNode> nodes;
  };

  /// Those that are added from now on are of this source.
  /// @param share  of their limits that counts
  void begin_source(std::size_t source, double share = 1) {
    source_ = source;
    share_ = share;
  }
  /// @param nodes  each of them once
  void add(const FrictionContact& contact, std::span<const WeightedNode> nodes) {
    if (share_ * contact.limit <= 0) return;
    contacts_.push_back(contact);
    contacts_.back().limit *= share_;
    sources_.push_back(source_);
    nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
    ends_.push_back(nodes_.size());
  }

  std::size_t size() const { return contacts_.size(); }
  /// Takes only a share of a contact, the rest from what it was before, between the same nodes.
  void mix(std::size_t i, double share, const Entry& before) {
    FrictionContact& contact = contacts_[i];
    contact.normal = (share * contact.normal + (1 - share) * before.contact.normal).normalized();
    contact.limit = std::max(share * contact.limit + (1 - share) * before.contact.limit, 0.0);
    contact.velocity = share * contact.velocity + (1 - share) * before.contact.velocity;
    const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
    for (std::size_t k = 0; k < before.nodes.size(); ++k) {
      double& weight = nodes_[begin + k].weight;
      weight = share * weight + (1 - share) * before.nodes[k].weight;
    }
  }
  void scale_limit(std::size_t i, double share) { contacts_[i].limit *= share; }
  Entry operator[](std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
    return {contacts_[i], sources_[i], std::span(nodes_).subspan(begin, ends_[i] - begin)};
  }

 private:
  std::vector<FrictionContact> contacts_;
  std::vector<std::size_t> sources_, ends_;
  std::vector<WeightedNode> nodes_;
  std::size_t source_ = 0;
  double share_ = 1;
};

/// Derivatives of a contact by its positions (contact/friction_slopes.hpp).
struct FrictionContactSlopes;

/// A source of normal forces on bodies.
class FrictionSource {
 public:
  virtual ~FrictionSource() = default;
  /// Name of its force in the report; empty for contact between bodies.
  virtual std::string_view name_in_reports() const { return {}; }
  /// Whether it is a stage's own copy of the other, which may know more of what is near.
  virtual bool is_copy_of(const FrictionSource& /*other*/) const { return false; }
  /// Its contacts when bodies stand at x, in an order that does not depend on the number of threads. Their
  /// forces count once, whatever `c.weight` is.
  /// @param start  where bodies stood when the stage began: they slide along the surfaces that they had there
  virtual void add_friction_contacts(const VectorX& x, const VectorX& start, const Conditions& c,
                                     FrictionContacts& contacts) const = 0;

  // ---- for derivatives

  /// The same contacts, in their order, and how they change.
  virtual void add_friction_slopes(const VectorX& /*x*/, const VectorX& /*start*/, const Conditions& /*c*/,
                                   std::vector<FrictionContactSlopes>& /*slopes*/) const {
    throw std::logic_error("how these contacts change is not known");
  }
  /// Coefficients that it was made with, and numbers of its parameter "barrier_stiffness".
  virtual Eigen::Index num_coefficients() const { return 1; }
  virtual Eigen::Index num_stiffnesses() const { return 0; }
  /// Its own motion; null without one.
  virtual const ColliderMotion* motion_of_its_own() const { return nullptr; }
  /// The smallest gap relative to the activation distance; infinite where nothing is near.
  virtual double relative_gap(const VectorX& /*x*/, const Conditions& /*c*/) const {
    return std::numeric_limits<double>::infinity();
  }
};

}  // namespace resilin
