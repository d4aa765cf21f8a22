#include "resilin/fit/experiment_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// Relative distance of a moment from the last one.
constexpr double same_moment = 1e-9;
/// Directions of tangent solves that are kept at once.
constexpr std::size_t most_directions = 64;

}  // namespace

ExperimentModel::ExperimentModel(const SceneExperiment& experiment)
    : experiment_(&experiment),
      description_(experiment.description),
      world_(std::make_unique<World>(Description(description_))) {}

void ExperimentModel::spread_over_cells(const SceneParameter& sought) {
  const FoundKey found = find_key(*world_, sought);
  if (sought.key.find(".material.") == std::string::npos || found.component)
    throw InputError(sought.place + ".per", "\"value\", or a constant of a body's material as key",
                     "\"" + sought.key + "\"", "only constants of materials differ from cell to cell");
  require_one_material(*world_, sought);
  if (is_of_cells(found.parameter)) return;
  const auto cells = body_named(*world_, body_of_key(sought.key), sought.place + ".key").num_cells();
  found.parameter.set(VectorX::Constant(cells, found.parameter.value[0]), description_);
  world_ = std::make_unique<World>(Description(description_));
}

std::vector<std::string> ExperimentModel::parameter_keys() const {
  std::vector<std::string> all;
  for (const auto& [which, sought] : parameters_) all.push_back(sought.key.parameter.name);
  return all;
}

std::vector<Marker> ExperimentModel::markers_of(const MeasuredTable& table) const {
  if (table.kind == MeasuredKind::probe) {
    const Probe& probe = probe_named(*world_, table.of, table.place + ".of");
    if (probe.carriers.empty()) return {Marker{{probe.node}, {1}}};
    Marker marker;
    for (const auto& [node, weight] : probe.carriers) {
      marker.nodes.push_back(node);
      marker.weights.push_back(weight);
    }
    return {marker};
  }
  if (!has_places(table.kind)) return {};
  std::vector<Vector3> points;
  std::vector<std::string> places;
  for (const MeasuredRow& row : table.rows) {
    points.push_back(row.at);
    places.push_back(row.place);
  }
  return markers_at(*world_, body_named(*world_, table.of, table.place + ".of"), points, places,
                    table.tolerance.value_or(0));
}

void ExperimentModel::measure(const MeasuredTable& table) {
  const std::vector<Marker> markers = markers_of(table);
  Number number{.table = &table, .row = nullptr};
  number.is_linear = table.kind == MeasuredKind::markers || table.kind == MeasuredKind::probe;
  if (table.kind == MeasuredKind::reaction) {
    std::vector<std::string> names;
    for (const Support& one : world_->supports) names.push_back(one.name);
    number.support = static_cast<std::size_t>(std::ranges::find(names, table.of) - names.begin());
    number.is_linear = number.support < names.size();
    const std::vector<std::string> colliders = collider_names(*world_);
    names.insert(names.end(), colliders.begin(), colliders.end());
    if (std::ranges::find(names, table.of) == names.end()) refuse_word(table.place + ".of", table.of, names);
  } else if (table.kind == MeasuredKind::section || table.kind == MeasuredKind::moment) {
    section_named(*world_, table.of, table.place + ".of");
  } else if (table.kind == MeasuredKind::volume ||
             (table.kind == MeasuredKind::energy && !table.of.empty())) {
    body_named(*world_, table.of, table.place + ".of");
  }
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    for (std::size_t i = 0; i < 3; ++i) {
      if (!table.rows[r].is_measured[i]) continue;
      number.row = &table.rows[r];
      number.component = static_cast<Eigen::Index>(i);
      if (!markers.empty()) number.marker = markers[markers.size() == 1 ? 0 : r];
      numbers_.push_back(number);
    }
}

Description ExperimentModel::changed(const std::function<const double*(std::size_t)>& values) const {
  Description changed = description_;
  for (const auto& [p, sought] : parameters_) {
    VectorX value = sought.key.parameter.value;
    const double* of_parameter = values(p);
    for (std::size_t i = 0; i < sought.which.size(); ++i)
      if (sought.which[i] >= 0) value[static_cast<Eigen::Index>(i)] = of_parameter[sought.which[i]];
    sought.key.parameter.set(value, changed);
  }
  return changed;
}

