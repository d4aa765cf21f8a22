#pragma once

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "history.hpp"
#include "interruptible.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/sensitivity/derivatives.hpp"
#include "resilin/sensitivity/markers.hpp"
#include "resilin/sensitivity/measured_number.hpp"

namespace resilin::python {

/// (frame, positions, velocities, reactions) with arrays (N, dim), (N, dim), (supports, 3) or None.
using FrameArrays = std::tuple<int, std::optional<Array2d<double>>, std::optional<Array2d<double>>,
                               std::optional<Array2d<double>>>;

inline VectorX flat(const Vector1d<double>& array) {
  return Eigen::Map<const VectorX>(array.data(), static_cast<Eigen::Index>(array.size()));
}

inline NumpyArray<double> array_of(const VectorX& values) {
  return numpy_array(std::vector<double>(values.begin(), values.end()),
                     {static_cast<std::size_t>(values.size())});
}

inline NumpyArray<double> rows_of(const std::vector<Vector3>& rows) {
  std::vector<double> all;
  for (const Vector3& row : rows) all.insert(all.end(), row.begin(), row.end());
  return numpy_array(std::move(all), {rows.size(), 3});
}

/// Name, shape, values.
using ParameterArray = std::tuple<std::string, std::vector<Eigen::Index>, NumpyArray<double>>;

inline ParameterArray parameter_array(const Parameter& parameter) {
  return {parameter.name, parameter.shape, array_of(parameter.value)};
}

/// A run and its derivatives. Long calls leave the GIL to others, and Ctrl-C ends them.
class DifferentiatedRun {
 public:
  using Numbers = std::map<std::string, VectorX>;

  DifferentiatedRun(const Scene& scene, const std::vector<std::string>& wrt,
                    const std::map<std::string, Vector1d<double>>& values, int checkpoints) {
    const Numbers numbers = numbers_of(values);
    interruptibly([&] { run(with_values(scene.description, numbers), wrt, {.checkpoints = checkpoints}); });
  }
  /// One of several that go on at once, without the GIL, until `stops`.
  DifferentiatedRun(Description description, const std::vector<std::string>& wrt,
                    const DerivativeOptions& options, const std::atomic<bool>& stops) {
    stopped_by(stops, [&] { run(std::move(description), wrt, options); });
  }
  DifferentiatedRun(const DifferentiatedRun&) = delete;
  DifferentiatedRun& operator=(const DifferentiatedRun&) = delete;

  static Numbers numbers_of(const std::map<std::string, Vector1d<double>>& values) {
    Numbers numbers;
    for (const auto& [name, array] : values) numbers[name] = flat(array);
    return numbers;
  }
  Derivatives& derivatives() { return *run_; }
  /// Does `work` without the GIL until `stops`.
  template <class Work>
  void stopped_by(const std::atomic<bool>& stops, const Work& work) {
    stops_ = &stops;
    try {
      work();
    } catch (...) {
      stops_ = nullptr;
      throw;
    }
    stops_ = nullptr;
  }

  const World& world() const { return run_->world(); }
  std::vector<ParameterArray> parameters() const {
    std::vector<ParameterArray> all;
    for (const Parameter& parameter : run_->parameters()) all.push_back(parameter_array(parameter));
    return all;
  }
  const std::vector<std::string>& warnings() const { return run_->warnings(); }
  int num_frames() const { return run_->num_frames(); }
  std::vector<int> asked_frames() const { return run_->asked_frames(); }
  /// Load steps that were halved where the way to an equilibrium matters.
  int num_steps_beside_way() const { return world().friction ? run_->num_halved_steps() : 0; }
  std::vector<std::string> supports() const {
    std::vector<std::string> names;
    for (const Support& support : world().supports) names.push_back(support.name);
    return names;
  }
  NumpyArray<double> positions(int frame) {
    VectorX found;
    interruptibly([&] { found = run_->positions(frame); });
    return node_array(scene_places(world(), std::move(found)), world().dimension);
  }
  std::optional<NumpyArray<double>> velocities(int frame) {
    VectorX found;
    interruptibly([&] { found = run_->velocities(frame); });
    std::optional<NumpyArray<double>> array;
    if (found.size() > 0) array = node_array(found, world().dimension);
    return array;
  }
  std::pair<double, double> time_and_load(int frame) const {
    return {run_->frame(frame).time, run_->frame(frame).load};
  }
  NumpyArray<double> reactions(int frame) const {
    std::vector<Vector3> rows;
    for (std::size_t s = 0; s < world().supports.size(); ++s)
      rows.push_back(run_->frame(frame).reactions[s].second);
    return rows_of(rows);
  }
  std::pair<Index, Index> vertex_range(const std::string& name) const {
    const Body& body = body_named(world(), name, "body");
    return {body.first_node, body.first_node + body.num_nodes};
  }

