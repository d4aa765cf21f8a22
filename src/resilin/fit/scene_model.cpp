#include "resilin/fit/scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/scene_keys.hpp"
#include "resilin/sensitivity/markers.hpp"

namespace resilin {
namespace {

/// More values of a constant than these are a field, not regions.
constexpr std::size_t most_regions = 50;
/// Of a moment, beside the last one.
constexpr double same_moment = 1e-9;

}  // namespace

/// A measured component of a row, and what of a frame it is.
struct MeasuredNumber {
  Marker marker{};           ///< of markers and probes
  Eigen::Index support = 0;  ///< of a reaction
  Eigen::Index component = 0;
  std::optional<double> moment{};
};

struct SceneModel::OfExperiment {
  World world;
  /// Those that are sought in it, by the parameter of the description; as the scene has them.
  std::map<std::size_t, FoundKey> parameters;
  std::vector<MeasuredNumber> numbers;

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [which, found] : parameters) all.push_back(found.parameter.name);
    return all;
  }

  /// A change of an unknown by 1, of its parameter.
  VectorX change(const SceneUnknown& unknown) const {
    const Parameter& parameter = parameters.at(unknown.parameter).parameter;
    if (is_of_cells(parameter))
      return (parameter.value.array() == unknown.scene_value).cast<double>().matrix();
    return VectorX::Unit(parameter.value.size(), unknown.component);
  }

  void measure(const MeasuredTable& table, SceneData& data);
  std::vector<Marker> markers_of(const MeasuredTable& table) const;
  int frame_of(const MeasuredNumber& number, const Derivatives& run) const;
  double value_of(const MeasuredNumber& number, const FrameChange& of_frame) const;
};

std::vector<Marker> SceneModel::OfExperiment::markers_of(const MeasuredTable& table) const {
  if (table.kind == MeasuredKind::reaction) return {};
  if (table.kind == MeasuredKind::probe)
    return {Marker{{probe_named(world, table.of, table.place + ".of").node}, {1}}};
  std::vector<Vector3> points;
  std::vector<std::string> places;
  for (const MeasuredRow& row : table.rows) {
    points.push_back(row.at);
    places.push_back(row.place);
  }
  return markers_at(world, body_named(world, table.of, table.place + ".of"), points, places,
                    table.tolerance.value_or(0));
}

void SceneModel::OfExperiment::measure(const MeasuredTable& table, SceneData& data) {
  const std::vector<Marker> markers = markers_of(table);
  Eigen::Index support = 0;
  if (table.kind == MeasuredKind::reaction) {
    std::vector<std::string> supports;
    for (const Support& one : world.supports) supports.push_back(one.name);
    const auto found = std::ranges::find(supports, table.of);
    if (found == supports.end()) refuse_word(table.place + ".of", table.of, supports);
    support = found - supports.begin();
  }
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const MeasuredRow& row = table.rows[r];
    for (std::size_t i = 0; i < static_cast<std::size_t>(world.dimension); ++i) {
      if (!row.is_measured[i]) continue;
      MeasuredNumber one{.support = support, .component = static_cast<Eigen::Index>(i), .moment = row.moment};
      if (!markers.empty()) one.marker = markers[markers.size() == 1 ? 0 : r];
      numbers.push_back(one);
      data.places.push_back(row.place);
    }
  }
}

/// Which frame is meant.
int SceneModel::OfExperiment::frame_of(const MeasuredNumber& number, const Derivatives& run) const {
  const int last = run.num_frames() - 1;
  if (!number.moment) return last;
  const auto moment = [&](int frame) {
    return world.is_dynamic ? run.frame(frame).time : run.frame(frame).load;
  };
  for (int frame = 0; frame <= last; ++frame)
    if (std::abs(moment(frame) - *number.moment) <= same_moment * std::abs(moment(last))) return frame;
  std::string there;
  for (int frame = 0; frame <= std::min(last, 5); ++frame)
    there += (there.empty() ? "" : ", ") + format_number(moment(frame));
  if (last > 5) there += " ... " + format_number(moment(last));
  throw InputError(world.place,
                   std::string("a frame at ") + (world.is_dynamic ? "time " : "load ") +
                       format_number(*number.moment) + ", where there are measurements",
                   "frames at " + there,
                   world.is_dynamic ? "choose simulation.time_step so that a step ends there"
                                    : "choose simulation.load_steps so that a step ends there");
}

