#include "resilin/sensitivity/body_parameters.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "resilin/sensitivity/constant_slopes.hpp"
#include "resilin/world/body_material.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

const BodyDescription& description_of(const World& world, std::size_t body) {
  return world.made_from->bodies[body];
}

/// Between numbers of a body's vertices and those of its nodes: nodes that the element adds have the mean of
/// their edge's ends.
class VertexMap {
 public:
  VertexMap(const World& world, std::size_t body_number)
      : dim_(world.dimension),
        first_(world.bodies[body_number].first_node),
        num_vertices_(world.bodies[body_number].num_vertices),
        ends_(world.bodies[body_number].ends_of_added) {}

  Eigen::Index size() const { return Eigen::Index{num_vertices_} * dim_; }
  std::vector<Eigen::Index> shape() const { return {num_vertices_, dim_}; }

  void spread(const VectorX& of_vertices, VectorX& of_world) const {
    const Eigen::Index first = Eigen::Index{first_} * dim_;
    of_world.segment(first, size()) += of_vertices;
    for (std::size_t e = 0; e < ends_.size(); ++e)
      for (const Index end : ends_[e])
        of_world.segment(first + added(e), dim_) += 0.5 * of_vertices.segment(Eigen::Index{end} * dim_, dim_);
  }
  void gather(const VectorX& of_world, VectorX& of_vertices) const {
    const Eigen::Index first = Eigen::Index{first_} * dim_;
    of_vertices += of_world.segment(first, size());
    for (std::size_t e = 0; e < ends_.size(); ++e)
      for (const Index end : ends_[e])
        of_vertices.segment(Eigen::Index{end} * dim_, dim_) += 0.5 * of_world.segment(first + added(e), dim_);
  }
  /// Numbers of the vertices, from an array of the world.
  VectorX taken(const VectorX& of_world) const {
    return of_world.segment(Eigen::Index{first_} * dim_, size());
  }

 private:
  Eigen::Index added(std::size_t e) const {
    return (Eigen::Index{num_vertices_} + static_cast<Eigen::Index>(e)) * dim_;
  }

  int dim_;
  Index first_, num_vertices_;
  std::vector<std::array<Index, 2>> ends_;
};

void make_room(VectorX& values, Eigen::Index size) {
  if (values.size() == 0) values = VectorX::Zero(size);
}

VectorX plus_origin(const World& world, VectorX positions) {
  for (Eigen::Index i = 0; i < positions.size(); ++i) positions[i] += world.origin[i % world.dimension];
  return positions;
}

std::vector<double> as_vector(const VectorX& values) { return {values.begin(), values.end()}; }

/// One number of the body, held in a member of the world's change and of the description.
Parameter number_of_body(std::size_t body, const std::string& name, double value,
                         double WorldChange::OfBody::* change, bool WorldChange::OfBody::* is_asked,
                         const std::function<double&(BodyDescription&)>& member) {
  Parameter parameter{.name = name, .shape = {}, .value = VectorX::Constant(1, value)};
  parameter.ask = [=](WorldChange& world) { world.bodies[body].*is_asked = true; };
  parameter.spread = [=](const VectorX& by, WorldChange& world) { world.bodies[body].*change += by[0]; };
  parameter.gather = [=](const WorldChange& world, VectorX& slopes) {
    slopes[0] += world.bodies[body].*change;
  };
  parameter.set = [=](const VectorX& to, Description& description) {
    member(description.bodies[body]) = to[0];
  };
  return parameter;
}

/// The material of a domain in a description.
MaterialDescription& material_in(Description& description, std::size_t body, int region) {
  BodyDescription& of = description.bodies[body];
  return region < 0 ? of.material : of.regions[static_cast<std::size_t>(region)].material;
}

/// Density of a domain.
Parameter density_of_domain(const World& world, std::size_t body, std::size_t number,
                            const std::string& name) {
  const Domain& domain = world.bodies[body].domains[number];
  Parameter parameter{.name = name, .shape = {}, .value = VectorX::Constant(1, domain.density)};
  parameter.ask = [=](WorldChange& of) { of.bodies[body].domains[number].has_density = true; };
  parameter.spread = [=](const VectorX& by, WorldChange& of) {
    of.bodies[body].domains[number].density += by[0];
  };
  parameter.gather = [=](const WorldChange& of, VectorX& slopes) {
    slopes[0] += of.bodies[body].domains[number].density;
  };
  parameter.set = [body, region = domain.region](const VectorX& to, Description& description) {
    material_in(description, body, region).density = to[0];
  };
  return parameter;
}

