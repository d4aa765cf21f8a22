#include "resilin/fit/scene_model.hpp"

#include <algorithm>
#include <set>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"

namespace resilin {

SceneModel::SceneModel(const SceneFitDescription& description) : description_(description) {
  for (const SceneExperiment& experiment : description.experiments) experiments_.emplace_back(experiment);
  find_unknowns();
  collect_data();
}

SceneModel::~SceneModel() = default;

bool SceneModel::has_fields() const { return std::ranges::any_of(ranges_, &UnknownRange::is_field); }

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
    for (ExperimentModel& model : experiments_) {
      names.push_back(model.experiment().name);
      if (!sought.experiment.empty() && sought.experiment != names.back()) continue;
      if (sought.per != SoughtPer::value) model.spread_over_cells(sought);
    }
    if (!sought.experiment.empty() && std::ranges::find(names, sought.experiment) == names.end())
      refuse_word(sought.place + ".experiment", sought.experiment, names);
  }
  for (std::size_t p = 0; p < description_.parameters.size(); ++p)
    ranges_.push_back(add_unknowns(description_, p, experiments_, unknowns_));
}

void SceneModel::collect_data() {
  std::vector<double> measured, sigma;
  std::string with_sigma, without;
  std::set<std::string> units;
  for (std::size_t e = 0; e < experiments_.size(); ++e)
    for (const MeasuredTable& table : description_.experiments[e].tables) {
      const auto first = static_cast<Eigen::Index>(measured.size());
      experiments_[e].measure(table);
      for (const MeasuredRow& row : table.rows)
        for (std::size_t i = 0; i < 3; ++i)
          if (row.is_measured[i]) {
            measured.push_back(row.value[static_cast<Eigen::Index>(i)]);
            sigma.push_back(row.sigma);
            data_.places.push_back({row.place, static_cast<int>(i), row.moment, row.at});
            (row.sigma > 0 ? with_sigma : without) = table.place;
          }
      units.insert(unit_of(table.kind));
      const std::string of = table.of.empty() || has_places(table.kind) ? "" : " of " + table.of;
      const std::string what =
          table.kind == MeasuredKind::stress || table.kind == MeasuredKind::energy ? ", " + table.what : "";
      data_.tables.push_back({e, table.kind,
                              description_.experiments[e].name + ": " + spelling(table.kind) + of + what,
                              first, static_cast<Eigen::Index>(measured.size()) - first});
    }
  if (!without.empty() && (!with_sigma.empty() || units.size() > 1))
    throw InputError(without,
                     with_sigma.empty() ? "a sigma of each, by which " +
                                              join(std::vector<std::string>(units.begin(), units.end())) +
                                              " are weighed against each other"
                                        : std::string("a sigma, as other measurements have one"),
                     "none", "add sigma = ..., the standard deviation of the numbers");
  data_.measured = Eigen::Map<const VectorX>(measured.data(), static_cast<Eigen::Index>(measured.size()));
  if (without.empty())
    data_.sigma = Eigen::Map<const VectorX>(sigma.data(), static_cast<Eigen::Index>(sigma.size()));
  if (measured.size() < unknowns_.size() && !has_fields())
    throw InputError(description_.place,
                     "at least " + std::to_string(unknowns_.size()) + " measured numbers for the " +
                         std::to_string(unknowns_.size()) + " parameters",
                     std::to_string(measured.size()), "measure more, or seek fewer");
}

/// As the scene says which elements.
Description SceneModel::changed(std::size_t e, const VectorX& unknowns) const {
  return experiments_[e].changed([&](std::size_t p) { return unknowns.data() + ranges_[p].first; });
}

Description SceneModel::description_with(std::size_t e, const VectorX& unknowns) const {
  Description description = changed(e, unknowns);
  keep_elements(description, world(e));
  return description;
}

std::vector<std::string> SceneModel::other_elements(const VectorX& unknowns) const {
  std::vector<std::string> others;
  for (std::size_t e = 0; e < experiments_.size(); ++e) {
    const std::vector<Body>& kept = world(e).bodies;
    if (std::ranges::all_of(kept, [](const Body& body) { return body.element_reason.empty(); })) continue;
    const World chosen(changed(e, unknowns));
    for (std::size_t b = 0; b < kept.size(); ++b)
      if (chosen.bodies[b].element != kept[b].element)
        others.push_back(world(e).place + ": " + kept[b].name + ": the fit kept element = \"" +
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
  Eigen::Index first = 0;
  for (std::size_t e = 0; e < experiments_.size(); ++e) {
    const ExperimentModel& experiment = experiments_[e];
    solved.runs.push_back(
        Derivatives::run(description_with(e, unknowns), experiment.parameter_keys(),
                         {.checkpoints = 0, .estimates_errors = false, .goes_on = goes_on}));
    solved.outcomes.push_back(experiment.outcome_of(*solved.runs.back()));
    solved.values.segment(first, experiment.num_values()) = solved.outcomes.back().values;
    first += experiment.num_values();
  }
  return solved;
}

DenseMatrix SceneModel::slopes(const Solved& solved) const {
  DenseMatrix J = DenseMatrix::Zero(data_.measured.size(), static_cast<Eigen::Index>(unknowns_.size()));
  Eigen::Index row = 0;
  for (std::size_t e = 0; e < experiments_.size(); ++e) {
    const ExperimentModel& experiment = experiments_[e];
    const DenseMatrix own = experiment.slopes(*solved.runs[e], solved.outcomes[e]);
    Eigen::Index column = 0;
    for (const auto& [p, sought] : experiment.parameters()) {
      const UnknownRange& range = ranges_[p];
      J.block(row, range.first, own.rows(), range.count) = own.middleCols(column, range.count);
      column += range.count;
    }
    row += own.rows();
  }
  return J;
}

}  // namespace resilin
