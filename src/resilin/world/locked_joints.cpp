// Motors of joints that nothing lets move.

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "resilin/core/dense.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/world/joint_maker.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

using Dense = dense::Matrix;

/// Singular values of the equations, relative to the largest: below this the equations say again what others
/// say. Axes that should meet miss each other by the rounding of a file.
constexpr double negligible = 1e-5;
/// Length of a trial motion, in extents, and the changes of a value by it that count.
constexpr double trial_motion = 0.05, notable_change = 1e-6;
constexpr double closed = 1e-9;  ///< gap of a closed loop, in extents
constexpr int most_iterations = 30;
constexpr Eigen::Index most_free = 6;  ///< motions that are tried one by one

/// The rigid bodies that joints connect with one of them.
class Mechanism {
 public:
  /// @param joint  one of the world's, by its number
  Mechanism(const World& world, std::size_t joint) : world_(world) {
    joints_ = {joint};
    const auto is_rigid = [&](const Joint& each) {
      return std::ranges::all_of(each.bodies,
                                 [&](std::size_t b) { return world.bodies[b].rigid != nullptr; });
    };
    bodies_ = world.joints[joint].bodies;
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t j = 0; j < world.joints.size(); ++j) {
        const Joint& other = world.joints[j];
        if (std::ranges::find(joints_, j) != joints_.end() || !is_rigid(other) ||
            std::ranges::none_of(other.bodies, [&](std::size_t b) { return has(b); }))
          continue;
        grows = true;
        joints_.push_back(j);
        for (const std::size_t b : other.bodies)
          if (!has(b)) bodies_.push_back(b);
      }
    }
    for (const std::size_t b : bodies_) {
      const Body& body = world.bodies[b];
      extent_ = std::max(extent_, largest_extent(body.rigid->body, body.rigid->rest_positions, dim()));
      for (Index i = body.first_node * dim(); i < (body.first_node + body.num_nodes) * dim(); ++i)
        unknowns_.push_back(i);
    }
  }

  bool has(std::size_t body) const { return std::ranges::find(bodies_, body) != bodies_.end(); }
  const std::vector<std::size_t>& joints() const { return joints_; }
  const std::vector<std::size_t>& bodies() const { return bodies_; }

  bool is_led_by_a_support() const {
    return std::ranges::any_of(unknowns_, [this](Index i) {
      const auto support = world_.support_of[static_cast<std::size_t>(i)];
      return support >= 0 && world_.supports[static_cast<std::size_t>(support)].moves();
    });
  }

  /// Takes away what the supports hold.
  void release() { is_released_ = true; }

  /// Whether a value may change, without the equations of one of the joints if it is given. True where there
  /// is too much to try.
  bool moves(const JointCoordinate& value, const Joint* without = nullptr) const {
    const VectorX& X = world_.rest_positions;
    Dense A;
    VectorX gaps;
    equations(X, without, A, gaps);
    const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(dense::transposed_product(A, A));
    const double smallest = negligible * negligible * eigen.values.maxCoeff();
    const Eigen::Index num_free = (eigen.values.array() <= smallest).count();
    const Dense free = eigen.vectors.leftCols(num_free);
    const VectorX slope = slope_of(value, X);
    if ((free.transpose() * slope).norm() > negligible * slope.norm()) return true;
    if (num_free > most_free) return true;
    // At a dead centre the value changes by the square of a motion.
    for (Eigen::Index k = 0; k < num_free; ++k)
      for (const double sign : {-1.0, 1.0})
        if (moves_along(value, without, sign * free.col(k))) return true;
    return false;
  }

 private:
  int dim() const { return world_.dimension; }

  VectorX gathered(const VectorX& of_world) const {
    VectorX own(static_cast<Eigen::Index>(unknowns_.size()));
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
      own[static_cast<Eigen::Index>(i)] = of_world[unknowns_[i]];
    return own;
  }
  void clear(VectorX& of_world) const {
    for (const Index i : unknowns_) of_world[i] = 0;
  }
  VectorX slope_of(const JointCoordinate& value, const VectorX& x) const {
    VectorX slope = VectorX::Zero(x.size());
    value.add_forces(value.slopes(x), slope);
    return gathered(slope);
  }

  /// Rows of slopes of all equations, of length 1, and by how much they are open [m].
  void equations(const VectorX& x, const Joint* without, Dense& A, VectorX& gaps) const {
    std::vector<VectorX> rows;
    std::vector<double> open;
    const auto add = [&](const VectorX& row, double gap) {
      const double length = row.norm();
      if (!(length > 0)) return;
      rows.push_back(row / length);
      open.push_back(gap / length);
    };
    const VectorX& X = world_.rest_positions;
    VectorX row = VectorX::Zero(x.size());
    for (const std::size_t b : bodies_) {
      const Body& body = world_.bodies[b];
      for (Index i = body.first_node; i < body.first_node + body.num_nodes; ++i)
        for (Index j = body.first_node; j < i; ++j) {
          const Vector3 side = node_position(dim(), i, x) - node_position(dim(), j, x);
          const double rest = (node_position(dim(), i, X) - node_position(dim(), j, X)).norm();
          row.segment(Eigen::Index{i} * dim(), dim()) = side.head(dim());
          row.segment(Eigen::Index{j} * dim(), dim()) = -side.head(dim());
          add(gathered(row), 0.5 * (side.squaredNorm() - rest * rest));
          clear(row);
        }
    }
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
      if (!is_released_ && world_.support_of[static_cast<std::size_t>(unknowns_[i])] >= 0)
        add(VectorX::Unit(static_cast<Eigen::Index>(unknowns_.size()), static_cast<Eigen::Index>(i)),
            x[unknowns_[i]] - X[unknowns_[i]]);
    for (const std::size_t number : joints_) {
      const Joint& joint = world_.joints[number];
      if (&joint == without) continue;
      for (const Joint::Row& each : joint.rows)
        for (int k = 0; k < (each.direction ? 1 : dim()); ++k) {
          const Vector3 direction = each.direction.value_or(Vector3::Unit(k));
          double gap = 0;
          for (const auto& [node, weight] : each.nodes) {
            row.segment(Eigen::Index{node} * dim(), dim()) += weight * direction.head(dim());
            gap += weight * direction.dot(node_position(dim(), node, x) - node_position(dim(), node, X));
          }
          add(gathered(row), gap);
          clear(row);
        }
      for (const JointCoordinate& gap : joint.gaps) add(slope_of(gap, x), gap.change(X, x));
      if (joint.distance) {
        joint.distance->path().add_slopes(x, std::vector<double>{1}, row);
        add(gathered(row), joint.distance->length(x) - joint.rest_distance);
        clear(row);
      }
    }
    A.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(unknowns_.size()));
    gaps = Eigen::Map<const VectorX>(open.data(), static_cast<Eigen::Index>(open.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) A.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }

  /// Whether the value changes by a motion that begins so and closes all loops. True where none is found that
  /// does.
  bool moves_along(const JointCoordinate& value, const Joint* without, const VectorX& direction) const {
    const VectorX& X = world_.rest_positions;
    VectorX x = X, gaps;
    const auto move = [&](const VectorX& by) {
      for (std::size_t i = 0; i < unknowns_.size(); ++i) x[unknowns_[i]] += by[static_cast<Eigen::Index>(i)];
    };
    move(trial_motion * extent_ / direction.cwiseAbs().maxCoeff() * direction);
    for (int k = 0; k < most_iterations; ++k) {
      Dense A;
      equations(x, without, A, gaps);
      if (gaps.cwiseAbs().maxCoeff() <= closed * extent_)
        return std::abs(value.change(X, x)) > notable_change * (value.is_angle() ? 1 : extent_);
      const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(dense::transposed_product(A, A));
      const double smallest = negligible * negligible * eigen.values.maxCoeff();
      VectorX parts = eigen.vectors.transpose() * (A.transpose() * gaps);
      for (Eigen::Index i = 0; i < parts.size(); ++i)
        parts[i] = eigen.values[i] > smallest ? -parts[i] / eigen.values[i] : 0;
      move(eigen.vectors * parts);
    }
    return true;
  }

  const World& world_;
  std::vector<std::size_t> joints_, bodies_;
  std::vector<Index> unknowns_;
  double extent_ = 0;  ///< extent of the largest body [m]
  bool is_released_ = false;
};

