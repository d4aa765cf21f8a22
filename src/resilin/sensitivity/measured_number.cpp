#include "resilin/sensitivity/measured_number.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "resilin/contact/friction_contact.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/sensitivity/markers.hpp"
#include "resilin/sensitivity/stress_at_place.hpp"
#include "resilin/simulation/potential.hpp"

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
  if (of.has_density() || direct.rest_positions.size() > 0) {
    VectorX entries = VectorX::Zero(world.mass->num_entries());
    world.mass->add_slopes(0.5 * own, own, entries);
    for (std::size_t d = 0; d < body.domains.size(); ++d) {
      const Domain& domain = body.domains[d];
      const CellMasses masses{body.domains.element(), domain.cells, world.rest_positions, domain.density,
                              body.mass_kind == MassKind::consistent};
      of.domains[d].density += masses.add_slopes(*world.mass, entries, direct.rest_positions);
    }
  }
  return 0.5 * momentum.dot(own);
}

double add_elastic_energy(const Body& body, std::size_t number, const VectorX& x, MeasuredNumber& measured,
                          WorldChange& direct) {
  const Conditions any;
  for (std::size_t d = 0; d < body.domains.size(); ++d) {
    const ElasticEnergy& energy = *body.domains[d].energy;
    energy.add_gradient(x, any, measured.by_positions);
    if (VectorX& constants = direct.bodies[number].domains[d].constants; constants.size() > 0)
      energy.add_energy_slopes("constants", x, constants);
    if (direct.rest_positions.size() > 0)
      energy.add_energy_slopes("rest_positions", x, direct.rest_positions);
  }
  return body.domains.value(x);
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
    throw InputError("energy.kind", "a dynamic scene for kinetic energy", "a static one",
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

const Section& section_named(const World& world, const std::string& name, const std::string& place) {
  std::vector<std::string> names;
  for (const Section& section : world.sections) {
    if (section.name() == name) return section;
    names.push_back(section.name());
  }
  if (names.empty())
    throw InputError(place, "a section of the scene", '"' + name + '"',
                     "the scene has none: give one in [[section]]");
  refuse_word(place, name, names);
}

namespace {

/// The slopes of a number of a section, which `add` adds.
template <class Add>
MeasuredNumber measured_of(Derivatives& run, const Section& section, double value, const VectorX& x,
                           const Add& add) {
  const std::size_t body = number_of(run.world(), section.body(run.world()));
  WorldChange direct = run.asked();
  Section::Slopes slopes{.positions = VectorX::Zero(x.size()),
                         .rest_positions = std::move(direct.rest_positions)};
  std::vector<WorldChange::OfDomain>& domains = direct.bodies[body].domains;
  for (WorldChange::OfDomain& of : domains) slopes.constants.push_back(std::move(of.constants));
  add(slopes);
  direct.rest_positions = std::move(slopes.rest_positions);
  for (std::size_t d = 0; d < domains.size(); ++d) domains[d].constants = std::move(slopes.constants[d]);
  return {value, std::move(slopes.positions), {}, run.by_parameters(direct)};
}

}  // namespace

std::vector<MeasuredNumber> section_force_at(Derivatives& run, const std::string& name, int frame) {
  const Section& section = section_named(run.world(), name, "section.name");
  const VectorX x = run.positions(frame);
  const Vector3 force = section.measure(x).force;
  std::vector<MeasuredNumber> all;
  for (int k = 0; k < run.world().dimension; ++k)
    all.push_back(measured_of(run, section, force[k], x, [&](Section::Slopes& slopes) {
      section.add_slopes(Vector3::Unit(k), x, slopes);
    }));
  return all;
}

std::vector<MeasuredNumber> section_moment_at(Derivatives& run, const std::string& name, int frame) {
  const Section& section = section_named(run.world(), name, "section.name");
  const VectorX x = run.positions(frame);
  const Vector3 moment = section.measure(x).moment;
  std::vector<MeasuredNumber> all;
  for (int k = 0; k < 3; ++k)
    all.push_back(measured_of(run, section, moment[k], x, [&](Section::Slopes& slopes) {
      section.add_moment_slopes(Vector3::Unit(k), x, slopes);
    }));
  return all;
}

MeasuredNumber volume_at(Derivatives& run, const Body& body, int frame) {
  const VectorX x = run.positions(frame);
  MeasuredNumber measured{.by_positions = VectorX::Zero(x.size())};
  measured.value = volume_of(body, run.world().dimension, x, measured.by_positions);
  measured.by_parameters = run.by_parameters(run.asked());
  return measured;
}

std::vector<std::string> collider_names(const World& world) {
  std::vector<std::string> names;
  for (const ColliderDescription& collider : world.made_from->colliders) names.push_back(collider.name);
  return names;
}

// The force is w . (-dE/dx) with w the same for all nodes. E does not change where bodies and collider move
// alike, so that -K w, its slope by the places, is what a way of the collider does to dE/dx.
std::vector<MeasuredNumber> collider_force_at(Derivatives& run, const std::string& name, int frame) {
  const World& world = run.world();
  const std::vector<std::string> names = collider_names(world);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) refuse_word("reaction.of", name, names);
  const ColliderDescription& described =
      world.made_from->colliders[static_cast<std::size_t>(found - names.begin())];
  if (described.friction != 0)
    throw InputError("reaction.of", "a collider without friction, whose force can be differentiated",
                     '"' + name + "\" with friction = " + format_number(described.friction),
                     "measure markers or the reaction of a boundary condition, or leave its friction out");
  std::size_t number = 0;
  while (world.terms[number]->name() != name ||
         world.terms[number]->properties().category != EnergyCategory::contact)
    ++number;
  const VectorX x = run.positions(frame);
  const Frame& of_frame = run.frame(frame);
  const Conditions c = world.is_dynamic ? Conditions{.time = of_frame.time} : world.at_load(of_frame.load);
  Potential potential = Potential::at(world, c, x);
  potential.prepare(x, VectorX::Zero(x.size()));
  const Energy& term = *potential.terms()[number];
  const Eigen::Matrix3d shift =
      world.terms[number]->friction_source()->motion_of_its_own()->slopes_by("place", c.time - c.delay).shift;
  const auto force =
      std::ranges::find(of_frame.reactions.begin() + static_cast<std::ptrdiff_t>(world.supports.size()),
                        of_frame.reactions.end(), name, &std::pair<std::string, Vector3>::first);
  std::vector<MeasuredNumber> all;
  for (int k = 0; k < 3; ++k) {
    MeasuredNumber measured{.value = force->second[k], .by_positions = VectorX::Zero(x.size())};
    term.add_parameter_forces("place", x, shift.inverse().col(k), c, measured.by_positions);
    VectorX w = VectorX::Zero(x.size());
    for (Eigen::Index i = k; k < world.dimension && i < x.size(); i += world.dimension) w[i] = -1;
    measured.by_parameters = run.by_parameters_of_term(number, term, x, w, c);
    all.push_back(std::move(measured));
  }
  return all;
}

}  // namespace resilin
