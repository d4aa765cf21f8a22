#include "resilin/world/constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/mortar.hpp"
#include "resilin/world/rigid_region.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

using Weight = Dependents::Weight;
using Constant = LinearConstraints::Constant;

std::vector<std::string> names_of(const std::vector<Support>& supports) {
  std::vector<std::string> names;
  for (const Support& support : supports) names.push_back(support.name);
  return names;
}

/// Makes the relations of one world.
class Maker {
 public:
  Maker(const World& world, std::span<const BodyMesh> meshes)
      : world_(world),
        meshes_(meshes),
        dim_(world.dimension),
        support_of_(supports_of_unknowns(dim_, world.num_nodes(), world.supports)),
        system_(dim_, world.rest_positions, support_of_, names_of(world.supports)) {}

  /// The nodes of a rigid region follow the control nodes of its body.
  void add_rigid_region(const Body& rigid, const std::string& place);
  void add(const TieDescription& tie);
  void add(const ConstraintDescription& constraint);
  void add(const JointDescription& description, const Joint& joint);
  std::shared_ptr<const LinearConstraints> build() const {
    const std::shared_ptr<LinearConstraints> all = system_.build();
    if (all) {
      all->tied_bodies = tied_bodies_;
      all->joints = joint_owner_;
    }
    return all;
  }

 private:
  std::vector<Index> nodes_of(const Where& where, std::size_t body, const std::string& place) const;
  CellBlock facets_of(const Where& where, std::size_t body, const std::string& place) const;
  void tie_component(std::size_t owner, int component, const std::vector<MortarRow>& rows, bool closes_gap,
                     const std::string& place);
  void add_equal(const ConstraintDescription& constraint);
  void add_sum(const ConstraintDescription& constraint);
  void add_periodic(const ConstraintDescription& constraint);

  const World& world_;
  std::span<const BodyMesh> meshes_;
  int dim_;
  std::vector<std::int32_t> support_of_;
  RelationSystem system_;
  std::vector<std::array<std::size_t, 2>> tied_bodies_;
  std::ptrdiff_t joint_owner_ = -1;
};

std::vector<Index> Maker::nodes_of(const Where& where, std::size_t body, const std::string& place) const {
  std::vector<Index> nodes =
      select_vertices(where, meshes_[body].mesh, world_.bodies[body], world_.rest_positions, dim_, place);
  for (Index& node : nodes) node += world_.bodies[body].first_node;
  return nodes;
}

CellBlock Maker::facets_of(const Where& where, std::size_t body, const std::string& place) const {
  const std::vector<Index> vertices =
      select_vertices(where, meshes_[body].mesh, world_.bodies[body], world_.rest_positions, dim_, place);
  return select_facets(where, vertices, world_.bodies[body], world_.rest_positions, dim_, place);
}

void Maker::add_rigid_region(const Body& rigid, const std::string& place) {
  const std::size_t owner = system_.add_name("");
  for (const Index node : followers_of(world_, rigid)) {
    const VectorX shares = rigid.rigid->weights(node_position(dim_, node, world_.rest_positions));
    for (int k = 0; k < dim_; ++k) {
      std::vector<Weight> by;
      for (Eigen::Index a = 0; a < shares.size(); ++a)
        by.push_back({(rigid.first_node + static_cast<Index>(a)) * dim_ + k, shares[a]});
      if (!system_.is_taken(node * dim_ + k)) {
        system_.follow(owner, node * dim_ + k, std::move(by), {}, place);
        continue;
      }
      // A vertex of two rigid regions joins them.
      by.push_back({node * dim_ + k, -1});
      system_.add_equation(owner, std::move(by), {}, place);
    }
  }
}

void Maker::add(const TieDescription& tie) {
  const auto& [follower, leader] = tie.surfaces;
  const std::size_t body = find_body(world_, follower.body, follower.place + ".body");
  const std::size_t to = find_body(world_, leader.body, leader.place + ".body");
  if (body == to) throw InputError(leader.place + ".body", "another body", "\"" + leader.body + "\" twice");
  if (tie.max_distance) require_positive(*tie.max_distance, tie.place + ".max_distance");
  tied_bodies_.push_back({body, to});
  const CellBlock facets = facets_of(follower.where, body, follower.place + ".where");
  const CellBlock leading = facets_of(leader.where, to, leader.place + ".where");
  const double max_distance = tie.max_distance.value_or(0.5 * mean_size(dim_, facets, world_.rest_positions));
  const auto is_plain = [&](Index node) {
    for (int k = 0; k < dim_; ++k)
      if (system_.is_taken(node * dim_ + k)) return true;
    return false;
  };
  const std::vector<MortarRow> rows =
      mortar_rows(dim_, facets, leading, world_.rest_positions, max_distance, is_plain, tie.place);
  const std::size_t owner = system_.add_name(tie.name);
  for (int k = 0; k < dim_; ++k) tie_component(owner, k, rows, tie.closes_gap, tie.place);
}

