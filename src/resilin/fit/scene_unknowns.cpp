#include <algorithm>
#include <cmath>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/scene_model.hpp"
#include "resilin/world/body_mesh.hpp"

namespace resilin {
namespace {

/// More values of a constant than these are a field, not regions.
constexpr std::size_t most_regions = 50;

/// The numbers that one parameter stands for: values in the scene, and what they are called besides the key.
struct SoughtNumbers {
  std::vector<double> values;
  std::vector<std::string> names;
};

const BodyDescription& body_of(const ExperimentModel& model, const std::string& key) {
  const std::string name = body_of_key(key);
  const auto& bodies = model.world().made_from->bodies;
  return *std::ranges::find(bodies, name, &BodyDescription::name);
}

/// The groups of a body's cells, but for those of all of them, and which of them each cell is in; cells
/// without a group are the last one.
SoughtNumbers read_groups(const ExperimentModel& model, const SceneParameter& sought, const VectorX& value,
                          std::vector<int>& which) {
  const BodyDescription& body = body_of(model, sought.key);
  const CellBlock& cells = solid_cells(body, model.world().dimension);
  const auto block = static_cast<std::size_t>(&cells - body.mesh.blocks.data());
  SoughtNumbers numbers;
  which.assign(static_cast<std::size_t>(cells.num_cells()), -1);
  std::vector<std::string> groups;
  for (const Group& group : body.mesh.groups) {
    if (group.cells.size() <= block || group.cells[block].empty()) continue;
    if (group.cells[block].size() == which.size()) continue;
    const auto number = static_cast<int>(numbers.names.size());
    for (const Index cell : group.cells[block]) {
      int& of_cell = which[static_cast<std::size_t>(cell)];
      if (of_cell >= 0)
        throw InputError(
            sought.place + ".per", "each cell in one group",
            "one in \"" + numbers.names[static_cast<std::size_t>(of_cell)] + "\" and \"" + group.name + "\"",
            "make groups that do not overlap, or give values by regions and take per = \"value\"");
      of_cell = number;
    }
    numbers.names.push_back(group.name);
  }
  if (numbers.names.empty())
    throw InputError(sought.place + ".per", "a mesh with groups of cells, each of some of them",
                     "one without, " + body.mesh_name,
                     "take per = \"cell\", or give a file of cell values and take per = \"value\"");
  if (std::ranges::find(which, -1) != which.end()) {
    const auto rest = static_cast<int>(numbers.names.size());
    std::ranges::replace(which, -1, rest);
    numbers.names.emplace_back("others");
  }
  numbers.values.assign(numbers.names.size(), 0);
  for (std::size_t c = which.size(); c-- > 0;)  // ends with its first cell
    numbers.values[static_cast<std::size_t>(which[c])] = value[static_cast<Eigen::Index>(c)];
  return numbers;
}

/// One number for each value of the scene.
SoughtNumbers read_regions(const SceneParameter& sought, const VectorX& value, std::vector<int>& which) {
  SoughtNumbers numbers;
  numbers.values = different_values(value, most_regions);
  if (numbers.values.size() > most_regions)
    throw InputError(sought.place,
                     "a constant of at most " + std::to_string(most_regions) +
                         " different values, one for each region of cells",
                     "more of them",
                     "give the cells of one region the same value, or seek a field: per = \"cell\"");
  for (const double one : value)
    which.push_back(static_cast<int>(std::ranges::find(numbers.values, one) - numbers.values.begin()));
  if (numbers.values.size() > 1)
    for (std::size_t i = 0; i < numbers.values.size(); ++i)
      numbers.names.push_back(sought.key + "[" + std::to_string(i) + "]");
  return numbers;
}

SoughtNumbers read_component(const SceneParameter& sought, const FoundKey& key, int dim,
                             std::vector<int>& which) {
  const Parameter& parameter = key.parameter;
  which.assign(static_cast<std::size_t>(parameter.value.size()), -1);
  if (!parameter.shape.empty() && (parameter.shape.size() > 1 || parameter.value.size() != dim))
    throw InputError(sought.place + ".key", "a number of the scene, or a constant of a material",
                     "\"" + sought.key + "\", an array",
                     "fields of positions are not fitted; find_rest_shape finds stress-free shapes");
  if (!parameter.shape.empty() && !key.component)
    throw InputError(sought.place + ".key", "one component of the vector", "\"" + sought.key + "\"",
                     "for example \"" + sought.key + ".y\"");
  const Eigen::Index component = key.component.value_or(0);
  which[static_cast<std::size_t>(component)] = 0;
  return {{parameter.value[component]}, {}};
}

SoughtNumbers read_numbers(const ExperimentModel& model, const SceneParameter& sought,
                           SoughtParameter& found) {
  const VectorX& value = found.key.parameter.value;
  if (!is_of_cells(found.key.parameter))
    return read_component(sought, found.key, model.world().dimension, found.which);
  require_one_material(model.world(), sought);
  switch (sought.per) {
    case SoughtPer::value:
      return read_regions(sought, value, found.which);
    case SoughtPer::group:
      return read_groups(model, sought, value, found.which);
    case SoughtPer::cell:
      break;
  }
  found.which.resize(static_cast<std::size_t>(value.size()));
  std::iota(found.which.begin(), found.which.end(), 0);
  return {{value.begin(), value.end()}, {}};
}

/// Scenes that share a parameter mean the same numbers by it.
void require_same(const SoughtNumbers& first, const SoughtNumbers& other, const SceneParameter& sought,
                  const ExperimentModel& one, const ExperimentModel& two, std::vector<int>& which) {
  const std::string place = two.world().place + ": " + sought.key;
  if (sought.per == SoughtPer::value) {
    for (const double value : other.values)
      if (std::ranges::find(first.values, value) == first.values.end())
        throw InputError(place, "the values of the regions in " + one.world().place, format_number(value),
                         "scenes that share a parameter have the same value in the same region");
    for (int& region : which) {
      if (region < 0) continue;
      const double value = other.values[static_cast<std::size_t>(region)];
      region = static_cast<int>(std::ranges::find(first.values, value) - first.values.begin());
    }
  } else if (other.values.size() != first.values.size() || other.names != first.names) {
    throw InputError(place, "the cells and groups of " + one.world().place, "others",
                     "scenes that share a field have one mesh");
  }
}

/// Name, start and bounds of one number.
SceneUnknown make_unknown(const SceneParameter& sought, const KindOfNumber& kind, double scene_value,
                          double start) {
  SceneUnknown unknown{.name = sought.key, .unit = kind.unit};
  unknown.start = sought.start.empty() ? scene_value : start;
  unknown.lower = std::max(kind.lower, sought.lower);
  unknown.upper = std::min(kind.upper, sought.upper);
  if ((sought.lower < kind.lower || sought.upper > kind.upper) &&
      (std::isfinite(sought.lower) || std::isfinite(sought.upper)))
    throw InputError(sought.place + ".bounds",
                     "numbers from " + format_number(kind.lower) + " to " + format_number(kind.upper),
                     format_number(sought.lower < kind.lower ? sought.lower : sought.upper));
  const bool is_on_edge = kind.is_above_lower && unknown.start == kind.lower;
  if (!(unknown.start >= unknown.lower && unknown.start <= unknown.upper) || is_on_edge)
    throw InputError(
        sought.place + (sought.start.empty() ? ".bounds" : ".start"),
        (is_on_edge ? "a start above " + format_number(kind.lower)
                    : "a start from " + format_number(unknown.lower) + " to " + format_number(unknown.upper)),
        format_number(unknown.start));
  unknown.is_positive = kind.lower >= 0 && unknown.start > 0;
  return unknown;
}

}  // namespace

UnknownRange add_unknowns(const SceneFitDescription& description, std::size_t p,
                          std::vector<ExperimentModel>& experiments, std::vector<SceneUnknown>& unknowns) {
  const SceneParameter& sought = description.parameters[p];
  SoughtNumbers numbers;
  const ExperimentModel* first = nullptr;
  UnknownRange range{.first = static_cast<Eigen::Index>(unknowns.size()),
                     .is_field = sought.per == SoughtPer::cell};
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    ExperimentModel& model = experiments[e];
    if (!sought.experiment.empty() && sought.experiment != model.experiment().name) continue;
    SoughtParameter found{.key = find_key(model.world(), sought), .which = {}};
    SoughtNumbers here = read_numbers(model, sought, found);
    if (first == nullptr) {
      first = &model;
      range.experiment = e;
      numbers = std::move(here);
    } else if (is_of_cells(found.key.parameter)) {
      require_same(numbers, here, sought, *first, model, found.which);
    }
    found.count = static_cast<Eigen::Index>(numbers.values.size());
    model.parameters().emplace(p, std::move(found));
  }
  const std::size_t count = numbers.values.size();
  range.count = static_cast<Eigen::Index>(count);
  const auto check_count = [&](std::size_t given, const char* key) {
    if (given == 0 || given == count || (range.is_field && given == 1)) return;
    throw InputError(sought.place + "." + key,
                     count == 1 ? "one" : std::to_string(count) + ", one for each value in the scene",
                     std::to_string(given));
  };
  check_count(sought.names.size(), "name");
  check_count(sought.start.size() == 1 ? 0 : sought.start.size(), "start");
  const KindOfNumber kind = kind_of(first->world(), sought.key);
  for (std::size_t i = 0; i < count; ++i) {
    const double start = sought.start.empty() ? 0 : sought.start[sought.start.size() == 1 ? 0 : i];
    SceneUnknown unknown = make_unknown(sought, kind, numbers.values[i], start);
    unknown.parameter = p;
    if (!sought.names.empty())
      unknown.name = sought.names[range.is_field && sought.names.size() == 1 ? 0 : i];
    else if (!numbers.names.empty())
      unknown.name = numbers.names[i];
    unknowns.push_back(std::move(unknown));
  }
  return range;
}

}  // namespace resilin
