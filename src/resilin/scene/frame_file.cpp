#include "resilin/scene/frame_file.hpp"

#include <algorithm>
#include <functional>

#include "resilin/io/vtu.hpp"

namespace resilin {
namespace {

/// Three numbers for each node; the third is zero in 2D.
std::vector<double> nodal_vectors(const VectorX& values, int dim) {
  const Eigen::Index num_nodes = values.size() / dim;
  std::vector<double> vectors(static_cast<std::size_t>(3 * num_nodes), 0.0);
  for (Eigen::Index node = 0; node < num_nodes; ++node) {
    for (int i = 0; i < dim; ++i) vectors[static_cast<std::size_t>(3 * node + i)] = values[dim * node + i];
  }
  return vectors;
}

std::vector<double> displacement(const World& world, const State& state) {
  return nodal_vectors(state.positions - world.rest_positions, world.dimension);
}

std::vector<double> velocity(const World& world, const State& state) {
  return nodal_vectors(state.velocities, world.dimension);
}

/// Means over the cells of a body of values at its quadrature points, each with the rest volume that it
/// stands for; `components` numbers for each point.
std::vector<double> cell_means(const ElasticEnergy& elastic, std::span<const double> values,
                               std::size_t components) {
  const std::vector<double> volumes = elastic.point_volumes();
  const auto num_points = static_cast<std::size_t>(elastic.num_points());
  std::vector<double> means(values.size() / num_points, 0.0);
  for (std::size_t cell = 0; cell < means.size() / components; ++cell) {
    double volume = 0;
    for (std::size_t q = cell * num_points; q < (cell + 1) * num_points; ++q) {
      volume += volumes[q];
      for (std::size_t i = 0; i < components; ++i)
        means[cell * components + i] += volumes[q] * values[q * components + i];
    }
    for (std::size_t i = 0; i < components; ++i) means[cell * components + i] /= volume;
  }
  return num_points == 1 ? std::vector<double>(values.begin(), values.end()) : means;
}

/// Calls a function of ElasticEnergy for every body and puts the means of cells one after another.
std::vector<double> cell_values(const World& world, const State& state,
                                std::vector<double> (ElasticEnergy::*values)(const VectorX&) const) {
  std::vector<double> all;
  for (const Body& body : world.bodies) {
    const std::vector<double> of_body =
        cell_means(*body.elastic, (body.elastic.get()->*values)(state.positions), 1);
    all.insert(all.end(), of_body.begin(), of_body.end());
  }
  return all;
}

std::vector<double> volume_ratio(const World& world, const State& state) {
  return cell_values(world, state, &ElasticEnergy::volume_ratios);
}

std::vector<double> energy_density(const World& world, const State& state) {
  return cell_values(world, state, &ElasticEnergy::energy_densities);
}

std::vector<double> von_mises(const World& world, const State& state) {
  return cell_values(world, state, &ElasticEnergy::von_mises_stresses);
}

std::vector<double> cauchy_stress(const World& world, const State& state) {
  std::vector<double> all;
  for (const Body& body : world.bodies) {
    std::vector<double> at_points;
    for (const Matrix<3>& stress : body.elastic->cauchy_stresses(state.positions)) {
      at_points.insert(at_points.end(), stress.data(),
                       stress.data() + 9);  // symmetric: by rows and by columns are the same
    }
    const std::vector<double> of_body = cell_means(*body.elastic, at_points, 9);
    all.insert(all.end(), of_body.begin(), of_body.end());
  }
  return all;
}

constexpr FrameField fields[] = {
    {"displacement", 3, true, displacement},    {"velocity", 3, true, velocity},
    {"cauchy_stress", 9, false, cauchy_stress}, {"von_mises", 1, false, von_mises},
    {"volume_ratio", 1, false, volume_ratio},   {"energy_density", 1, false, energy_density},
};

}  // namespace

std::span<const FrameField> frame_fields() { return fields; }

std::vector<std::string> frame_field_names() {
  std::vector<std::string> names;
  for (const FrameField& field : fields) names.emplace_back(field.name);
  return names;
}

void write_frame(std::ostream& stream, const World& world, const State& state) {
  std::vector<Vector3> points(static_cast<std::size_t>(world.num_nodes()), Vector3::Zero());
  for (Index node = 0; node < world.num_nodes(); ++node) {
    points[static_cast<std::size_t>(node)].head(world.dimension) =
        state.positions.segment(Eigen::Index{node} * world.dimension, world.dimension);
  }
  std::vector<CellBlock> blocks;
  std::vector<double> body_numbers;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    blocks.push_back({body.cell_kind, body.cells});
    body_numbers.insert(body_numbers.end(), static_cast<std::size_t>(body.num_cells()),
                        static_cast<double>(b));
  }
  VtuData data{.points = points,
               .blocks = blocks,
               .point_data = {},
               .cell_data = {{.name = "body", .components = 1, .values = body_numbers}},
               .time = world.modes        ? state.step
                       : world.is_dynamic ? state.time
                                          : state.load};
  std::vector<std::vector<double>> storage;  // of which the arrays are views
  storage.reserve(std::size(fields));
  for (const FrameField& field : fields) {
    if (std::ranges::find(world.output.fields, field.name) == world.output.fields.end()) continue;
    storage.push_back(field.values(world, state));
    auto& arrays = field.is_on_points ? data.point_data : data.cell_data;
    arrays.push_back({.name = field.name, .components = field.components, .values = storage.back()});
  }
  write_vtu(stream, data);
}

}  // namespace resilin