double SceneModel::OfExperiment::value_of(const MeasuredNumber& number, const FrameChange& of_frame) const {
  if (number.marker.nodes.empty())
    return of_frame.reactions[static_cast<std::size_t>(number.support)][number.component];
  double value = 0;
  for (std::size_t k = 0; k < number.marker.nodes.size(); ++k)
    value += number.marker.weights[k] *
             of_frame.positions[Eigen::Index{number.marker.nodes[k]} * world.dimension + number.component];
  return value;
}

SceneModel::SceneModel(const SceneFitDescription& description) : description_(description) {
  for (const SceneExperiment& experiment : description.experiments)
    experiments_.push_back({World(Description(experiment.description)), {}, {}});
  find_unknowns();
  collect_data();
}

SceneModel::~SceneModel() = default;

void SceneModel::find_unknowns() {
  for (std::size_t p = 0; p < description_.parameters.size(); ++p) {
    const SceneParameter& sought = description_.parameters[p];
    for (std::size_t other = 0; other < p; ++other)
      if (description_.parameters[other].key == sought.key &&
          (sought.experiment.empty() || description_.parameters[other].experiment.empty() ||
           description_.parameters[other].experiment == sought.experiment))
        throw InputError(sought.place + ".key", "a parameter of its own", "\"" + sought.key + "\" twice",
                         "leave one of them out");
    std::vector<std::string> names;
    for (std::size_t e = 0; e < experiments_.size(); ++e) {
      names.push_back(description_.experiments[e].name);
      if (sought.experiment.empty() || sought.experiment == names.back())
        experiments_[e].parameters.emplace(p, find_key(experiments_[e].world, sought));
    }
    if (!sought.experiment.empty() && std::ranges::find(names, sought.experiment) == names.end())
      refuse_word(sought.place + ".experiment", sought.experiment, names);
    add_unknowns(p);
  }
}

/// Those of one parameter of the description.
void SceneModel::add_unknowns(std::size_t p) {
  const SceneParameter& sought = description_.parameters[p];
  const auto first =
      std::ranges::find_if(experiments_, [p](const OfExperiment& one) { return one.parameters.contains(p); });
  const auto& [parameter, component] = first->parameters.at(p);
  std::vector<double> values(parameter.value.begin(), parameter.value.end());
  if (is_of_cells(parameter)) {
    values = different_values(parameter.value, most_regions);
    if (values.size() > most_regions)
      throw InputError(sought.place,
                       "a constant of at most " + std::to_string(most_regions) +
                           " different values, one for each region of cells",
                       "more of them", "give the cells of one region the same value");
    for (const OfExperiment& other : experiments_) {
      const auto there = other.parameters.find(p);
      if (there == other.parameters.end()) continue;
      for (const double value : different_values(there->second.parameter.value, most_regions))
        if (std::ranges::find(values, value) == values.end())
          throw InputError(other.world.place + ": " + sought.key,
                           "the values of the regions in " + first->world.place, format_number(value),
                           "scenes that share a parameter have the same value in the same region");
    }
  } else if (!parameter.shape.empty()) {
    if (parameter.shape.size() > 1 || parameter.value.size() != first->world.dimension)
      throw InputError(sought.place + ".key", "a number of the scene, or one for each region",
                       "\"" + sought.key + "\", an array", "fields are not fitted");
    if (!component)
      throw InputError(sought.place + ".key", "one component of the vector", "\"" + sought.key + "\"",
                       "for example \"" + sought.key + ".y\"");
    values = {parameter.value[*component]};
  }
  const auto check_count = [&](std::size_t count, const char* key) {
    if (count != 0 && count != values.size())
      throw InputError(
          sought.place + "." + key,
          values.size() == 1 ? "one" : std::to_string(values.size()) + ", one for each value in the scene",
          std::to_string(count));
  };
  check_count(sought.names.size(), "name");
  check_count(sought.start.size() == 1 ? 0 : sought.start.size(), "start");
  const KindOfNumber kind = kind_of(first->world, sought.key);
  for (std::size_t i = 0; i < values.size(); ++i) {
    SceneUnknown unknown{.name = sought.names.empty() ? sought.key : sought.names[i],
                         .unit = kind.unit,
                         .parameter = p,
                         .scene_value = values[i],
                         .component = component.value_or(0)};
    if (sought.names.empty() && values.size() > 1) unknown.name += "[" + std::to_string(i) + "]";
    unknown.start = sought.start.empty()       ? values[i]
                    : sought.start.size() == 1 ? sought.start[0]
                                               : sought.start[i];
    unknown.lower = std::max(kind.lower, sought.lower);
    unknown.upper = std::min(kind.upper, sought.upper);
    if (sought.lower < kind.lower || sought.upper > kind.upper) {
      if (std::isfinite(sought.lower) || std::isfinite(sought.upper))
        throw InputError(sought.place + ".bounds",
                         "numbers from " + format_number(kind.lower) + " to " + format_number(kind.upper),
                         format_number(sought.lower < kind.lower ? sought.lower : sought.upper));
    }
    const bool is_on_edge = kind.is_above_lower && unknown.start == kind.lower;
    if (!(unknown.start >= unknown.lower && unknown.start <= unknown.upper) || is_on_edge)
      throw InputError(sought.place + (sought.start.empty() ? ".bounds" : ".start"),
                       (is_on_edge ? "a start above " + format_number(kind.lower)
                                   : "a start from " + format_number(unknown.lower) + " to " +
                                         format_number(unknown.upper)),
                       format_number(unknown.start));
    unknown.is_positive = kind.lower >= 0 && unknown.start > 0;
    unknowns_.push_back(unknown);
  }
}

