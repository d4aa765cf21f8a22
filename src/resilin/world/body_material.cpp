#include "resilin/world/body_material.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/mullins.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/cell_material.hpp"
#include "resilin/world/region_cells.hpp"
#include "resilin/world/viscoelastic_material.hpp"

namespace resilin {
namespace {

/// Entries of the cells of a domain; all where there is one for all cells.
template <class T>
std::vector<T> entries_of_cells(std::vector<T> values, std::size_t width, const std::vector<Index>* numbers) {
  if (numbers == nullptr || values.size() == width) return values;
  std::vector<T> picked;
  for (const Index cell : *numbers) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(cell) * width);
    picked.insert(picked.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  return picked;
}

DomainMaterial material_of_domain(const BodyDescription& description, int region, Index num_cells,
                                  std::shared_ptr<const std::vector<Index>> numbers) {
  const MaterialDescription& material = material_of(description, region);
  const LawInfo& law = require_law(material.law, material.place + ".law");
  std::vector<double> constants =
      entries_of_cells(constants_of_cells(law, material, num_cells), law.constants.size(), numbers.get());
  return {region, std::move(numbers), &law, std::move(constants)};
}

SharedIndices nodes_of_cells(const Body& body, const std::vector<Index>& numbers) {
  const auto width = static_cast<std::size_t>(num_nodes(body.cell_kind));
  std::vector<Index> nodes;
  nodes.reserve(numbers.size() * width);
  for (const Index cell : numbers)
    for (std::size_t a = 0; a < width; ++a)
      nodes.push_back(body.cells[static_cast<std::size_t>(cell) * width + a]);
  return nodes;
}

}  // namespace

const MaterialDescription& material_of(const BodyDescription& description, int region) {
  return region < 0 ? description.material : description.regions[static_cast<std::size_t>(region)].material;
}

std::vector<DomainMaterial> domain_materials(const BodyDescription& description, int dim, bool is_part,
                                             bool has_own_cells) {
  const Index num_cells = solid_cells(description, dim).num_cells();
  if (description.regions.empty()) return {material_of_domain(description, -1, num_cells, nullptr)};
  std::vector<std::vector<Index>> cells = cells_of_domains(description, dim, is_part);
  std::vector<DomainMaterial> materials;
  for (std::size_t d = 0; d < cells.size(); ++d) {
    if (d == 0 && !has_own_cells && cells[d].empty()) continue;
    materials.push_back(material_of_domain(description, static_cast<int>(d) - 1, num_cells,
                                           std::make_shared<const std::vector<Index>>(std::move(cells[d]))));
  }
  return materials;
}

double largest_poissons_ratio(const std::vector<DomainMaterial>& materials) {
  double largest = -1;
  for (const DomainMaterial& material : materials)
    largest = std::max(largest, largest_poissons_ratio(*material.law, material.constants));
  return largest;
}

const LawInfo& limiting_law(const std::vector<DomainMaterial>& materials) {
  for (const DomainMaterial& material : materials)
    if (!material.law->has_volume_energy) return *material.law;
  return *materials.front().law;
}

std::vector<std::shared_ptr<Energy>> give_material(const World& world, const BodyDescription& description,
                                                   const std::vector<DomainMaterial>& materials, Body& body) {
  using Gradients = ElasticTiles::Gradients;  // viscous damping, if dynamic, takes those of the body
  std::vector<std::shared_ptr<Energy>> energies;
  std::vector<Domain> domains;
  body.mass = 0;
  for (const DomainMaterial& of : materials) {
    const MaterialDescription& material = material_of(description, of.region);
    const LawInfo& law = *of.law;
    Domain domain;
    domain.name = of.region < 0 ? "" : description.regions[static_cast<std::size_t>(of.region)].name;
    domain.region = of.region;
    domain.is_rigid =
        of.region >= 0 && description.regions[static_cast<std::size_t>(of.region)].rigid.has_value();
    domain.law = body.rigid || domain.is_rigid ? "rigid" : law.name;
    const std::size_t num_constants = law.constants.size(), num_sets = of.constants.size() / num_constants;
    for (std::size_t i = 0; i < num_constants; ++i) {
      double sum = 0;
      for (std::size_t k = i; k < of.constants.size(); k += num_constants) sum += of.constants[k];
      domain.constants.emplace_back(law.constants[i].name, sum / static_cast<double>(num_sets));
    }
    domain.numbers = of.numbers;
    domain.cells = of.numbers ? nodes_of_cells(body, *of.numbers) : body.cells;
    FibreDirections fibres = fibres_of_cells(law, material, description.rotate, body.num_cells());
    fibres.directions = entries_of_cells(std::move(fibres.directions), fibres.num_families, of.numbers.get());
    auto energy = std::make_shared<ElasticEnergy>(
        world.dimension, ElementChoice(body.element, description.quadrature), domain.cells,
        world.rest_positions, law, of.constants, fibres, preferred_instruction_set(),
        world.is_dynamic || material.viscoelastic || material.mullins ? Gradients::held
                                                                      : Gradients::held_by_small_bodies,
        world.thickness);
    if (world.newton.inversion_bound == InversionBound::everywhere) energy->bound_inversion_everywhere();
    std::shared_ptr<Energy> term = energy;
    if (material.viscoelastic) {
      PronySeries series = prony_series(*material.viscoelastic, law);
      if (series.stiffening != RemainingShares())
        energy = std::make_shared<ElasticEnergy>(energy->with_scaled_constants(
            relaxing_factors(law, material.viscoelastic->formulation, series.stiffening)));
      const auto viscoelastic = std::make_shared<ViscoelasticEnergy>(energy, std::move(series.branches),
                                                                     material.viscoelastic->formulation);
      domain.history = viscoelastic;
      term = viscoelastic;
    }
    if (material.mullins) {
      const auto softened = std::make_shared<MullinsEnergy>(
          energy, softening(*material.mullins, material.viscoelastic.has_value(), law));
      domain.history = softened;
      term = softened;
    }
    domain.energy = energy;
    domain.density = domain.is_rigid ? 0 : material.density;
    body.mass += domain.density * energy->total_rest_volume();
    if ((world.is_dynamic || world.modes) && !domain.is_rigid && !(material.density > 0)) {
      throw InputError(material.place + ".density", "a positive number in a dynamic analysis",
                       format_number(material.density));
    }
    energies.push_back(std::move(term));
    domains.push_back(std::move(domain));
  }
  body.domains = Domains(std::move(domains));
  return energies;
}

void change_material(World& world, std::size_t index, const BodyDescription& description) {
  Body changed = world.bodies[index];
  if (changed.rigid)
    throw InputError(description.place + ".material", "a deformable body",
                     "the rigid body \"" + changed.name + '"');
  std::vector<DomainMaterial> materials;
  for (const Domain& domain : changed.domains)
    materials.push_back(material_of_domain(description, domain.region, changed.num_cells(), domain.numbers));
  const auto energies = give_material(world, description, materials, changed);
  for (std::size_t d = 0; d < energies.size(); ++d) {
    energies[d]->bind(*world.pattern);
    world.terms[world.term_of_domain(index, d)] = energies[d];
  }
  world.bodies[index] = std::move(changed);
  world.made_from.reset();
}

}  // namespace resilin