/// The names that `material` gives, those that it leaves to their fallback included.
std::map<std::string, double> given_numbers(const LawInfo& law, const MaterialDescription& material) {
  std::map<std::string, double> given = material.constants;
  for (const auto& [name, values] : material.cell_constants)
    given[name] = values.empty() ? 0 : values.front();
  for (const ConstantText& constant : law.constants)
    if (constant.is_free && !given.contains(std::string(constant.name)))
      given[std::string(constant.name)] = constant.fallback;
  return given;
}

Parameter constant_of_domain(const World& world, std::size_t body, std::size_t number,
                             const std::string& name, const std::string& key) {
  const Domain& domain = world.bodies[body].domains[number];
  const int region = domain.region;
  const MaterialDescription& material = material_of(description_of(world, body), region);
  const LawInfo& law = domain.law_info();
  const auto n = static_cast<Eigen::Index>(law.constants.size());
  const Eigen::Index size = domain.energy->parameters().front().size, num_sets = size / n;
  // The number in the body, which lists of the scene go by, of the cell of each set.
  const auto cell_of = [numbers = domain.numbers](Eigen::Index set) {
    return numbers ? Eigen::Index{(*numbers)[static_cast<std::size_t>(set)]} : set;
  };
  const auto of_cells = material.cell_constants.find(key);
  const bool is_field = of_cells != material.cell_constants.end();
  // d(constants)/d(number) of each set, one column for each.
  Eigen::MatrixXd slopes(n, num_sets);
  std::map<std::string, double> given = given_numbers(law, material);
  const auto column = std::distance(given.begin(), given.find(key));
  for (Eigen::Index set = 0; set < num_sets; ++set) {
    if (set > 0 && material.cell_constants.empty()) {
      slopes.col(set) = slopes.col(0);
      continue;
    }
    bool is_same = set > 0;
    for (const auto& [other, values] : material.cell_constants) {
      double& given_number = given[other];
      const double now = values[static_cast<std::size_t>(cell_of(set))];
      is_same = is_same && given_number == now;
      given_number = now;
    }
    slopes.col(set) = is_same ? slopes.col(set - 1) : constant_slopes(law, given, material.place).col(column);
  }
  Parameter parameter{.name = name, .shape = {}, .value = VectorX::Constant(1, given[key])};
  if (is_field) {
    parameter.shape = {static_cast<Eigen::Index>(of_cells->second.size())};
    parameter.value = Eigen::Map<const VectorX>(of_cells->second.data(), parameter.shape[0]);
  }
  parameter.ask = [=](WorldChange& change) {
    make_room(change.bodies[body].domains[number].constants, size);
  };
  parameter.spread = [=](const VectorX& by, WorldChange& change) {
    for (Eigen::Index set = 0; set < num_sets; ++set)
      change.bodies[body].domains[number].constants.segment(set * n, n) +=
          by[is_field ? cell_of(set) : 0] * slopes.col(set);
  };
  parameter.gather = [=](const WorldChange& change, VectorX& out) {
    for (Eigen::Index set = 0; set < num_sets; ++set)
      out[is_field ? cell_of(set) : 0] +=
          change.bodies[body].domains[number].constants.segment(set * n, n).dot(slopes.col(set));
  };
  parameter.set = [=](const VectorX& to, Description& description) {
    MaterialDescription& changed = material_in(description, body, region);
    if (to.size() == 1 && !is_field) {
      changed.cell_constants.erase(key);
      changed.constants[key] = to[0];
    } else {
      changed.constants.erase(key);
      changed.cell_constants[key] = as_vector(to);
    }
  };
  return parameter;
}

/// A selection by place, and the vertices that it has in the scene as it is.
struct Selection {
  std::size_t number;  ///< number of the fix or of the load
  std::vector<Index> vertices;
};