// A node that is prescribed, or follows something else, has no row of its own: its dual function goes to
// those of the next free nodes, so that all of them together still sum to one.
void Maker::tie_component(std::size_t owner, int component, const std::vector<MortarRow>& rows,
                          bool closes_gap, const std::string& place) {
  std::map<Index, std::size_t> row_of;
  for (std::size_t i = 0; i < rows.size(); ++i) row_of[rows[i].node] = i;
  const auto unknown = [&](Index node) { return node * dim_ + component; };
  std::vector<bool> is_known;
  for (const MortarRow& row : rows) is_known.push_back(system_.is_taken(unknown(row.node)));
  if (std::ranges::find(is_known, false) == is_known.end())
    throw InputError(place, "a surface with vertices that are free to follow",
                     "one whose vertices are all prescribed or follow something else",
                     "let the other surface follow");
  // Each known row is shared by the free ones that are fewest neighbours away.
  std::vector<std::vector<std::pair<std::size_t, double>>> taken(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!is_known[i]) continue;
    std::set<std::size_t> seen = {i}, ring = {i}, free;
    while (free.empty() && !ring.empty()) {
      std::set<std::size_t> next;
      for (const std::size_t at : ring)
        for (const Index node : rows[at].neighbours)
          if (const std::size_t other = row_of.at(node); seen.insert(other).second) next.insert(other);
      for (const std::size_t other : next)
        if (!is_known[other]) free.insert(other);
      ring = std::move(next);
    }
    for (const std::size_t other : free) taken[other].emplace_back(i, 1.0 / static_cast<double>(free.size()));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (is_known[i]) continue;
    const MortarRow& row = rows[i];
    if (!(row.own > 0))
      throw InputError(place, "a tied edge that is prescribed as a whole or not at all",
                       "vertex " + std::to_string(row.node), "prescribe all of its vertices, or none");
    const double share = row.share_of_ends, part = (1 - 2 * share) / row.own;
    std::vector<Weight> by;
    for (const auto& [node, weight] : row.of_leader) by.push_back({unknown(node), part * weight});
    for (const auto& [other, of_it] : taken[i]) {
      for (const auto& [node, weight] : rows[other].of_leader)
        by.push_back({unknown(node), part * of_it * weight});
      by.push_back({unknown(rows[other].node), -part * of_it * rows[other].own});
    }
    for (const Index end : row.ends)
      if (share != 0) by.push_back({unknown(end), share});
    double gap = world_.rest_positions[unknown(row.node)];
    for (const Weight& weight : by) gap -= weight.value * world_.rest_positions[weight.unknown];
    std::vector<Constant> constants;
    if (closes_gap) constants.push_back({-1, -gap});
    system_.follow(owner, unknown(row.node), std::move(by), std::move(constants), place);
  }
}

void Maker::add(const ConstraintDescription& constraint) {
  switch (constraint.kind) {
    case ConstraintKind::equal:
      return add_equal(constraint);
    case ConstraintKind::equation:
      return add_sum(constraint);
    case ConstraintKind::periodic:
      return add_periodic(constraint);
  }
}

// One owner stands for all joints: their forces are found together (joint.hpp).
void Maker::add(const JointDescription& description, const Joint& joint) {
  if (joint_owner_ < 0) joint_owner_ = static_cast<std::ptrdiff_t>(system_.add_name(""));
  const auto add_equation = [&](std::vector<Weight> terms) {
    try {
      system_.add_equation(static_cast<std::size_t>(joint_owner_), std::move(terms), {}, description.place);
    } catch (const InputError&) {
      throw InputError(description.place, "a joint with a body that boundary conditions leave free to follow",
                       "one between points that [[fix]] and other joints hold",
                       "leave the joint or a [[fix]] out");
    }
  };
  for (const Joint::Row& row : joint.rows) {
    std::vector<Weight> terms;
    for (int k = 0; k < dim_; ++k) {
      for (const auto& [node, weight] : row.nodes)
        if (const double share = row.direction ? (*row.direction)[k] : 1; share != 0)
          terms.push_back({node * dim_ + k, share * weight});
      if (!row.direction) add_equation(std::exchange(terms, {}));
    }
    if (row.direction) add_equation(std::move(terms));
  }
}

