// Rigid motions of a body that no boundary condition holds.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "resilin/core/dense.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/rigid_motions.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "resilin/world/world.hpp"

namespace resilin {
namespace {

constexpr const char* about_contact =
    "; contact (with a collider or a constrained body) constrains a body only within the activation distance "
    "at the start, and tangentially only by friction";
constexpr double round_off =
    1e-6;  ///< round off of a direction: the square root of what the Gram matrix leaves

struct Part {
  Vector3 center = Vector3::Zero();
  double size = 0;
  Index num_vertices = 0;
  Eigen::MatrixXd gram;  ///< sum of r^T r over the held components: its rank is the number of held motions
};

/// Zero where only rounding is left of numbers of this size.
Vector3 without_round_off(const Vector3& v, double size) {
  return (v.array().abs() < 1e-12 * size).select(0, v);
}

/// An orthonormal basis of what these vectors span.
std::vector<Vector3> orthonormal_basis(std::vector<Vector3> vectors) {
  std::vector<Vector3> basis;
  while (!vectors.empty()) {
    const auto longest = std::ranges::max_element(vectors, {}, [](const Vector3& v) { return v.norm(); });
    if (!(longest->norm() > round_off)) break;
    const Vector3 direction = longest->normalized();
    basis.push_back(direction);
    for (Vector3& v : vectors) v -= direction * direction.dot(v);
  }
  return basis;
}

/// A basis of the space with this orthonormal one, of coordinate axes as far as they lie in it.
std::vector<Vector3> simple_basis(std::vector<Vector3> space) {
  std::vector<Vector3> basis;
  const auto take = [&](const Vector3& direction) {
    basis.push_back(direction);
    for (Vector3& v : space) v -= direction * direction.dot(v);
    space = orthonormal_basis(std::move(space));
  };
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 e = Vector3::Unit(axis);
    Vector3 outside = e;
    for (const Vector3& v : space) outside -= v * v.dot(e);
    if (outside.norm() < round_off) take(e);
  }
  while (!space.empty()) {
    Vector3 direction = space.front();
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    if (direction[largest] < 0) direction = -direction;
    take(direction);
  }
  return basis;
}

/// "x", or "(0.6, 0.8, 0)" for another direction.
std::string name_of(const Vector3& direction, int dim) {
  for (int axis = 0; axis < dim; ++axis) {
    if (std::abs(direction[axis]) > 1 - round_off) return {"xyz"[axis]};
  }
  return format_point(without_round_off(direction, 1), dim);
}

/// Solves A^T A r = A^T b, the shortest r where there are several.
Vector3 least_squares(const Matrix<3>& AtA, const Vector3& Atb) {
  const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(AtA);
  Vector3 r = Vector3::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vector3 direction = eigen.vectors.col(k);
    if (eigen.values[k] > round_off * round_off) r += direction * (direction.dot(Atb) / eigen.values[k]);
  }
  return r;
}

/// b + a x r: a turn about the axis a through a x b, for b orthogonal to a.
struct Turn {
  std::string name;
  Vector3 axis = Vector3::UnitZ();
  Vector3 shift = Vector3::Zero();
};

/// The point that no turn moves, the nearest to the center, if there is one.
std::optional<Vector3> common_point(const std::vector<Turn>& turns) {
  Matrix<3> AtA = Matrix<3>::Zero();
  Vector3 Atb = Vector3::Zero();
  for (const Turn& turn : turns) {  // axis x r = -shift
    AtA += Matrix<3>::Identity() - turn.axis * turn.axis.transpose();
    Atb += turn.axis.cross(turn.shift);
  }
  Vector3 r = least_squares(AtA, Atb);
  for (const Turn& turn : turns) {
    if ((turn.axis.cross(r) + turn.shift).norm() > round_off * (1 + turn.shift.norm())) return std::nullopt;
  }
  return r;
}