void SceneModel::collect_data() {
  std::vector<double> measured, sigma;
  std::string with_sigma, without;
  bool has_forces = false, has_places = false;
  for (std::size_t e = 0; e < experiments_.size(); ++e)
    for (const MeasuredTable& table : description_.experiments[e].tables) {
      const auto first = static_cast<Eigen::Index>(measured.size());
      experiments_[e].measure(table, data_);
      for (const MeasuredRow& row : table.rows)
        for (std::size_t i = 0; i < static_cast<std::size_t>(experiments_[e].world.dimension); ++i)
          if (row.is_measured[i]) {
            measured.push_back(row.value[static_cast<Eigen::Index>(i)]);
            sigma.push_back(row.sigma);
            (row.sigma > 0 ? with_sigma : without) = table.place;
          }
      (table.kind == MeasuredKind::reaction ? has_forces : has_places) = true;
      const std::string of = table.of.empty() || table.kind == MeasuredKind::markers ? "" : " of " + table.of;
      data_.tables.push_back({e, table.kind,
                              description_.experiments[e].name + ": " + spelling(table.kind) + of, first,
                              static_cast<Eigen::Index>(measured.size()) - first});
    }
  if (!without.empty() && (!with_sigma.empty() || (has_forces && has_places)))
    throw InputError(without,
                     with_sigma.empty() ? "a sigma of forces and of displacements, which are weighed by it"
                                        : "a sigma, as other measurements have one",
                     "none", "add sigma = ..., the standard deviation of the numbers");
  data_.measured = Eigen::Map<const VectorX>(measured.data(), static_cast<Eigen::Index>(measured.size()));
  if (without.empty())
    data_.sigma = Eigen::Map<const VectorX>(sigma.data(), static_cast<Eigen::Index>(sigma.size()));
  if (measured.size() < unknowns_.size())
    throw InputError(description_.place,
                     "at least " + std::to_string(unknowns_.size()) + " measured numbers for the " +
                         std::to_string(unknowns_.size()) + " parameters",
                     std::to_string(measured.size()), "measure more, or seek fewer");
}

/// As the scene says which elements.
Description SceneModel::changed(std::size_t e, const VectorX& unknowns) const {
  Description changed = description_.experiments[e].description;
  for (const auto& [p, found] : experiments_[e].parameters) {
    VectorX value = found.parameter.value;
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      if (unknowns_[u].parameter != p) continue;
      const VectorX where = experiments_[e].change(unknowns_[u]);
      value = (where.array() != 0).select(unknowns[static_cast<Eigen::Index>(u)], value);
    }
    found.parameter.set(value, changed);
  }
  return changed;
}