  std::vector<FrameChange> slopes_of(const std::vector<FrameArrays>& frames) const {
    std::vector<FrameChange> slopes(static_cast<std::size_t>(num_frames()));
    for (const auto& [frame, positions, velocities, reactions] : frames) {
      FrameChange& of = slopes.at(static_cast<std::size_t>(frame));
      if (positions) of.positions = unknowns(*positions);
      if (velocities) of.velocities = unknowns(*velocities);
      if (reactions) of.reactions = vectors(*reactions);
    }
    return slopes;
  }
  std::vector<NumpyArray<double>> transposed(const std::vector<FrameArrays>& frames) {
    const std::vector<FrameChange> slopes = slopes_of(frames);
    std::vector<VectorX> found;
    interruptibly([&] { found = run_->transposed(slopes); });
    return arrays_of(found);
  }
  static std::vector<NumpyArray<double>> arrays_of(const std::vector<VectorX>& all) {
    std::vector<NumpyArray<double>> arrays;
    for (const VectorX& values : all) arrays.push_back(array_of(values));
    return arrays;
  }

  /// (positions, velocities or None, reactions) for each frame.
  using ChangeArrays =
      std::vector<std::tuple<NumpyArray<double>, std::optional<NumpyArray<double>>, NumpyArray<double>>>;
  ChangeArrays forward(const std::vector<Vector1d<double>>& changes) {
    const std::vector<VectorX> numbers = flat_all(changes);
    std::vector<FrameChange> found;
    interruptibly([&] { found = run_->forward(numbers); });
    return change_arrays(found);
  }
  static std::vector<VectorX> flat_all(const std::vector<Vector1d<double>>& arrays) {
    std::vector<VectorX> numbers;
    for (const Vector1d<double>& array : arrays) numbers.push_back(flat(array));
    return numbers;
  }
  ChangeArrays change_arrays(const std::vector<FrameChange>& found) const {
    ChangeArrays all;
    for (const FrameChange& of : found) {
      std::optional<NumpyArray<double>> velocities;
      if (of.velocities.size() > 0) velocities = node_array(of.velocities, world().dimension);
      all.emplace_back(node_array(of.positions, world().dimension), velocities, rows_of(of.reactions));
    }
    return all;
  }

  /// Nodes of the world and their weights, which give the places of markers.
  std::vector<std::pair<std::vector<Index>, std::vector<double>>> markers(
      const std::string& body, const std::vector<std::vector<double>>& at) const {
    std::vector<Vector3> points;
    for (const std::vector<double>& place : at) points.push_back(point(place));
    std::vector<std::pair<std::vector<Index>, std::vector<double>>> all;
    for (Marker& found : markers_at(world(), body_named(world(), body, "marker.body"), points,
                                    std::vector<std::string>(points.size(), "marker.at")))
      all.emplace_back(std::move(found.nodes), std::move(found.weights));
    return all;
  }
  /// (3,) [m]
  NumpyArray<double> rest_position(Index node) const {
    return array_of(world().place_of(node, world().rest_positions));
  }
  Index probe(const std::string& name) const { return probe_named(world(), name, "probe").node; }