void Maker::add_equal(const ConstraintDescription& constraint) {
  const std::size_t body = find_body(world_, constraint.body, constraint.place + ".body");
  const std::vector<Index> nodes = nodes_of(constraint.where, body, constraint.place + ".where");
  const std::size_t owner = system_.add_name(constraint.name);
  for (int k = 0; k < dim_; ++k) {
    if (!constraint.components[static_cast<std::size_t>(k)]) continue;
    for (std::size_t i = 1; i < nodes.size(); ++i)
      system_.add_equation(owner, {{nodes[i] * dim_ + k, 1}, {nodes[0] * dim_ + k, -1}}, {},
                           constraint.place);
  }
}

void Maker::add_sum(const ConstraintDescription& constraint) {
  const std::size_t owner = system_.add_name(constraint.name);
  std::vector<Weight> terms;
  for (const ConstraintTerm& term : constraint.terms) {
    require_axis(term.axis, dim_, term.place + ".axis");
    const std::size_t body = find_body(world_, term.body, term.place + ".body");
    const std::vector<Index> nodes = nodes_of(term.where, body, term.place + ".where");
    for (const Index node : nodes)
      terms.push_back({node * dim_ + term.axis, term.coefficient / static_cast<double>(nodes.size())});
  }
  std::vector<Constant> constants;
  if (constraint.value != 0)
    constants.push_back({system_.add_function(constraint.time_function), constraint.value});
  system_.add_equation(owner, std::move(terms), std::move(constants), constraint.place);
}

// u(X + L e) = u(X) + H L e for opposite faces of the box around the body. A vertex on an edge of the box has
// several partners: the equations of one of them say again what the others say.
void Maker::add_periodic(const ConstraintDescription& constraint) {
  const std::size_t b = find_body(world_, constraint.body, constraint.place + ".body");
  const Body& body = world_.bodies[b];
  const VectorX& X = world_.rest_positions;
  const double tolerance = 1e-6 * largest_extent(body, X, dim_);
  const int function = constraint.gradient.isZero(0) ? -1 : system_.add_function(constraint.time_function);
  const std::set<Index> used(body.cells.begin(), body.cells.end());
  std::optional<std::size_t> first_of_cell;
  for (int axis = 0; axis < dim_; ++axis) {
    if (!constraint.components[static_cast<std::size_t>(axis)]) continue;
    const Reach reach = reach_along(axis, body, X, dim_);
    const std::size_t owner = system_.add_name(constraint.name + "." + "xyz"[axis]);
    if (!first_of_cell) first_of_cell = owner;
    system_.add_face(owner, axis, reach.length(), *first_of_cell);
    const auto at = [&](Index node) { return X[Eigen::Index{node} * dim_ + axis]; };
    std::map<std::array<std::int64_t, 2>, std::vector<Index>> low;  // by cells of a grid
    const auto cell_of = [&](Index node) {
      std::array<std::int64_t, 2> cell = {0, 0};
      for (int k = 0, i = 0; k < dim_; ++k)
        if (k != axis)
          cell[static_cast<std::size_t>(i++)] =
              std::llround(X[Eigen::Index{node} * dim_ + k] / (4 * tolerance));
      return cell;
    };
    std::vector<Index> high;
    std::size_t num_low = 0;
    for (const Index node : used) {
      if (at(node) <= reach.low + tolerance) {
        low[cell_of(node)].push_back(node);
        ++num_low;
      }
      if (at(node) >= reach.high - tolerance) high.push_back(node);
    }
    const auto partner_of = [&](Index node) -> Index {
      const Vector3 there = node_position(dim_, node, X) - reach.length() * Vector3::Unit(axis);
      const auto middle = cell_of(node);
      for (std::int64_t i = -1; i <= 1; ++i)
        for (std::int64_t j = -1; j <= 1; ++j) {
          const auto found = low.find({middle[0] + i, middle[1] + j});
          if (found == low.end()) continue;
          for (const Index other : found->second)
            if ((node_position(dim_, other, X) - there).norm() <= 2 * tolerance) return other;
        }
      return -1;
    };
    const std::string faces =
        std::string(1, "xyz"[axis]) + " = " + format_short(reach.low) + " and " + format_short(reach.high);
    for (const Index node : high) {
      const Index partner = partner_of(node);
      if (partner < 0)
        throw InputError(constraint.place, "a partner for each vertex on the faces " + faces,
                         "none for " + world_.place_text(node, X), "take a mesh whose opposite faces match");
      const Vector3 jump =
          constraint.gradient * (node_position(dim_, node, X) - node_position(dim_, partner, X));
      for (int k = 0; k < dim_; ++k) {
        std::vector<Constant> constants;
        if (jump[k] != 0) constants.push_back({function, jump[k]});
        system_.add_equation(owner, {{node * dim_ + k, 1}, {partner * dim_ + k, -1}}, std::move(constants),
                             constraint.place);
      }
    }
    if (num_low != high.size())
      throw InputError(constraint.place, "as many vertices on both faces " + faces,
                       std::to_string(num_low) + " and " + std::to_string(high.size()),
                       "take a mesh whose opposite faces match");
  }
}

}  // namespace

