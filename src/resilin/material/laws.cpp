// The table of the laws, from what their structs tell.
#include <algorithm>
#include <cmath>
#include <utility>

#include "law_headers.hpp"  // made by CMakeLists.txt from the catalogue
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/vocabulary.hpp"
#include "resilin/material/catalog.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/law.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/plane_stress.hpp"

namespace resilin {
namespace {

template <class Law>
constexpr std::size_t num_free =
    static_cast<std::size_t>(std::ranges::count_if(Law::constants, &ConstantText::is_free));

template <class Law, std::size_t... i>
Law law_from(const Hooke& hooke, [[maybe_unused]] std::span<const double> free, std::index_sequence<i...>) {
  return Law::from(hooke, free[i]...);
}

template <template <class> class Law>
std::vector<double> convert(const Hooke& hooke, std::span<const double> free) {
  constexpr std::size_t count = Law<double>::constants.size();
  const Law<double> law =
      law_from<Law<double>>(hooke, free, std::make_index_sequence<num_free<Law<double>>>{});
  static_assert(count <= max_constants, "raise max_constants");
  static_assert(sizeof(law) == count * sizeof(double), "a law's members are its constants, in their order");
  const auto* members = reinterpret_cast<const double*>(&law);
  return {members, members + count};
}

template <class Law>
constexpr int max_fibres() {
  if constexpr (requires { Law::max_fibres; })
    return Law::max_fibres;
  else
    return 0;
}

template <class Law>
constexpr double only_poissons_ratio() {
  if constexpr (requires { Law::only_poissons_ratio; })
    return Law::only_poissons_ratio;
  else
    return std::numeric_limits<double>::quiet_NaN();
}

template <class Law>
constexpr std::string_view end_of_domain() {
  if constexpr (requires { Law::end_of_domain; })
    return Law::end_of_domain;
  else
    return {};
}

template <template <class> class Law>
LawInfo info(int index) {
  using Plain = Law<double>;
  return {.index = index,
          .kind = Plain::kind,
          .name = Plain::name,
          .title = Plain::title,
          .formula = Plain::formula,
          .source = Plain::source,
          .inversion = Plain::inversion,
          .end_of_domain = end_of_domain<Plain>(),
          .needs_positive_J = Plain::needs_positive_J,
          .uses_second_invariant = Plain::uses_second_invariant,
          .is_quadratic = Plain::kind == LawKind::small_strain,
          .has_volume_energy = has_volume_energy<Plain>,
          .max_fibres = max_fibres<Plain>(),
          .only_poissons_ratio = only_poissons_ratio<Plain>(),
          .constants = Plain::constants,
          .convert = convert<Law>,
          .parts = {}};
}

const std::vector<LawInfo>& infos() {
  static const std::vector<LawInfo> table = [] {
    std::vector<LawInfo> all;
#define RESILIN_ADD_LAW(Law) all.push_back(info<Law>(static_cast<int>(all.size())));
    RESILIN_LAWS(RESILIN_ADD_LAW)
#undef RESILIN_ADD_LAW
    return all;
  }();
  return table;
}

/// The twins in plane stress: after the laws, in their order.
const std::vector<LawInfo>& plane_stress_infos() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const LawInfo& law : infos()) {
      all.push_back(plane_stress_name(law.name));
      all.push_back(plane_stress_name(law.title));
    }
    return all;
  }();
  static const std::vector<LawInfo> table = [] {
    std::vector<LawInfo> all = infos();
    for (LawInfo& law : all) {
      const auto index = static_cast<std::size_t>(law.index);
      law.name = names[2 * index];
      law.title = names[2 * index + 1];
      law.index += static_cast<int>(all.size());
      if (!law.is_quadratic) {
        law.inversion = "energy is infinite where the plane is inverted";
        law.needs_positive_J = true;
      }
      law.uses_second_invariant = false;
      law.has_volume_energy = false;
    }
    return all;
  }();
  return table;
}

}  // namespace

std::string plane_stress_name(std::string_view law) { return std::string(law) + " in plane stress"; }

bool is_plane_stress(const LawInfo& law) { return law.index >= static_cast<int>(infos().size()); }

const LawInfo& solid_law(const LawInfo& law) {
  if (is_sum(law)) return law;
  return infos()[static_cast<std::size_t>(law.index) % infos().size()];
}

std::vector<double> LawInfo::constants_from(const Hooke& hooke) const {
  if (is_sum(*this)) {
    std::vector<double> all;
    const auto share = 1 / static_cast<double>(parts.size());
    for (const LawInfo* part : parts) {
      const std::vector<double> own = part->constants_from({share * hooke.mu, share * hooke.lambda});
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }
  std::vector<double> free;
  for (const ConstantText& constant : constants)
    if (constant.is_free)
      free.push_back(!std::isnan(constant.fallback) ? constant.fallback
                     : constant.unit.empty()        ? 1
                                                    : hooke.mu);
  return convert(hooke, free);
}

bool LawInfo::needs_only_hooke() const {
  const auto must_be_given = [](const ConstantText& constant) {
    return constant.is_free && std::isnan(constant.fallback);
  };
  return !is_sum(*this) && max_fibres == 0 && std::isnan(only_poissons_ratio) &&
         std::ranges::none_of(constants, must_be_given);
}

std::vector<const LawInfo*> laws() {
  std::vector<const LawInfo*> all;
  for (const LawInfo& law : infos()) all.push_back(&law);
  return all;
}

const LawInfo* find_law(std::string_view name) {
  for (const LawInfo& law : infos())
    if (law.name == name) return &law;
  for (const LawInfo& law : plane_stress_infos())
    if (law.name == name) return &law;
  return name.find('+') == name.npos ? nullptr : find_sum(name);
}

const LawInfo& require_law(std::string_view name, const std::string& place) {
  if (const LawInfo* law = find_law(name)) return *law;
  std::vector<std::string> names;
  for (const LawInfo& law : infos()) names.emplace_back(law.name);
  refuse_own_word(place, name, names);
}

}  // namespace resilin