/// The motions that the columns of `free` span (orthonormal, in the basis of `rigid_motions`), in words.
std::vector<std::string> names_of_motions(const World& world, const Part& part, const Eigen::MatrixXd& free) {
  const int dim = world.dimension;
  std::vector<std::string> names;
  // Combinations that do not turn are translations; the others turn about their rotational part.
  const Eigen::Index num_rotations = free.rows() - dim;
  const auto rotational_part = [&](Eigen::Index k) {
    Vector3 rotation = Vector3::Zero();
    rotation.head(num_rotations) = free.col(k).tail(num_rotations);
    return rotation;
  };
  Matrix<3> products = Matrix<3>::Zero();
  std::vector<Vector3> rotations;
  for (Eigen::Index k = 0; k < free.cols(); ++k) {
    rotations.push_back(rotational_part(k));
    products += rotations.back() * rotations.back().transpose();
  }
  /// The motion of `free` with this rotational part that shifts least.
  const auto motion_with = [&](const Vector3& rotation) {
    const Vector3 multipliers = least_squares(products, rotation);
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(free.rows());
    for (std::size_t k = 0; k < rotations.size(); ++k)
      motion += rotations[k].dot(multipliers) * free.col(static_cast<Eigen::Index>(k));
    return motion;
  };
  std::vector<Vector3> shifts;
  for (std::size_t k = 0; k < rotations.size(); ++k) {
    const Eigen::VectorXd motion = free.col(static_cast<Eigen::Index>(k)) - motion_with(rotations[k]);
    shifts.push_back(Vector3::Zero());
    shifts.back().head(dim) = motion.head(dim);
  }
  shifts = orthonormal_basis(std::move(shifts));
  for (const Vector3& direction : simple_basis(shifts))
    names.push_back("translation along " + name_of(direction, dim));
  std::vector<Turn> list;
  for (const Vector3& direction : simple_basis(orthonormal_basis(rotations))) {
    Turn turn{.name = dim == 2 ? "rotation" : "rotation about " + name_of(direction, dim)};
    if (dim == 3) turn.axis = direction;
    turn.shift.head(dim) = motion_with(direction).head(dim);
    list.push_back(std::move(turn));
  }
  if (list.empty()) return names;
  const bool axis_is_anywhere = shifts.size() >= 2;
  const std::optional<Vector3> common = common_point(list);
  for (const Turn& turn : list) {
    const Vector3 r = common ? *common : Vector3(turn.axis.cross(turn.shift));
    const Vector3 through = world.origin + part.center + part.size * r;
    names.push_back(turn.name);
    if (axis_is_anywhere) continue;
    names.back() += (dim == 2 ? " about " : " through ") +
                    world.place_text(without_round_off(through, part.size + through.norm()));
  }
  return names;
}

std::string cure(int dim, bool shifts, bool turns) {
  std::string text;
  if (shifts && turns) {
    text = dim == 3 ? "add a [[fix]] on a face, or on three vertices that are not in a line"
                    : "add a [[fix]] on an edge, or on two vertices";
  } else if (shifts) {
    text = "add a [[fix]] of one vertex in these directions (components = \"...\")";
  } else {
    text = "add a [[fix]] on a vertex away from " +
           std::string(dim == 3 ? "the axis, in a direction across it" : "this point");
  }
  return text + "; or let simulation.kind be \"dynamic\"";
}

Components components_of(const Body& body) {
  CellBlock block{.kind = body.cell_kind, .nodes = body.cells};
  for (Index& node : block.nodes) node -= body.first_node;
  return connected_components(block, body.num_nodes);
}

/// Motions of a part at a node, with lengths in units of the part's size, so that all motions count alike.
RigidMotions motions_of(const World& world, const Part& part, Index node) {
  const Vector3 X = node_position(world.dimension, node, world.rest_positions);
  return rigid_motions(world.dimension, (X - part.center) / part.size);
}