Description SceneModel::description_with(std::size_t e, const VectorX& unknowns) const {
  Description description = changed(e, unknowns);
  keep_elements(description, experiments_[e].world);
  return description;
}

std::vector<std::string> SceneModel::other_elements(const VectorX& unknowns) const {
  std::vector<std::string> others;
  for (std::size_t e = 0; e < experiments_.size(); ++e) {
    const std::vector<Body>& kept = experiments_[e].world.bodies;
    if (std::ranges::all_of(kept, [](const Body& body) { return body.element_reason.empty(); })) continue;
    const World chosen(changed(e, unknowns));
    for (std::size_t b = 0; b < kept.size(); ++b)
      if (chosen.bodies[b].element != kept[b].element)
        others.push_back(experiments_[e].world.place + ": " + kept[b].name + ": the fit kept element = \"" +
                         kept[b].element +
                         "\", which \"auto\" chooses at the start; with the numbers found it would be \"" +
                         chosen.bodies[b].element + "\" (" + chosen.bodies[b].element_reason +
                         "): name one in the scene and fit again");
  }
  return others;
}

SceneModel::Solved SceneModel::solve(const VectorX& unknowns, const std::function<bool()>& goes_on) const {
  Solved solved;
  solved.values = VectorX(data_.measured.size());
  Eigen::Index i = 0;
  for (std::size_t e = 0; e < experiments_.size(); ++e) {
    const OfExperiment& experiment = experiments_[e];
    solved.runs.push_back(Derivatives::run(description_with(e, unknowns), experiment.names(),
                                           {.checkpoints = 0, .goes_on = goes_on}));
    Derivatives& run = *solved.runs.back();
    std::map<int, FrameChange> frames;
    for (const MeasuredNumber& number : experiment.numbers) {
      const int frame = experiment.frame_of(number, run);
      if (!frames.contains(frame)) {
        FrameChange& of_frame = frames[frame];
        of_frame.positions = run.positions(frame) - run.world().rest_positions;
        for (std::size_t s = 0; s < run.world().supports.size(); ++s)
          of_frame.reactions.push_back(run.frame(frame).reactions[s].second);
      }
      solved.values[i++] = experiment.value_of(number, frames[frame]);
    }
  }
  return solved;
}

DenseMatrix SceneModel::slopes(const Solved& solved) const {
  DenseMatrix J = DenseMatrix::Zero(data_.measured.size(), static_cast<Eigen::Index>(unknowns_.size()));
  Eigen::Index first = 0;
  for (std::size_t e = 0; e < experiments_.size(); ++e) {
    const OfExperiment& experiment = experiments_[e];
    Derivatives& run = *solved.runs[e];
    std::vector<int> frames;
    for (const MeasuredNumber& number : experiment.numbers)
      frames.push_back(experiment.frame_of(number, run));
    std::vector<std::vector<VectorX>> directions;
    std::vector<Eigen::Index> columns;
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      if (!experiment.parameters.contains(unknowns_[u].parameter)) continue;
      std::vector<VectorX> changes;
      for (const auto& [p, found] : experiment.parameters)
        changes.push_back(p == unknowns_[u].parameter ? experiment.change(unknowns_[u])
                                                      : VectorX::Zero(found.parameter.value.size()));
      directions.push_back(std::move(changes));
      columns.push_back(static_cast<Eigen::Index>(u));
    }
    std::vector<bool> is_wanted(static_cast<std::size_t>(run.num_frames()));
    for (const int frame : frames) is_wanted[static_cast<std::size_t>(frame)] = true;
    const std::vector<std::vector<FrameChange>> all = run.forward_all(directions, is_wanted);
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (std::size_t k = 0; k < experiment.numbers.size(); ++k)
        J(first + static_cast<Eigen::Index>(k), columns[c]) =
            experiment.value_of(experiment.numbers[k], all[c][static_cast<std::size_t>(frames[k])]);
    first += static_cast<Eigen::Index>(experiment.numbers.size());
  }
  return J;
}

}  // namespace resilin