/// Index of the frame of a measured row.
int ExperimentModel::frame_of(const MeasuredRow& row, const Derivatives& run) const {
  const int last = run.num_frames() - 1;
  if (!row.moment) return last;
  const auto moment = [&](int frame) {
    return world_->is_dynamic ? run.frame(frame).time : run.frame(frame).load;
  };
  for (int frame = 0; frame <= last; ++frame)
    if (std::abs(moment(frame) - *row.moment) <= same_moment * std::abs(moment(last))) return frame;
  std::string there;
  for (int frame = 0; frame <= std::min(last, 5); ++frame)
    there += (there.empty() ? "" : ", ") + format_number(moment(frame));
  if (last > 5) there += " ... " + format_number(moment(last));
  throw InputError(world_->place,
                   std::string("a frame at ") + (world_->is_dynamic ? "time " : "load ") +
                       format_number(*row.moment) + ", where there are measurements",
                   "frames at " + there,
                   world_->is_dynamic ? "choose simulation.time_step so that a step ends there"
                                      : "choose simulation.load_steps so that a step ends there");
}

double ExperimentModel::linear_value(const Number& number, const FrameChange& frame) const {
  if (number.marker.nodes.empty()) return frame.reactions[number.support][number.component];
  double value = 0;
  for (std::size_t k = 0; k < number.marker.nodes.size(); ++k)
    value += number.marker.weights[k] *
             frame.positions[Eigen::Index{number.marker.nodes[k]} * world_->dimension + number.component];
  return value;
}

FrameChange ExperimentModel::linear_slopes(const Number& number) const {
  FrameChange slopes;
  if (number.marker.nodes.empty()) {
    slopes.reactions.assign(world_->supports.size(), Vector3::Zero());
    slopes.reactions[number.support][number.component] = 1;
    return slopes;
  }
  slopes.positions = VectorX::Zero(world_->rest_positions.size());
  for (std::size_t k = 0; k < number.marker.nodes.size(); ++k)
    slopes.positions[Eigen::Index{number.marker.nodes[k]} * world_->dimension + number.component] +=
        number.marker.weights[k];
  return slopes;
}

/// All components of what a number is one of.
std::vector<MeasuredNumber> ExperimentModel::measured_at(Derivatives& run, const Number& number,
                                                         int frame) const {
  const MeasuredTable& table = *number.table;
  const World& world = run.world();
  switch (table.kind) {
    case MeasuredKind::reaction:
      return collider_force_at(run, table.of, frame);
    case MeasuredKind::section:
      return section_force_at(run, table.of, frame);
    case MeasuredKind::moment:
      return section_moment_at(run, table.of, frame);
    case MeasuredKind::energy:
      return {energy_at(run, table.what,
                        table.of.empty() ? nullptr : &body_named(world, table.of, table.place), frame)};
    case MeasuredKind::volume:
      return {volume_at(run, body_named(world, table.of, table.place), frame)};
    case MeasuredKind::stress:
      return stresses_at(run, body_named(world, table.of, table.place), {number.row->at}, table.what, frame);
    case MeasuredKind::markers:
    case MeasuredKind::probe:
      break;
  }
  return {};
}

ExperimentModel::Outcome ExperimentModel::outcome_of(Derivatives& run) const {
  Outcome outcome;
  outcome.values = VectorX(num_values());
  std::map<int, FrameChange> frames;
  std::vector<MeasuredNumber> components;
  const MeasuredRow* row = nullptr;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const Number& number = numbers_[i];
    const int frame = frame_of(*number.row, run);
    outcome.frames.push_back(frame);
    if (!number.is_linear) {
      if (row != number.row) components = measured_at(run, number, frame);
      row = number.row;
      outcome.nonlinear.push_back(components[static_cast<std::size_t>(number.component)]);
      outcome.values[static_cast<Eigen::Index>(i)] = outcome.nonlinear.back().value;
      continue;
    }
    outcome.nonlinear.emplace_back();
    if (!frames.contains(frame)) {
      FrameChange& of_frame = frames[frame];
      of_frame.positions = run.positions(frame) - run.world().rest_positions;
      for (std::size_t s = 0; s < run.world().supports.size(); ++s)
        of_frame.reactions.push_back(run.frame(frame).reactions[s].second);
    }
    outcome.values[static_cast<Eigen::Index>(i)] = linear_value(number, frames[frame]);
  }
  return outcome;
}

