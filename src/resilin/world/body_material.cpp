#include "resilin/world/body_material.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/cell_material.hpp"

namespace resilin {

std::shared_ptr<ElasticEnergy> give_material(const World& world, const BodyDescription& description,
                                             const std::vector<double>& constants, Body& body) {
  const MaterialDescription& material = description.material;
  const LawInfo& law = require_law(material.law, material.place + ".law");
  const std::size_t num_constants = law.constants.size();
  body.law = law.name;
  body.constants.clear();
  const std::size_t num_sets = constants.size() / num_constants;
  for (std::size_t i = 0; i < num_constants; ++i) {
    double sum = 0;
    for (std::size_t k = i; k < constants.size(); k += num_constants) sum += constants[k];
    body.constants.emplace_back(law.constants[i].name, sum / static_cast<double>(num_sets));
  }
  using Gradients = ElasticTiles::Gradients;  // that of viscous damping, in motion, are those of the body
  auto elastic = std::make_shared<ElasticEnergy>(
      world.dimension, ElementChoice(body.element, description.quadrature), body.cells, world.rest_positions,
      law, constants, fibres_of_cells(law, description, body.num_cells()), preferred_instruction_set(),
      world.is_dynamic ? Gradients::held : Gradients::held_by_small_bodies);
  if (world.newton.inversion_bound == InversionBound::everywhere) elastic->bound_inversion_everywhere();
  body.elastic = elastic;
  body.density = material.density;
  body.mass = material.density * body.elastic->total_rest_volume();
  if ((world.is_dynamic || world.modes) && !(material.density > 0)) {
    throw InputError(material.place + ".density", "a positive number in a dynamic analysis",
                     format_number(material.density));
  }
  return elastic;
}

void change_material(World& world, std::size_t index, const BodyDescription& description) {
  Body changed = world.bodies[index];
  const LawInfo& law = require_law(description.material.law, description.material.place + ".law");
  const auto elastic = give_material(
      world, description, constants_of_cells(law, description.material, changed.num_cells()), changed);
  elastic->bind(*world.pattern);
  std::ranges::replace(world.terms, std::shared_ptr<const Energy>(world.bodies[index].elastic),
                       std::shared_ptr<const Energy>(elastic));
  world.bodies[index] = std::move(changed);
  world.made_from.reset();
}

}  // namespace resilin
