#include "resilin/fields/evaluator.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "resilin/fields/quantities.hpp"

namespace resilin {
namespace {

/// Three numbers for each node; the third is zero in 2D.
std::vector<double> nodal_vectors(const VectorX& values, int dim) {
  const Eigen::Index num_nodes = values.size() / dim;
  std::vector<double> vectors(static_cast<std::size_t>(3 * num_nodes), 0.0);
  for (Eigen::Index node = 0; node < num_nodes; ++node)
    for (int i = 0; i < dim; ++i) vectors[static_cast<std::size_t>(3 * node + i)] = values[dim * node + i];
  return vectors;
}

/// Means over the cells' rest volume.
std::vector<double> cell_means(const Domains& domains, const std::vector<double>& points,
                               std::size_t components) {
  const std::vector<double> volumes = domains.point_volumes();
  const auto num_points = static_cast<std::size_t>(domains.num_points());
  if (num_points == 1) return points;
  std::vector<double> means(points.size() / num_points, 0.0);
  for (std::size_t cell = 0; cell * num_points < volumes.size(); ++cell) {
    double total = 0;
    for (std::size_t q = 0; q < num_points; ++q) {
      const std::size_t point = cell * num_points + q;
      total += volumes[point];
      for (std::size_t k = 0; k < components; ++k)
        means[cell * components + k] += volumes[point] * points[point * components + k];
    }
    for (std::size_t k = 0; k < components; ++k) means[cell * components + k] /= total;
  }
  return means;
}

/// The samples that the asked fields share, of one state: taken once, reduced once.
class Samples {
 public:
  Samples(const World& world, const State& state) : world_(world), state_(state) {}

  const std::vector<double>& at_points(const CellQuantity& quantity, std::size_t body) {
    auto [place, is_new] = points_.try_emplace({quantity.sample, body});
    const Domains& domains = world_.bodies[body].domains;
    if (is_new)
      place->second = domains.by_cell([&](const Domain& domain) {
        return quantity.sample({world_, body, static_cast<std::size_t>(&domain - &domains.front()), state_});
      });
    return place->second;
  }

  /// `reduce(body, samples)` gives the means of cells or the values at nodes.
  template <class Reduce>
  const std::vector<double>& reduced(const CellQuantity& quantity, bool is_fitted, const Reduce& reduce) {
    auto [place, is_new] = reduced_.try_emplace({quantity.sample, is_fitted});
    if (!is_new) return place->second;
    for (std::size_t body = 0; body < world_.bodies.size(); ++body) {
      const std::vector<double> part = reduce(body, at_points(quantity, body));
      place->second.insert(place->second.end(), part.begin(), part.end());
    }
    return place->second;
  }