Eigen::Index ExperimentModel::num_sought() const {
  Eigen::Index sum = 0;
  for (const auto& [p, sought] : parameters_) sum += sought.count;
  return sum;
}

DenseMatrix ExperimentModel::slopes(Derivatives& run, const Outcome& outcome) const {
  DenseMatrix J = DenseMatrix::Zero(num_values(), num_sought());
  if (num_sought() <= num_values())
    add_forward_slopes(run, outcome, J);
  else
    add_transposed_slopes(run, outcome, J);
  return J;
}

void ExperimentModel::add_forward_slopes(Derivatives& run, const Outcome& outcome, DenseMatrix& J) const {
  std::vector<bool> is_wanted(static_cast<std::size_t>(run.num_frames()));
  for (const int frame : outcome.frames) is_wanted[static_cast<std::size_t>(frame)] = true;
  std::vector<VectorX> zero;
  for (const auto& [p, sought] : parameters_)
    zero.push_back(VectorX::Zero(sought.key.parameter.value.size()));
  std::vector<std::vector<VectorX>> directions;
  Eigen::Index done = 0;
  const auto solve = [&] {
    const std::vector<std::vector<FrameChange>> all = run.forward_all(directions, is_wanted);
    for (std::size_t d = 0; d < directions.size(); ++d, ++done)
      for (std::size_t k = 0; k < numbers_.size(); ++k) {
        const FrameChange& frame = all[d][static_cast<std::size_t>(outcome.frames[k])];
        J(static_cast<Eigen::Index>(k), done) = numbers_[k].is_linear
                                                    ? linear_value(numbers_[k], frame)
                                                    : outcome.nonlinear[k].change(frame, directions[d]);
      }
    directions.clear();
  };
  std::size_t number = 0;
  for (const auto& [p, sought] : parameters_) {
    for (Eigen::Index which = 0; which < sought.count; ++which) {
      std::vector<VectorX> changes = zero;
      for (std::size_t i = 0; i < sought.which.size(); ++i)
        if (sought.which[i] == which) changes[number][static_cast<Eigen::Index>(i)] = 1;
      directions.push_back(std::move(changes));
      if (directions.size() == most_directions) solve();
    }
    ++number;
  }
  if (!directions.empty()) solve();
}

void ExperimentModel::add_transposed_slopes(Derivatives& run, const Outcome& outcome, DenseMatrix& J) const {
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    std::vector<FrameChange> slopes(static_cast<std::size_t>(outcome.frames[k]) + 1);
    const MeasuredNumber& direct = outcome.nonlinear[k];
    if (numbers_[k].is_linear) {
      slopes.back() = linear_slopes(numbers_[k]);
    } else {
      slopes.back().positions = direct.by_positions;
      slopes.back().velocities = direct.by_velocities;
    }
    const std::vector<VectorX> found = run.transposed(slopes);
    Eigen::Index first = 0;
    std::size_t number = 0;
    for (const auto& [p, sought] : parameters_) {
      for (std::size_t i = 0; i < sought.which.size(); ++i) {
        if (sought.which[i] < 0) continue;
        double& slope = J(static_cast<Eigen::Index>(k), first + sought.which[i]);
        slope += found[number][static_cast<Eigen::Index>(i)];
        if (!numbers_[k].is_linear) slope += direct.by_parameters[number][static_cast<Eigen::Index>(i)];
      }
      first += sought.count;
      ++number;
    }
  }
}

}  // namespace resilin