/// For the fixes, or loads, of a body: where its vertices move, who was selected stays so. Left out is a
/// selection that no list of vertices can say, of middles of edges without their ends.
template <class Table>
std::vector<Selection> selections_by_place(const World& world, std::size_t body_number,
                                           const std::vector<Table>& tables) {
  const Body& body = world.bodies[body_number];
  const VectorX places = plus_origin(world, world.rest_positions);
  const auto select = [&](const Where& where, const std::string& place) {
    return select_vertices(where, description_of(world, body_number).mesh, body, places, world.dimension,
                           place);
  };
  std::vector<Selection> found;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Table& table = tables[i];
    const bool is_own = table.body == body.name || (table.body.empty() && world.bodies.size() == 1);
    if (!is_own || !table.where.is_by_place()) continue;
    const std::vector<Index> nodes = select(table.where, table.place);
    Where listed;
    listed.kind = Where::Kind::vertices;
    for (const Index node : nodes)
      if (node < body.num_vertices) listed.vertices.push_back(node);
    if (!listed.vertices.empty() && select(listed, table.place) == nodes)
      found.push_back({i, std::move(listed.vertices)});
  }
  return found;
}

template <class Table>
void select_by_number(const std::vector<Selection>& selections, std::vector<Table>& tables) {
  for (const Selection& selection : selections) {
    tables[selection.number].where.kind = Where::Kind::vertices;
    tables[selection.number].where.vertices = selection.vertices;
  }
}

Parameter rest_positions_of_body(const World& world, std::size_t body, const std::string& name) {
  const VertexMap map(world, body);
  const BodyDescription& description = description_of(world, body);
  Parameter parameter{
      .name = name, .shape = map.shape(), .value = plus_origin(world, map.taken(world.rest_positions))};
  const Eigen::Index num_unknowns = world.rest_positions.size();
  const bool places_start = description.initial_positions.empty(),
             speeds_start = description.initial_velocities.empty();
  const Eigen::MatrixXd G = description.velocity_gradient.topLeftCorner(world.dimension, world.dimension);
  const Eigen::Index dim = world.dimension;
  const std::vector<double> contact_shape = as_vector(plus_origin(world, map.taken(world.contact_shape())));
  std::vector<std::vector<Index>> regions(description.regions.size());  // cells stay in theirs
  for (const Domain& domain : world.bodies[body].domains)
    if (domain.region >= 0) regions[static_cast<std::size_t>(domain.region)] = *domain.numbers;
  const std::vector<Selection> fixes = selections_by_place(world, body, world.made_from->fixes),
                               loads = selections_by_place(world, body, world.made_from->loads);
  parameter.ask = [=](WorldChange& change) {
    make_room(change.rest_positions, num_unknowns);
    make_room(change.start_positions, num_unknowns);
    make_room(change.start_velocities, num_unknowns);
  };
  parameter.spread = [=](const VectorX& by, WorldChange& change) {
    map.spread(by, change.rest_positions);
    if (places_start) map.spread(by, change.start_positions);
    if (!speeds_start) return;
    VectorX turned(by.size());
    for (Eigen::Index i = 0; i < by.size(); i += dim) turned.segment(i, dim) = G * by.segment(i, dim);
    map.spread(turned, change.start_velocities);
  };
  parameter.gather = [=](const WorldChange& change, VectorX& slopes) {
    map.gather(change.rest_positions, slopes);
    if (places_start) map.gather(change.start_positions, slopes);
    if (!speeds_start) return;
    VectorX by_velocity = VectorX::Zero(slopes.size());
    map.gather(change.start_velocities, by_velocity);
    for (Eigen::Index i = 0; i < slopes.size(); i += dim)
      slopes.segment(i, dim) += G.transpose() * by_velocity.segment(i, dim);
  };
  parameter.set = [=](const VectorX& to, Description& changed) {
    BodyDescription& of = changed.bodies[body];
    const Placement placement(of);
    const Vector3 origin = placement(Vector3::Zero());
    Matrix<3> slope;
    for (int k = 0; k < 3; ++k) slope.col(k) = placement(Vector3::Unit(k)) - origin;
    const Matrix<3> back = slope.inverse();
    for (std::size_t v = 0; v < of.mesh.vertices.size(); ++v) {
      Vector3 place = placement(of.mesh.vertices[v]);
      place.head(dim) = to.segment(static_cast<Eigen::Index>(v) * dim, dim);
      of.mesh.vertices[v] = back * (place - origin);
    }
    of.contact_shape = contact_shape;
    for (std::size_t k = 0; k < regions.size(); ++k) of.regions[k].cells = regions[k];
    select_by_number(fixes, changed.fixes);
    select_by_number(loads, changed.loads);
  };
  return parameter;
}

