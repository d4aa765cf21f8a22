#include "resilin/scene/frame_file.hpp"

#include "resilin/io/vtu.hpp"

namespace resilin {

void write_frame(std::ostream& stream, const World& world, const State& state,
                 std::span<const FieldValues> fields) {
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
  for (const auto& [field, values] : fields) {
    auto& arrays = field->is_on_nodes ? data.point_data : data.cell_data;
    arrays.push_back({.name = field->name, .components = field->components(), .values = values});
  }
  write_vtu(stream, data);
}

}  // namespace resilin