  /// Values, and slopes by positions, velocities (None where by none) and each parameter, for each number.
  using MeasuredArrays = std::tuple<double, std::optional<NumpyArray<double>>,
                                    std::optional<NumpyArray<double>>, std::vector<NumpyArray<double>>>;
  std::vector<MeasuredArrays> energy(const std::string& kind, const std::optional<std::string>& body,
                                     int frame) {
    return measured([&] {
      const Body* of = body ? &body_named(world(), *body, "energy.body") : nullptr;
      return std::vector<MeasuredNumber>{energy_at(*run_, kind, of, frame)};
    });
  }
  std::vector<MeasuredArrays> stress(const std::string& body, const std::vector<std::vector<double>>& at,
                                     const std::string& component, int frame) {
    std::vector<Vector3> points;
    for (const std::vector<double>& row : at) points.push_back(point(row));
    return measured([&] {
      return stresses_at(*run_, body_named(world(), body, "stress.body"), points, component, frame);
    });
  }
  std::vector<MeasuredArrays> section(const std::string& name, int frame) {
    return measured([&] { return section_force_at(*run_, name, frame); });
  }
  std::vector<MeasuredArrays> moment(const std::string& name, int frame) {
    return measured([&] { return section_moment_at(*run_, name, frame); });
  }
  std::vector<std::string> colliders() const { return collider_names(world()); }
  std::vector<MeasuredArrays> collider_force(const std::string& name, int frame) {
    return measured([&] {
      std::vector<MeasuredNumber> force = collider_force_at(*run_, name, frame);
      force.resize(static_cast<std::size_t>(world().dimension));
      return force;
    });
  }

  /// The volume of a body at a frame and its slopes by the positions.
  std::pair<double, NumpyArray<double>> volume(const std::string& body, int frame) {
    const VectorX x = run_->positions(frame);
    VectorX slopes = VectorX::Zero(x.size());
    const double volume = volume_of(body_named(world(), body, "volume.body"), world().dimension, x, slopes);
    return {volume, node_array(slopes, world().dimension)};
  }

 private:
  static Vector3 point(const std::vector<double>& numbers) {
    Vector3 place = Vector3::Zero();
    for (std::size_t k = 0; k < std::min<std::size_t>(3, numbers.size()); ++k)
      place[static_cast<Eigen::Index>(k)] = numbers[k];
    return place;
  }

  template <class Measure>
  std::vector<MeasuredArrays> measured(const Measure& measure) {
    std::vector<MeasuredNumber> found;
    interruptibly([&] { found = measure(); });
    const auto nodes = [&](const VectorX& slopes) {
      std::optional<NumpyArray<double>> array;
      if (slopes.size() > 0) array = node_array(slopes, world().dimension);
      return array;
    };
    std::vector<MeasuredArrays> all;
    for (const MeasuredNumber& number : found) {
      std::vector<NumpyArray<double>> direct;
      for (const VectorX& slopes : number.by_parameters) direct.push_back(array_of(slopes));
      all.emplace_back(number.value, nodes(number.by_positions), nodes(number.by_velocities),
                       std::move(direct));
    }
    return all;
  }

  void run(Description description, const std::vector<std::string>& wrt, DerivativeOptions options) {
    options.goes_on = [this] { return goes_on(); };
    run_ = Derivatives::run(std::move(description), wrt, options);
  }

  bool goes_on() {
    return !(stops_ != nullptr && *stops_) && !(interruptible_ != nullptr && interruptible_->is_stopped());
  }

  template <class Work>
  void interruptibly(const Work& work) {
    Interruptible interruptible;
    interruptible_ = &interruptible;
    std::exception_ptr failure;
    {
      const nb::gil_scoped_release release;
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
    }
    interruptible_ = nullptr;
    interruptible.rethrow();
    if (failure) std::rethrow_exception(failure);
  }

  std::unique_ptr<Derivatives> run_;
  Interruptible* interruptible_ = nullptr;    ///< call that goes on
  const std::atomic<bool>* stops_ = nullptr;  ///< likewise, where it goes on beside others
};

}  // namespace resilin::python
