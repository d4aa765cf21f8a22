#include "resilin/sensitivity/measured_number.hpp"

#include "resilin/core/error.hpp"
#include "resilin/sensitivity/stress_at_place.hpp"

namespace resilin {
namespace {

/// 1/2 v^T M v, M linear in the density and following the rest shape.
double add_kinetic_energy(const World& world, const Body& body, std::size_t number, const VectorX& velocities,
                          MeasuredNumber& measured, WorldChange& direct) {
  const Eigen::Index dim = world.dimension;
  VectorX own = VectorX::Zero(velocities.size()), momentum;
  own.segment(body.first_node * dim, body.num_nodes * dim) =
      velocities.segment(body.first_node * dim, body.num_nodes * dim);
  world.mass->multiply(own, momentum);
  measured.by_velocities += momentum;
  WorldChange::OfBody& of = direct.bodies[number];
  if (of.has_density || direct.rest_positions.size() > 0) {
    VectorX entries = VectorX::Zero(world.mass->num_entries());
    world.mass->add_slopes(0.5 * own, own, entries);
    const CellMasses masses{body.elastic->element(), body.cells, world.rest_positions, body.density,
                            body.mass_kind == MassKind::consistent};
    of.density += masses.add_slopes(*world.mass, entries, direct.rest_positions);
  }
  return 0.5 * momentum.dot(own);
}

double add_elastic_energy(const Body& body, std::size_t number, const VectorX& x, MeasuredNumber& measured,
                          WorldChange& direct) {
  const Conditions any;
  body.elastic->add_gradient(x, any, measured.by_positions);
  if (VectorX& constants = direct.bodies[number].constants; constants.size() > 0)
    body.elastic->add_energy_slopes("constants", x, constants);
  if (direct.rest_positions.size() > 0)
    body.elastic->add_energy_slopes("rest_positions", x, direct.rest_positions);
  return body.elastic->value(x, any);
}

std::size_t number_of(const World& world, const Body& body) {
  std::size_t number = 0;
  while (&world.bodies[number] != &body) ++number;
  return number;
}

}  // namespace

double MeasuredNumber::change(const FrameChange& frame, const std::vector<VectorX>& parameters) const {
  double sum = 0;
  if (by_positions.size() > 0) sum += by_positions.dot(frame.positions);
  if (by_velocities.size() > 0) sum += by_velocities.dot(frame.velocities);
  for (std::size_t i = 0; i < parameters.size(); ++i) sum += by_parameters[i].dot(parameters[i]);
  return sum;
}

std::vector<std::string> energy_kinds() { return {"elastic", "kinetic"}; }

MeasuredNumber energy_at(Derivatives& run, const std::string& kind, const Body* body, int frame) {
  const World& world = run.world();
  const bool is_kinetic = kind == "kinetic";
  if (!is_kinetic && kind != "elastic") refuse_word("energy.kind", kind, energy_kinds());
  if (is_kinetic && !world.is_dynamic)
    throw InputError("energy.kind", "a scene of motion for kinetic energy", "one of statics",
                     "ask for \"elastic\" energy");
  const VectorX numbers = is_kinetic ? run.velocities(frame) : run.positions(frame);
  MeasuredNumber measured;
  (is_kinetic ? measured.by_velocities : measured.by_positions) = VectorX::Zero(numbers.size());
  WorldChange direct = run.asked();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    if (body != nullptr && body != &world.bodies[b]) continue;
    measured.value += is_kinetic ? add_kinetic_energy(world, world.bodies[b], b, numbers, measured, direct)
                                 : add_elastic_energy(world.bodies[b], b, numbers, measured, direct);
  }
  measured.by_parameters = run.by_parameters(direct);
  return measured;
}

std::vector<MeasuredNumber> stresses_at(Derivatives& run, const Body& body, const std::vector<Vector3>& at,
                                        const std::string& component, int frame) {
  const VectorX x = run.positions(frame);
  std::vector<MeasuredNumber> all;
  for (const Vector3& point : at) {
    const StressAtPlace place(run.world(), body, point, "stress.at");
    MeasuredNumber measured{.value = 0, .by_positions = VectorX::Zero(x.size())};
    WorldChange direct = run.asked();
    Matrix<3> slopes;
    measured.value = component_of_stress(component, place.stress(x), slopes);
    place.add_slopes(slopes, x, measured.by_positions, direct);
    measured.by_parameters = run.by_parameters(direct);
    all.push_back(std::move(measured));
  }
  return all;
}

std::vector<MeasuredNumber> section_force_at(Derivatives& run, const std::string& name, int frame) {
  const World& world = run.world();
  const Section* section = nullptr;
  std::vector<std::string> names;
  for (const Section& one : world.sections) {
    if (one.name() == name) section = &one;
    names.push_back(one.name());
  }
  if (names.empty())
    throw InputError("section.name", "a section of the scene", '"' + name + '"',
                     "the scene has none: give one in [[section]]");
  if (section == nullptr) refuse_word("section.name", name, names);
  const std::size_t body = number_of(world, section->body(world));
  const VectorX x = run.positions(frame);
  const Vector3 force = section->measure(x).force;
  std::vector<MeasuredNumber> all;
  for (int k = 0; k < world.dimension; ++k) {
    WorldChange direct = run.asked();
    Section::Slopes slopes{.positions = VectorX::Zero(x.size()),
                           .rest_positions = std::move(direct.rest_positions),
                           .constants = std::move(direct.bodies[body].constants)};
    section->add_slopes(Vector3::Unit(k), x, slopes);
    direct.rest_positions = std::move(slopes.rest_positions);
    direct.bodies[body].constants = std::move(slopes.constants);
    all.push_back({force[k], std::move(slopes.positions), {}, run.by_parameters(direct)});
  }
  return all;
}

}  // namespace resilin