/// The parameter of the start in motion.
Parameter start_of_body(const World& world, std::size_t body, const std::string& name,
                        VectorX WorldChange::* change, std::vector<double> BodyDescription::* given,
                        VectorX value) {
  const VertexMap map(world, body);
  Parameter parameter{.name = name, .shape = map.shape(), .value = std::move(value)};
  const Eigen::Index num_unknowns = world.rest_positions.size();
  parameter.ask = [=](WorldChange& of) { make_room(of.*change, num_unknowns); };
  parameter.spread = [=](const VectorX& by, WorldChange& of) { map.spread(by, of.*change); };
  parameter.gather = [=](const WorldChange& of, VectorX& slopes) { map.gather(of.*change, slopes); };
  parameter.set = [=](const VectorX& to, Description& description) {
    description.bodies[body].*given = as_vector(to);
  };
  return parameter;
}

}  // namespace

namespace {

/// Prefix of a domain's parameters after "body.NAME.", before the key.
std::string prefix_of(const Domain& domain) { return domain.region < 0 ? "" : "region." + domain.name + "."; }

}  // namespace

std::vector<std::string> keys_of_body(const World& world, std::size_t body) {
  std::vector<std::string> keys;
  if (world.bodies[body].rigid) return keys;
  for (const Domain& domain : world.bodies[body].domains) {
    if (domain.is_rigid) continue;
    const std::string prefix = prefix_of(domain);
    const MaterialDescription& material = material_of(description_of(world, body), domain.region);
    for (const auto& [name, value] : given_numbers(domain.law_info(), material))
      keys.push_back(prefix + "material." + name);
    keys.push_back(prefix + "density");
  }
  keys.emplace_back("rest_positions");
  if (!world.is_dynamic) return keys;
  keys.insert(keys.end(), {"initial_positions", "initial_velocities"});
  const DampingDescription& damping = description_of(world, body).damping;
  if (damping.mass != 0) keys.emplace_back("damping.mass");
  if (damping.stiffness != 0 || damping.shear_viscosity != 0 || damping.bulk_viscosity != 0)
    keys.insert(keys.end(), {"damping.stiffness", "damping.shear_viscosity", "damping.bulk_viscosity"});
  return keys;
}

Parameter parameter_of_body(const World& world, std::size_t body, const std::string& name,
                            const std::string& key) {
  using Of = WorldChange::OfBody;
  const BodyDescription& description = description_of(world, body);
  const VertexMap map(world, body);
  if (key == "rest_positions") return rest_positions_of_body(world, body, name);
  if (key == "initial_positions")
    return start_of_body(world, body, name, &WorldChange::start_positions,
                         &BodyDescription::initial_positions,
                         plus_origin(world, map.taken(world.start_positions)));
  if (key == "initial_velocities")
    return start_of_body(world, body, name, &WorldChange::start_velocities,
                         &BodyDescription::initial_velocities, map.taken(world.start_velocities));
  const DampingDescription& damping = description.damping;
  if (key == "damping.mass")
    return number_of_body(body, name, damping.mass, &Of::mass_damping, &Of::has_damping,
                          [](BodyDescription& of) -> double& { return of.damping.mass; });
  if (key == "damping.stiffness")
    return number_of_body(body, name, damping.stiffness, &Of::stiffness_damping, &Of::has_damping,
                          [](BodyDescription& of) -> double& { return of.damping.stiffness; });
  if (key == "damping.shear_viscosity")
    return number_of_body(body, name, damping.shear_viscosity, &Of::shear_viscosity, &Of::has_damping,
                          [](BodyDescription& of) -> double& { return of.damping.shear_viscosity; });
  if (key == "damping.bulk_viscosity")
    return number_of_body(body, name, damping.bulk_viscosity, &Of::bulk_viscosity, &Of::has_damping,
                          [](BodyDescription& of) -> double& { return of.damping.bulk_viscosity; });
  for (std::size_t d = 0; d < world.bodies[body].domains.size(); ++d) {
    const std::string prefix = prefix_of(world.bodies[body].domains[d]), material = prefix + "material.";
    if (key == prefix + "density") return density_of_domain(world, body, d, name);
    if (key.starts_with(material))
      return constant_of_domain(world, body, d, name, key.substr(material.size()));
  }
  throw std::logic_error("no parameter of a body: " + key);
}

}  // namespace resilin
