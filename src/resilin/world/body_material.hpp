#pragma once

#include <memory>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// The material of a domain before its body is in the world.
struct DomainMaterial {
  int region = -1;                                      ///< see Domain
  std::shared_ptr<const std::vector<Index>> numbers{};  ///< numbers of its cells in the body; null: all
  const LawInfo* law = nullptr;
  std::vector<double>
      constants{};  ///< constants of the law's formula: once, or for one cell of the domain after another
};

/// The domains of a body: its own material where a cell belongs to no region, then one for each region.
/// @param has_own_cells  keeps the domain of the body's own material although this part of a scene has none
///                       of its cells
/// @throws InputError    for a region without a cell, unknown or repeated names, constants that are none
std::vector<DomainMaterial> domain_materials(const BodyDescription& description, int dim,
                                             bool is_part = false, bool has_own_cells = false);

/// The largest small-strain Poisson's ratio of all domains.
double largest_poissons_ratio(const std::vector<DomainMaterial>& materials);

/// The constitutive model that limits the choice of an element: one whose volume energy does not stand apart
/// where there is such, else the first.
const LawInfo& limiting_law(const std::vector<DomainMaterial>& materials);

/// The material of a region of a body; -1 is the body's own.
const MaterialDescription& material_of(const BodyDescription& description, int region);

/// Makes the strain energies of `body`, whose cells are placed in `world`, and notes the materials in it.
/// They are not bound to a pattern yet.
/// @throws InputError  for a law that does not suit the element or the motion
std::vector<std::shared_ptr<Energy>> give_material(const World& world, const BodyDescription& description,
                                                   const std::vector<DomainMaterial>& materials, Body& body);

/// Gives body number `index` of a world other materials, in the same domains; all else stays. On an error the
/// world is unchanged.
void change_material(World& world, std::size_t index, const BodyDescription& description);

}  // namespace resilin