 private:
  const World& world_;
  const State& state_;
  std::map<std::pair<Sampler, std::size_t>, std::vector<double>> points_;
  std::map<std::pair<Sampler, bool>, std::vector<double>> reduced_;
};

std::vector<double> derived(const CellQuantity& quantity, int components,
                            const std::vector<double>& samples) {
  if (quantity.derive == nullptr) return samples;
  const auto from = static_cast<std::size_t>(quantity.sample_components);
  const auto to = static_cast<std::size_t>(components);
  std::vector<double> values(samples.size() / from * to);
  for (std::size_t i = 0; i * from < samples.size(); ++i)
    quantity.derive(samples.data() + i * from, values.data() + i * to);
  return values;
}

const CellQuantity* find_quantity(const FieldInfo& field) {
  std::string_view name = field.name;
  if (field.source == FieldInfo::Source::averages) name.remove_prefix(averaged_prefix.size());
  if (field.source == FieldInfo::Source::fit) name.remove_prefix(nodal_prefix.size());
  const auto found = std::ranges::find(cell_quantities(), name, &CellQuantity::name);
  return found == cell_quantities().end() ? nullptr : &*found;
}

/// Rigid bodies and regions have no values but their motion: nan.
void leave_out_rigid_bodies(const World& world, FieldValues& field) {
  const auto width = static_cast<std::size_t>(field.field->components());
  std::size_t first_cell = 0;
  const bool is_on_nodes = field.field->is_on_nodes();
  const auto leave_out = [&](std::size_t first, std::size_t count) {
    std::fill_n(field.values.begin() + static_cast<std::ptrdiff_t>(first * width), count * width,
                std::numeric_limits<double>::quiet_NaN());
  };
  for (const Body& body : world.bodies) {
    const auto num_cells = static_cast<std::size_t>(body.num_cells());
    if (body.rigid) {
      const std::size_t first = is_on_nodes ? static_cast<std::size_t>(body.first_node) : first_cell;
      const std::size_t count = is_on_nodes ? static_cast<std::size_t>(body.num_nodes) : num_cells;
      leave_out(first, count);
    }
    if (body.domains.have_rigid_ones()) {
      const std::vector<double> volumes = body.domains.deformable_volumes();
      std::vector<bool> is_deformable(static_cast<std::size_t>(body.num_nodes), false);
      const std::size_t nodes_per_cell = volumes.empty() ? 0 : body.cells.size() / volumes.size();
      for (std::size_t i = 0; i < body.cells.size(); ++i)
        if (volumes[i / nodes_per_cell] > 0)
          is_deformable[static_cast<std::size_t>(body.cells[i] - body.first_node)] = true;
      for (std::size_t i = 0; i < (is_on_nodes ? is_deformable.size() : volumes.size()); ++i)
        if (is_on_nodes ? !is_deformable[i] : volumes[i] == 0)
          leave_out((is_on_nodes ? static_cast<std::size_t>(body.first_node) : first_cell) + i, 1);
    }
    first_cell += num_cells;
  }
}

}  // namespace

FieldEvaluator::FieldEvaluator(const World& world, std::shared_ptr<const CellAverages> averages)
    : world_(world), averages_(std::move(averages)), fits_(world.bodies.size()) {}

const CellAverages& FieldEvaluator::averages() {
  if (!averages_) averages_ = std::make_shared<const CellAverages>(world_);
  return *averages_;
}

NodalFit& FieldEvaluator::fit_of(std::size_t body) {
  if (!fits_[body]) fits_[body] = std::make_unique<NodalFit>(world_.bodies[body]);
  return *fits_[body];
}

std::vector<FieldValues> FieldEvaluator::evaluate(const State& state, std::span<const std::string> names) {
  Samples samples(world_, state);
  std::vector<FieldValues> results;
  for (const std::string& name : names) {
    const FieldInfo& field = require_field(name, "fields");
    const auto node_quantity = std::ranges::find(node_quantities(), name, &NodeQuantity::name);
    if (node_quantity != node_quantities().end()) {
      const VectorX values = node_quantity->values(world_, state);
      results.push_back({&field, field.components() == 1 ? std::vector<double>(values.begin(), values.end())
                                                         : nodal_vectors(values, world_.dimension)});
      if (!node_quantity->is_motion) leave_out_rigid_bodies(world_, results.back());
      continue;
    }
    const CellQuantity& quantity = *find_quantity(field);
    const int components = quantity.sample_components;
    const bool is_fitted = field.source == FieldInfo::Source::fit;
    const auto reduce = [&](std::size_t body, const std::vector<double>& points) {
      return is_fitted
                 ? fit_of(body).fit(points, components)
                 : cell_means(world_.bodies[body].domains, points, static_cast<std::size_t>(components));
    };
    std::vector<double> values =
        derived(quantity, field.components(), samples.reduced(quantity, is_fitted, reduce));
    if (field.source == FieldInfo::Source::averages)
      values = averages().at_nodes(values, static_cast<std::size_t>(field.components()));
    results.push_back({&field, std::move(values)});
    leave_out_rigid_bodies(world_, results.back());
  }
  return results;
}

}  // namespace resilin
