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

/// Calls a function of ElasticEnergy for every body and puts the values one after another.
std::vector<double> cell_values(const World& world, const State& state,
                                std::vector<double> (ElasticEnergy::*values)(const VectorX&) const) {
  std::vector<double> all;
  for (const Body& body : world.bodies) {
    const std::vector<double> of_body = (body.elastic.get()->*values)(state.positions);
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
    for (const Matrix<3>& stress : body.elastic->cauchy_stresses(state.positions)) {
      all.insert(all.end(), stress.data(),
                 stress.data() + 9);  // symmetric: by rows and by columns are the same
    }
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
  CellBlock cells{.kind = world.bodies.front().cell_kind, .nodes = {}};
  std::vector<double> body_numbers;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    cells.nodes.insert(cells.nodes.end(), body.cells.begin(), body.cells.end());
    body_numbers.insert(body_numbers.end(), static_cast<std::size_t>(body.num_cells()),
                        static_cast<double>(b));
  }
  VtuData data{.points = points,
               .blocks = {&cells, 1},
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