std::shared_ptr<const LinearConstraints> make_constraints(const Description& description, const World& world,
                                                          std::span<const BodyMesh> meshes) {
  if (description.ties.empty() && description.constraints.empty() && description.joints.empty() &&
      place_of_rigid_region(description).empty())
    return nullptr;
  Maker maker(world, meshes);
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    if (const Body& body = world.bodies[b]; body.rigid && body.rigid->is_region())
      maker.add_rigid_region(body, description.bodies[b].place);
  // Equations choose who follows, ties do not.
  for (const TieDescription& tie : description.ties) maker.add(tie);
  for (const ConstraintDescription& constraint : description.constraints) maker.add(constraint);
  for (std::size_t i = 0; i < world.joints.size(); ++i) maker.add(description.joints[i], world.joints[i]);
  return maker.build();
}

std::vector<Index> followers_of(const World& world, const Body& rigid) {
  const Body& body = world.bodies[find_body(world, rigid.rigid->region_of, rigid.name)];
  for (const Domain& domain : body.domains) {
    if (!domain.is_rigid || body.name + "." + domain.name != rigid.name) continue;
    std::vector<Index> nodes(domain.cells.begin(), domain.cells.end());
    std::ranges::sort(nodes);
    nodes.erase(std::ranges::unique(nodes).begin(), nodes.end());
    return nodes;
  }
  return {};
}

ContactDescription contact_beside_ties(const Description& description) {
  ContactDescription contact = description.contact;
  const auto with_surface = [&](const std::string& name) {
    for (const BodyDescription& body : description.bodies)
      if (body.name == name && body.rigid && !body.rigid->region_of.empty()) return body.rigid->region_of;
    return name;
  };
  const auto part = [&contact](const std::string& place, const std::string& a, const std::string& b) {
    const auto is_theirs = [&](const ContactPairDescription& pair) {
      return (pair.bodies[0] == a && pair.bodies[1] == b) || (pair.bodies[0] == b && pair.bodies[1] == a);
    };
    if (std::ranges::none_of(contact.pairs, is_theirs))
      contact.pairs.push_back({.place = place, .bodies = {a, b}, .is_enabled = false, .friction = {}});
  };
  for (const TieDescription& tie : description.ties)
    part(tie.place, tie.surfaces[0].body, tie.surfaces[1].body);
  for (const JointDescription& joint : description.joints)
    if (joint.bodies.size() == 2 && joint.kind != JointKind::distance)
      if (const std::string a = with_surface(joint.bodies[0]), b = with_surface(joint.bodies[1]); a != b)
        part(joint.place, a, b);
  for (const BodyDescription& body : description.bodies)
    if (with_surface(body.name) != body.name)
      for (const BodyDescription& other : description.bodies) part(body.place, body.name, other.name);
  return contact;
}

void refuse_constraints(const Description& description, const std::string& what) {
  std::string place;
  if (!description.ties.empty()) place = description.ties.front().place;
  if (place.empty() && !description.constraints.empty()) place = description.constraints.front().place;
  if (!place.empty())
    throw InputError(place, "a scene without ties and constraints for " + what, "one with them",
                     "leave them out, or run it as a static or dynamic scene");
  if (place = place_of_rigid_region(description); !place.empty())
    throw InputError(place, "a scene without rigid regions for " + what, "one",
                     "give the region a stiff material, or run it as a static or dynamic scene");
  if (!description.joints.empty()) place = description.joints.front().place;
  if (!description.springs.empty()) place = description.springs.front().place;
  if (!description.cables.empty()) place = description.cables.front().place;
  if (!place.empty())
    throw InputError(place, "a scene without joints, springs and cables for " + what, "one with them",
                     "leave them out, or run it as a static or dynamic scene");
}

}  // namespace resilin
