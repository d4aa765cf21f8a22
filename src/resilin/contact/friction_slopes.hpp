#pragma once

#include <span>
#include <utility>
#include <vector>

#include "resilin/contact/friction_contact.hpp"

namespace resilin {

/// A contact, and how it changes to first order with the places that it follows and with what its source was
/// made of.
struct FrictionContactSlopes {
  /// Slipping point: one of a body follows nodes; one of a source that moves by itself follows none.
  struct Vertex {
    double weight;
    std::vector<WeightedNode> nodes;
  };
  /// A place that the contact follows besides its slip.
  struct Place {
    std::vector<WeightedNode> nodes{};  ///< nodes of the body; none: it moves with the source
    bool is_at_start = false;           ///< at the start of the stage
    Vector3 limit = Vector3::Zero();    ///< its slope [N/m]
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), velocity = Eigen::Matrix3d::Zero();
    std::vector<Vector3> weights{};  ///< weights of the vertices; empty: they do not change
  };

  FrictionContact contact;
  Eigen::Index coefficient;  ///< the number of its coefficient among those of the source
  double mu;                 ///< value of the coefficient
  double share_of_rate = 0;  ///< its velocity follows that of the source by so much
  std::vector<Vertex> vertices;
  std::vector<Place> places;
  std::vector<std::pair<Eigen::Index, double>>
      stiffness;  ///< stiffness of the source, and the slope of the limit
};

/// How the forces of friction at x change when each has the limit, normal and points of its very place
/// (docs/theory/gradients.md, G.6).
class FrictionSlopes {
 public:
  /// Changes, or derivatives by them; empty members do not count.
  struct Change {
    VectorX lag{};           ///< places that contacts are formed at, what slips staying where it is [m]
    VectorX start{};         ///< places where the stage began [m]
    VectorX still{};         ///< places that slip is counted from [m]
    VectorX coefficients{};  ///< coefficients of the sources, one after the other
    VectorX stiffness{};     ///< likewise
    VectorX shifts{};        ///< shifts of what moves by itself, three for each source [m]
    VectorX rates{};         ///< rates of its velocity [m/s]
  };

  /// @param still  places that slip is counted from [m]
  /// @param time   that slip takes [s]
  /// @param eps    the slip below which contacts stick [m]
  FrictionSlopes(int dim, std::span<const FrictionSource* const> sources, const VectorX& x,
                 const VectorX& start, const VectorX& still, double time, double eps, const Conditions& c);

  Eigen::Index num_coefficients() const { return first_coefficient_.back(); }
  Eigen::Index num_stiffnesses() const { return first_stiffness_.back(); }

  /// gradient += what the change does to it.
  void add_forces(const Change& change, double weight, VectorX& gradient) const;
  /// Adds the slopes of w . gradient to those that `slopes` has room for.
  void add_slopes(const VectorX& w, double weight, Change& slopes) const;

 private:
  /// The gradient g on the nodes of a contact, each by its weight, and its slopes.
  struct Contact {
    FrictionContactSlopes of;
    std::size_t source;
    Vector3 g;
    Eigen::Matrix3d by_still, by_rate;
    std::vector<Eigen::Matrix3d> by_place;
  };
  Vector3 at(const std::vector<WeightedNode>& nodes, const VectorX& x) const;
  void add_to_nodes(const std::vector<WeightedNode>& nodes, const Vector3& value, VectorX& x) const;

  int dim_;
  std::vector<Contact> contacts_;
  std::vector<Eigen::Index> first_coefficient_{0},
      first_stiffness_{0};  ///< first coefficient and first stiffness of each source, and the end
};

}  // namespace resilin
