#include "resilin/world/viscoelastic_material.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/law_sum.hpp"
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

/// A list that is there has an entry for each of the other one.
void check_count(const std::string& place, std::size_t count, std::size_t other) {
  if (count != 0 && other > count)
    throw InputError(place, std::to_string(other) + " shares, one for each branch", std::to_string(count));
}

void check_sum(const std::string& place, double sum) {
  if (!(sum < 1))
    throw InputError(place, "shares that sum to less than 1, the rest being the long-term modulus",
                     "a sum of " + format_number(sum),
                     "for shares of the long-term modulus set moduli = \"long_term\"");
}

std::optional<HistoryPlace> history_of(const MaterialDescription& material) {
  if (material.viscoelastic)
    return HistoryPlace{material.viscoelastic->place, "a viscoelastic one", "leave viscoelastic out"};
  if (material.mullins)
    return HistoryPlace{material.mullins->place, "one with Mullins softening", "leave mullins out"};
  return std::nullopt;
}

std::optional<HistoryPlace> find_in_body(const BodyDescription& body) {
  std::optional<HistoryPlace> found = history_of(body.material);
  for (const RegionDescription& region : body.regions)
    if (!found) found = history_of(region.material);
  return found;
}

}  // namespace

PronySeries prony_series(const ViscoelasticDescription& description, const LawInfo& law) {
  const auto& [place, g, k, tau, moduli, formulation] = description;
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
  if (formulation == ViscoelasticForm::whole && !k.empty())
    throw InputError(place + ".k", "none with formulation \"whole\", in which the pressure relaxes by g",
                     std::to_string(k.size()) + (k.size() == 1 ? " share" : " shares"), "leave k out");
  if (g.empty() && k.empty()) throw InputError(place + ".g", "a share for each branch, at least one", "none");
  const std::size_t count = std::max(g.size(), k.size());
  check_count(place + ".g", g.size(), k.size());
  check_count(place + ".k", k.size(), g.size());
  if (tau.size() != count)
    throw InputError(
        place + ".tau",
        std::to_string(count) + " relaxation time" + (count == 1 ? "" : "s") + ", one for each share",
        std::to_string(tau.size()));
  const std::string shares = place + ".g", times = place + ".tau";
  PronySeries series;
  for (std::size_t i = 0; i < count; ++i) {
    const PronyBranch branch = {
        .share = g.empty() ? 0 : g[i], .time = tau[i], .volume_share = k.empty() ? 0 : k[i]};
    if (!(branch.volume_share >= 0 && std::isfinite(branch.volume_share)))
      throw InputError(entry_of(place + ".k", i), "a number >= 0", format_number(branch.volume_share));
    if (!((branch.share > 0 || (branch.share == 0 && branch.volume_share > 0)) &&
          std::isfinite(branch.share)))
      throw InputError(entry_of(shares, i), branch.volume_share > 0 ? "a number >= 0" : "a number > 0",
                       format_number(branch.share));
    if (!(branch.time > 0 && std::isfinite(branch.time)))
      throw InputError(entry_of(times, i), "a relaxation time > 0 s", format_number(branch.time));
    series.branches.push_back(branch);
  }
  const double sum = std::accumulate(g.begin(), g.end(), 0.0);
  const double sum_of_volume = std::accumulate(k.begin(), k.end(), 0.0);
  if (moduli == Moduli::long_term) {
    series.stiffening = {.shape = 1 + sum, .volume = 1 + sum_of_volume};
    for (PronyBranch& branch : series.branches) {
      branch.share /= series.stiffening.shape;
      branch.volume_share /= series.stiffening.volume;
    }
  } else {
    check_sum(shares, sum);
    check_sum(place + ".k", sum_of_volume);
  }
  return series;
}

Softening softening(const MullinsDescription& mullins, bool is_viscoelastic, const LawInfo& law) {
  const auto& [place, r, m, beta] = mullins;
  if (is_viscoelastic)
    throw InputError(place, "either viscoelastic or mullins", "both", "leave one of them out");
  if (is_plane_stress(law))
    throw InputError(place, "no Mullins softening in plane stress", '"' + std::string(law.name) + '"',
                     "leave mullins out, or take plane strain or 3D");
  if (is_sum(law))
    throw InputError(place, "no Mullins softening of a sum of laws", '"' + std::string(law.name) + '"',
                     "leave mullins out, or take one law");
  if (!has_isochoric_split(law))
    throw InputError(place, "a law with an isochoric-volumetric split: " + laws_with_split(),
                     '"' + std::string(law.name) + '"', "choose one of them");
  if (!(r > 1 && std::isfinite(r)))
    throw InputError(place + ".r", "a number > 1: at most 1/r of the stress is lost", format_number(r));
  if (!(m >= 0 && std::isfinite(m))) throw InputError(place + ".m", "a number >= 0 J/m^3", format_number(m));
  if (!(beta >= 0 && std::isfinite(beta)))
    throw InputError(place + ".beta", "a number >= 0", format_number(beta));
  if (m == 0 && beta == 0) throw InputError(place, "m > 0 or beta > 0", "both zero");
  return {.r = r, .m = m, .beta = beta};
}

bool has_history(const BodyDescription& body) { return find_in_body(body).has_value(); }

std::optional<HistoryPlace> find_history(const Description& description) {
  const auto found = std::ranges::find_if(description.bodies, has_history);
  return found == description.bodies.end() ? std::nullopt : find_in_body(*found);
}

void check_history(const Description& description) {
  const std::optional<HistoryPlace> found = find_history(description);
  if (!found) return;
  if (description.modes)
    throw InputError(found->place, "an elastic material in a modal analysis", found->kind,
                     found->cure + ": modes are then those of the given moduli");
  if (!description.is_dynamic && description.load_control == LoadControlKind::arc_length)
    throw InputError(found->place, "an elastic material where load control is \"arc_length\"", found->kind,
                     "take simulation.load_control = \"load\"");
  for (const SectionDescription& section : description.sections) {
    const auto body = std::ranges::find_if(description.bodies, [&](const BodyDescription& of) {
      return section.body.empty() || of.name == section.body;
    });
    if (body == description.bodies.end()) continue;
    if (const std::optional<HistoryPlace> cut = find_in_body(*body))
      throw InputError(section.place, "a section of an elastic body",
                       "one of \"" + body->name + "\", whose material is " + cut->kind,
                       "take the reaction of a boundary condition ([[fix]])");
  }
}

}  // namespace resilin