/// One part for each connected component of the body, with what holds it.
std::vector<Part> parts_of(const World& world, const Body& body, const std::vector<std::uint8_t>& is_held,
                           const std::vector<const HeldDirection*>& held_directions) {
  const int dim = world.dimension;
  const int num_motions = dim == 3 ? 6 : 3;
  const Components components = components_of(body);
  std::vector<Part> parts(static_cast<std::size_t>(components.count));
  const auto for_each_vertex = [&](const auto& visit) {
    for (Index v = 0; v < body.num_nodes; ++v) {
      const Index part = components.of_vertex[static_cast<std::size_t>(v)];
      if (part >= 0) visit(parts[static_cast<std::size_t>(part)], body.first_node + v);
    }
  };
  for_each_vertex([&](Part& part, Index node) {
    part.center += node_position(dim, node, world.rest_positions);
    ++part.num_vertices;
  });
  for (Part& part : parts) part.center /= part.num_vertices;
  for_each_vertex([&](Part& part, Index node) {
    part.size = std::max(part.size, (node_position(dim, node, world.rest_positions) - part.center).norm());
  });
  for (Part& part : parts) part.gram = Eigen::MatrixXd::Zero(num_motions, num_motions);
  // In axisymmetric solids only the way along the axis is a rigid-body motion.
  if (is_axisymmetric(world))
    for (Part& part : parts) part.gram(0, 0) = part.gram(2, 2) = 1;
  for_each_vertex([&](Part& part, Index node) {
    const RigidMotions motions = motions_of(world, part, node);
    for (int k = 0; k < dim; ++k) {
      if (is_held[static_cast<std::size_t>(node * dim + k)] == 0) continue;
      part.gram += motions.row(k).transpose() * motions.row(k);
    }
  });
  for (const HeldDirection* held : held_directions) {
    Index number = -1;
    Eigen::RowVectorXd motion = Eigen::RowVectorXd::Zero(num_motions);
    bool is_of_one_part = true;
    for (const auto& [node, weight] : held->nodes) {
      const Index v = node - body.first_node;
      if (v < 0 || v >= body.num_nodes) continue;  // belongs to another body, which is held
      const Index own = components.of_vertex[static_cast<std::size_t>(v)];
      if (own < 0) continue;  // a vertex that no cell uses
      is_of_one_part = is_of_one_part && (number < 0 || own == number);
      number = own;
      motion += weight * held->direction.head(dim).transpose() *
                motions_of(world, parts[static_cast<std::size_t>(own)], node);
    }
    if (number < 0 || !is_of_one_part) continue;
    parts[static_cast<std::size_t>(number)].gram += motion.transpose() * motion;
  }
  return parts;
}

Eigen::Index num_free_motions(const dense::Eigenpairs& eigen) {
  const double largest = std::max(eigen.values.maxCoeff(), 1e-300);
  return (eigen.values.array() <= 1e-12 * largest).count();
}

struct LooseBody {
  const Body* body;
  std::vector<Part> parts;
};

/// Bodies with parts that are not held. What holds a body may be another one, if that is held without it.
std::vector<LooseBody> loose_bodies(const World& world, const std::vector<std::uint8_t>& is_held,
                                    const std::vector<HeldDirection>& directions) {
  std::vector<LooseBody> loose;
  for (const Body& body : world.bodies) loose.push_back({&body, {}});
  while (true) {
    const auto is_loose = [&](const Body& body) {
      return std::ranges::find(loose, &body, &LooseBody::body) != loose.end();
    };
    std::map<const Body*, std::vector<const HeldDirection*>> by_what_is_held;
    for (const HeldDirection& held : directions) {
      std::set<const Body*> loose_of_it;
      for (const WeightedNode& each : held.nodes)
        if (const Body& body = world.body_of(each.node); is_loose(body)) loose_of_it.insert(&body);
      if (loose_of_it.size() == 1) by_what_is_held[*loose_of_it.begin()].push_back(&held);
    }
    const std::size_t before = loose.size();
    for (LooseBody& one : loose) one.parts = parts_of(world, *one.body, is_held, by_what_is_held[one.body]);
    std::erase_if(loose, [](const LooseBody& one) {
      return std::ranges::none_of(one.parts, [](const Part& part) {
        return num_free_motions(dense::symmetric_eigenpairs(part.gram)) > 0;
      });
    });
    if (loose.empty() || loose.size() == before) return loose;
  }
}

/// A part of a body that is not held by itself, among those that are joined with it.
struct FreePart {
  const LooseBody* loose;
  std::size_t number;
  std::size_t group;  ///< number of the part that stands for all that are joined
};

