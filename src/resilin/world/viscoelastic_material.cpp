#include "resilin/world/viscoelastic_material.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/plane_stress.hpp"

namespace resilin {
namespace {

std::string laws_with_split() {
  std::vector<std::string> names;
  for (const LawInfo* law : laws())
    if (has_isochoric_split(*law)) names.emplace_back(law->name);
  return join(names);
}

/// "material.viscoelastic.tau[1]"
std::string entry_of(const std::string& list, std::size_t number) {
  return list + "[" + std::to_string(number) + "]";
}

const ViscoelasticDescription* find_viscoelasticity(const BodyDescription& body) {
  if (body.material.viscoelastic) return &*body.material.viscoelastic;
  for (const RegionDescription& region : body.regions)
    if (region.material.viscoelastic) return &*region.material.viscoelastic;
  return nullptr;
}

}  // namespace

PronySeries prony_series(const ViscoelasticDescription& description, const LawInfo& law) {
  const auto& [place, g, tau, moduli, formulation] = description;
  if (is_plane_stress(law))
    throw InputError(place, "no viscoelastic material in plane stress", '"' + std::string(law.name) + '"',
                     "leave viscoelastic out, or take plane strain or 3D");
  if (formulation == ViscoelasticForm::whole && law.kind == LawKind::small_strain)
    throw InputError(place, "a law of finite strain", '"' + std::string(law.name) + '"',
                     "choose another law or leave viscoelastic out");
  if (formulation != ViscoelasticForm::whole && !has_isochoric_split(law))
    throw InputError(place, "a law with an isochoric-volumetric split: " + laws_with_split(),
                     '"' + std::string(law.name) + '"',
                     "choose one of them, or formulation = \"whole\", in which the pressure relaxes, too");
  if (g.empty()) throw InputError(place + ".g", "a share for each branch, at least one", "none");
  if (tau.size() != g.size())
    throw InputError(place + ".tau",
                     std::to_string(g.size()) + " relaxation time" + (g.size() == 1 ? "" : "s") +
                         ", one for each share in g",
                     std::to_string(tau.size()));
  const std::string shares = place + ".g", times = place + ".tau";
  double sum = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!(g[i] > 0 && std::isfinite(g[i])))
      throw InputError(entry_of(shares, i), "a number > 0", format_number(g[i]));
    if (!(tau[i] > 0 && std::isfinite(tau[i])))
      throw InputError(entry_of(times, i), "a relaxation time > 0 s", format_number(tau[i]));
    sum += g[i];
  }
  PronySeries series;
  if (moduli == Moduli::long_term) {
    series.stiffening = 1 + sum;
  } else if (!(sum < 1)) {
    throw InputError(place + ".g", "shares that sum to less than 1, the rest being the long-term modulus",
                     "a sum of " + format_number(sum),
                     "for shares of the long-term modulus set moduli = \"long_term\"");
  }
  for (std::size_t i = 0; i < g.size(); ++i)
    series.branches.push_back({.share = g[i] / series.stiffening, .time = tau[i]});
  return series;
}

bool is_viscoelastic(const BodyDescription& body) { return find_viscoelasticity(body) != nullptr; }

std::string place_of_viscoelasticity(const Description& description) {
  const auto found = std::ranges::find_if(description.bodies, is_viscoelastic);
  return found == description.bodies.end() ? std::string() : find_viscoelasticity(*found)->place;
}

void check_viscoelasticity(const Description& description) {
  const std::string place = place_of_viscoelasticity(description);
  if (place.empty()) return;
  if (description.modes)
    throw InputError(place, "an elastic material in a modal analysis", "a viscoelastic one",
                     "leave viscoelastic out: modes are then those of the given moduli");
  if (!description.is_dynamic && description.load_control == LoadControlKind::arc_length)
    throw InputError(place, "an elastic material where load control is \"arc_length\"", "a viscoelastic one",
                     "take simulation.load_control = \"load\"");
  for (const SectionDescription& section : description.sections) {
    const auto body = std::ranges::find_if(description.bodies, [&](const BodyDescription& of) {
      return section.body.empty() || of.name == section.body;
    });
    if (body != description.bodies.end() && is_viscoelastic(*body))
      throw InputError(section.place, "a section of an elastic body",
                       "one of \"" + body->name + "\", which is viscoelastic",
                       "take the reaction of a boundary condition ([[fix]])");
  }
}

}  // namespace resilin
