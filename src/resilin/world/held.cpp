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

/// One part for each connected component of the body, with what holds it.
std::vector<Part> parts_of(const World& world, const Body& body, const std::vector<std::uint8_t>& is_held,
                           const std::vector<const HeldDirection*>& held_directions) {
  const int dim = world.dimension;
  const int num_motions = dim == 3 ? 6 : 3;
  CellBlock block{.kind = body.cell_kind, .nodes = body.cells};
  for (Index& node : block.nodes) node -= body.first_node;
  const Components components = connected_components(block, body.num_nodes);
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
  /// Lengths in units of the part's size, so that all motions count alike.
  const auto motions_of = [&](const Part& part, Index node) {
    return rigid_motions(dim, (node_position(dim, node, world.rest_positions) - part.center) / part.size);
  };
  for_each_vertex([&](Part& part, Index node) {
    const RigidMotions motions = motions_of(part, node);
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
                motions_of(parts[static_cast<std::size_t>(own)], node);
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
  for (const LooseBody& loose : loose_bodies(world, is_held, held_directions)) {
    const Body& body = *loose.body;
    for (std::size_t p = 0; p < loose.parts.size(); ++p) {
      const Part& part = loose.parts[p];
      const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(part.gram);
      const Eigen::Index num_free = num_free_motions(eigen);
      if (num_free == 0) continue;
      std::string where = "body \"" + body.name + "\"";
      if (loose.parts.size() > 1) {
        where += ", component " + std::to_string(p + 1) + " (" + std::to_string(part.num_vertices) +
                 " vertices around " + world.place_text(world.origin + part.center) + ")";
      }
      const std::vector<std::string> names = names_of_motions(world, part, eigen.vectors.leftCols(num_free));
      const auto starts_with = [&](const char* word) {
        return std::ranges::any_of(names, [&](const std::string& name) { return name.starts_with(word); });
      };
      throw InputError(world.place, where + " is not constrained: " + std::to_string(num_free) + " of " +
                                        std::to_string(part.gram.rows()) +
                                        " rigid-body motions are free in a static analysis: " + join(names) +
                                        "; " +
                                        cure(dim, starts_with("translation"), starts_with("rotation")) +
                                        (world.colliders.empty() && !world.contact ? "" : about_contact));
    }
  }
}

}  // namespace resilin