/// Parts of loose bodies, and what holds them beside each other.
class JoinedParts {
 public:
  JoinedParts(const World& world, const std::vector<LooseBody>& loose) : world_(world) {
    for (const LooseBody& one : loose) {
      components_.push_back(components_of(*one.body));
      for (std::size_t p = 0; p < one.parts.size(); ++p)
        if (num_free_motions(dense::symmetric_eigenpairs(one.parts[p].gram)) > 0) {
          number_of_[{one.body, static_cast<Index>(p)}] = parts_.size();
          parts_.push_back({&one, p, parts_.size()});
        }
      component_of_[one.body] = components_.size() - 1;
    }
  }

  void add(const HeldDirection& held) {
    std::map<std::size_t, Eigen::RowVectorXd> row;
    for (const auto& [node, weight] : held.nodes) {
      const Body& body = world_.body_of(node);
      const auto components = component_of_.find(&body);
      if (components == component_of_.end()) continue;
      const Index own =
          components_[components->second].of_vertex[static_cast<std::size_t>(node - body.first_node)];
      const auto number = number_of_.find({&body, own});
      if (number == number_of_.end()) continue;
      const Part& part = part_of(parts_[number->second]);
      Eigen::RowVectorXd& motion =
          row.try_emplace(number->second, Eigen::RowVectorXd::Zero(part.gram.rows())).first->second;
      motion += weight * held.direction.head(world_.dimension).transpose() * motions_of(world_, part, node);
    }
    if (row.empty()) return;
    const std::size_t to = group_of(row.begin()->first);
    for (const auto& [number, motion] : row) parts_[group_of(number)].group = to;
    rows_.push_back(std::move(row));
  }

  struct Group {
    std::vector<const FreePart*> parts;
    Eigen::MatrixXd free;  ///< columns: motions of all parts, one after another, that nothing holds
  };
  /// Those that can move.
  std::vector<Group> free_groups() {
    std::map<std::size_t, std::vector<std::size_t>> members;
    for (std::size_t i = 0; i < parts_.size(); ++i) members[group_of(i)].push_back(i);
    std::vector<Group> groups;
    for (const auto& [number, of_group] : members) {
      const Eigen::Index size = part_of(parts_[of_group.front()]).gram.rows();
      const auto count = static_cast<Eigen::Index>(of_group.size());
      Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(count * size, count * size);
      std::map<std::size_t, Eigen::Index> begin;
      Group group;
      for (const std::size_t i : of_group) {
        const auto first = static_cast<Eigen::Index>(begin.size()) * size;
        begin[i] = first;
        gram.block(first, first, size, size) = part_of(parts_[i]).gram;
        group.parts.push_back(&parts_[i]);
      }
      for (const auto& row : rows_) {
        if (!begin.contains(row.begin()->first)) continue;
        for (const auto& [i, left] : row)
          for (const auto& [j, right] : row)
            gram.block(begin.at(i), begin.at(j), size, size) += left.transpose() * right;
      }
      const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(gram);
      const Eigen::Index num_free = num_free_motions(eigen);
      group.free = eigen.vectors.leftCols(num_free);
      if (num_free > 0) groups.push_back(std::move(group));
    }
    return groups;
  }

  static const Part& part_of(const FreePart& part) { return part.loose->parts[part.number]; }

 private:
  std::size_t group_of(std::size_t number) const {
    while (parts_[number].group != number) number = parts_[number].group;
    return number;
  }

  const World& world_;
  std::vector<FreePart> parts_;
  std::vector<Components> components_;
  std::map<const Body*, std::size_t> component_of_;
  std::map<std::pair<const Body*, Index>, std::size_t> number_of_;
  std::vector<std::map<std::size_t, Eigen::RowVectorXd>> rows_;
};

/// An orthonormal basis of what the columns span.
Eigen::MatrixXd range_of(const Eigen::MatrixXd& columns) {
  const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(columns * columns.transpose());
  const Eigen::Index rank =
      (eigen.values.array() > round_off * std::max(eigen.values.maxCoeff(), 1e-300)).count();
  return eigen.vectors.rightCols(rank);
}