std::string quoted(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) all.push_back('"' + name + '"');
  return join(all, " and ");
}

}  // namespace

std::vector<std::string> locked_motors(const Description& description, const World& world) {
  std::vector<std::string> lines;
  constexpr std::size_t most_bodies = 8;  // the equations are dense
  for (std::size_t j = 0; j < world.joints.size(); ++j) {
    const JointDescription& given = description.joints[j];
    const Joint& joint = world.joints[j];
    if (!given.motor) continue;
    Mechanism mechanism(world, j);
    if (mechanism.bodies().size() > most_bodies || mechanism.is_led_by_a_support()) continue;
    const JointCoordinate value = coordinate_of(joint, world.dimension);
    if (mechanism.moves(value)) continue;
    std::vector<std::string> others, blamed, bodies;
    for (const std::size_t other : mechanism.joints()) {
      if (other == j) continue;
      others.push_back(world.joints[other].name);
      if (mechanism.moves(value, &world.joints[other])) blamed.push_back(world.joints[other].name);
    }
    for (const std::size_t body : joint.bodies) bodies.push_back(world.bodies[body].name);
    const std::string start = given.place + ".motor: \"" + joint.name + "\" is locked: ";
    mechanism.release();
    if (blamed.empty() && mechanism.moves(value)) {
      lines.push_back(start + "[[fix]] holds " + quoted(bodies) +
                      "; hold another body, or leave the motor out");
      continue;
    }
    const std::vector<std::string>& locking = blamed.empty() ? others : blamed;
    const bool are_several = locking.size() > 1;
    lines.push_back(start + (are_several ? "the joints " : "the joint ") + quoted(locking) +
                    (are_several ? " hold " : " holds ") + quoted(bodies) +
                    (blamed.empty()
                         ? "; leave several of these joints out, or take kinds that leave more free"
                     : are_several ? "; leave one of these joints out, or take a kind that leaves more free"
                                   : "; leave it out, or take a kind of joint that leaves more free"));
  }
  return lines;
}

}  // namespace resilin
