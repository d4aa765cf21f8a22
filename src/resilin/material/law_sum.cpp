#include "resilin/material/law_sum.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>

#include "resilin/material/material_axes.hpp"
#include "resilin/material/plane_stress.hpp"

namespace resilin {
namespace {

constexpr std::string_view separator = " + ";

std::vector<std::string_view> split(std::string_view name) {
  std::vector<std::string_view> names;
  for (std::size_t end = name.find(separator); end != name.npos; end = name.find(separator)) {
    names.push_back(name.substr(0, end));
    name.remove_prefix(end + separator.size());
  }
  names.push_back(name);
  return names;
}

/// Texts and tables of a sum, which its LawInfo points into.
struct Sum {
  std::string name, title, formula, source, inversion, end_of_domain;
  std::vector<std::vector<ConstantText>> part_constants;
  std::vector<LawInfo> part_laws;
  std::vector<const LawInfo*> parts;
  std::vector<std::string> names;
  std::vector<ConstantText> constants;
  LawInfo info;
};

void append(std::string& text, std::string_view more, std::string_view between) {
  if (more.empty() || text == more) return;
  if (!text.empty()) text += between;
  text += more;
}

/// A modulus may be zero: another part has what is missing.
ConstantText relaxed(ConstantText constant) {
  if (constant.unit.empty()) return constant;
  if (constant.above == 0) {
    constant.above = -ConstantText::infinity;
    constant.at_least = 0;
  }
  if (std::isnan(constant.fallback)) constant.fallback = 0;
  return constant;
}

std::unique_ptr<Sum> make_sum(std::string_view name, const std::vector<const LawInfo*>& laws) {
  auto sum = std::make_unique<Sum>();
  sum->name = name;
  LawInfo& info = sum->info;
  info = *laws.front();
  info.kind = LawKind::sum;
  info.index = -1;
  info.needs_positive_J = info.uses_second_invariant = info.is_quadratic = false;
  info.has_volume_energy = true;
  info.max_fibres = 0;
  info.only_poissons_ratio = std::numeric_limits<double>::quiet_NaN();
  info.convert = nullptr;
  for (const LawInfo* law : laws) {
    append(sum->title, law->title, separator);
    append(sum->formula, law->formula, separator);
    append(sum->source, law->source, "; ");
    append(sum->inversion, law->inversion, "; ");
    append(sum->end_of_domain, law->end_of_domain, ", or ");
    info.needs_positive_J = info.needs_positive_J || law->needs_positive_J;
    info.has_volume_energy = info.has_volume_energy && law->has_volume_energy;
    info.max_fibres += law->max_fibres;
    std::vector<ConstantText>& own = sum->part_constants.emplace_back();
    for (const ConstantText& constant : law->constants) own.push_back(relaxed(constant));
    sum->part_laws.push_back(*law);
  }
  for (std::size_t i = 0; i < laws.size(); ++i) {
    sum->part_laws[i].constants = sum->part_constants[i];
    sum->parts.push_back(&sum->part_laws[i]);
    for (const ConstantText& constant : sum->part_constants[i])
      sum->names.push_back(sum_constant(i, constant.name));
  }
  for (std::size_t i = 0, k = 0; i < laws.size(); ++i)
    for (ConstantText constant : sum->part_constants[i]) {
      constant.name = sum->names[k++];
      sum->constants.push_back(constant);
    }
  info.name = sum->name;
  info.title = sum->title;
  info.formula = sum->formula;
  info.source = sum->source;
  info.inversion = sum->inversion;
  info.end_of_domain = sum->end_of_domain;
  info.constants = sum->constants;
  info.parts = sum->parts;
  return sum;
}

}  // namespace

std::vector<LawPart> parts_of(const LawInfo& law) {
  if (!is_sum(law)) return {{&law, 0, 0}};
  std::vector<LawPart> parts;
  std::size_t constant = 0, family = 0;
  for (const LawInfo* part : law.parts) {
    parts.push_back({part, constant, family});
    constant += part->constants.size();
    family += static_cast<std::size_t>(part->max_fibres);
  }
  return parts;
}

bool has_parallel_axes(const LawInfo& law, std::span<const Vector3> directions) {
  if (law.kind != LawKind::axes && !is_sum(law)) return false;
  constexpr double least_sine = 1e-6;
  return std::ranges::any_of(parts_of(law), [&](const LawPart& part) {
    if (part.law->kind != LawKind::axes || num_own_families(part, directions.size()) < 2) return false;
    const Vector3 &first = directions[part.first_family], &second = directions[part.first_family + 1];
    return !second.isZero(0) && first.cross(second).norm() < least_sine;
  });
}

std::string sum_name(std::span<const std::string> laws) {
  std::string name;
  for (const std::string& law : laws) {
    if (!name.empty()) name += separator;
    name += law;
  }
  return name;
}

std::string sum_constant(std::size_t part, std::string_view constant) {
  return std::string("sum[").append(std::to_string(part)).append("].").append(constant);
}

const LawInfo* find_sum(std::string_view name) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<Sum>, std::less<>> sums;
  const std::vector<std::string_view> names = split(name);
  if (names.size() < 2 || names.size() > most_in_sum) return nullptr;
  std::vector<const LawInfo*> parts;
  for (const std::string_view part : names) {
    const LawInfo* law = find_law(part);
    if (law == nullptr || is_sum(*law) || is_plane_stress(*law) || law->is_quadratic) return nullptr;
    parts.push_back(law);
  }
  const std::lock_guard lock(mutex);
  const auto known = sums.find(name);
  if (known != sums.end()) return &known->second->info;
  return &sums.emplace(std::string(name), make_sum(name, parts)).first->second->info;
}

}  // namespace resilin