/// Relations between components of one direction hold what follows beside what it follows.
void add_constraint_directions(const World& world, std::vector<HeldDirection>& held) {
  if (!world.constraints) return;
  const int dim = world.dimension;
  for (const LinearConstraints::Stated& stated : world.constraints->stated) {
    const Index component = stated.relation.unknown % dim;
    HeldDirection direction{.nodes = {{stated.relation.unknown / dim, 1}},
                            .direction = Vector3::Unit(component)};
    bool is_along_one_axis = true;
    for (const Dependents::Weight& weight : stated.relation.by) {
      is_along_one_axis = is_along_one_axis && weight.unknown % dim == component;
      direction.nodes.push_back({weight.unknown / dim, -weight.value});
    }
    if (is_along_one_axis) held.push_back(std::move(direction));
  }
}

}  // namespace

void check_is_held(const World& world) {
  const int dim = world.dimension;
  std::vector<std::uint8_t> is_held(world.is_fixed.size(), 0);
  for (std::size_t i = 0; i < is_held.size(); ++i) is_held[i] = world.support_of[i] >= 0 ? 1 : 0;
  std::vector<HeldDirection> held_directions;
  for (const auto& term : world.terms) term->add_held_directions(world.start_positions, held_directions);
  add_constraint_directions(world, held_directions);
  for (const Joint& joint : world.joints) {
    held_directions.insert(held_directions.end(), joint.held.begin(), joint.held.end());
    // Where a slanted slider precedes them, their relations above mix components.
    for (const Joint::Row& row : joint.rows)
      for (int axis = 0; axis < dim && !row.direction; ++axis)
        held_directions.push_back({.nodes = row.nodes, .direction = Vector3::Unit(axis)});
  }
  const std::vector<LooseBody> loose = loose_bodies(world, is_held, held_directions);
  if (loose.empty()) return;
  JoinedParts joined(world, loose);
  for (const HeldDirection& held : held_directions) joined.add(held);
  for (const JoinedParts::Group& group : joined.free_groups()) {
    // The first one that can move is told of, where several are joined.
    const FreePart* moves = nullptr;
    Eigen::MatrixXd free;
    for (std::size_t i = 0; moves == nullptr; ++i) {
      const Eigen::Index size = JoinedParts::part_of(*group.parts[i]).gram.rows();
      const Eigen::MatrixXd own = group.free.middleRows(static_cast<Eigen::Index>(i) * size, size);
      if (!(own.norm() > round_off)) continue;
      moves = group.parts[i];
      free = group.parts.size() == 1 ? own : range_of(own);
    }
    const Part& part = JoinedParts::part_of(*moves);
    const Body& body = *moves->loose->body;
    std::string where = "body \"" + body.name + "\"";
    if (moves->loose->parts.size() > 1) {
      where += ", component " + std::to_string(moves->number + 1) + " (" + std::to_string(part.num_vertices) +
               " vertices around " + world.place_text(world.origin + part.center) + ")";
    }
    std::vector<std::string> others;
    for (const FreePart* other : group.parts)
      if (other->loose->body != &body) others.push_back('"' + other->loose->body->name + '"');
    const std::vector<std::string> names = names_of_motions(world, part, free);
    const auto starts_with = [&](const char* word) {
      return std::ranges::any_of(names, [&](const std::string& name) { return name.starts_with(word); });
    };
    throw InputError(
        world.place,
        where + " is not constrained: " + std::to_string(free.cols()) + " of " +
            std::to_string(is_axisymmetric(world) ? 1 : part.gram.rows()) +
            " rigid-body motions are free in a static analysis: " + join(names) +
            (others.empty() ? ""
                            : "; " + join(others) + (others.size() == 1 ? " moves" : " move") + " with it") +
            "; " + cure(dim, starts_with("translation"), starts_with("rotation")) +
            (others.empty() ? "" : "; joints, springs and motors hold bodies, too") +
            (world.colliders.empty() && !world.contact ? "" : about_contact));
  }
}

}  // namespace resilin
