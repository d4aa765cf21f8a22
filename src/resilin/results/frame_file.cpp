#include "resilin/results/frame_file.hpp"

#include <algorithm>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/output_file.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/frame_history.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

/// The cells that a frame shows: those of a rigid body are those of its mesh.
CellKind shown_kind(const Body& body) { return body.rigid ? body.rigid->body.cell_kind : body.cell_kind; }
bool has_own_mesh(const Body& body) { return body.rigid && !body.rigid->is_region(); }
std::ptrdiff_t num_shown_cells(const Body& body) {
  if (body.rigid && body.rigid->is_region()) return 0;
  return body.rigid ? body.rigid->body.num_cells() : body.num_cells();
}

/// Bodies with those of the same kind of cell behind the first of them.
std::vector<std::size_t> bodies_by_kind(const World& world) {
  std::vector<std::size_t> order;
  for (std::size_t first = 0; first < world.bodies.size(); ++first)
    for (std::size_t b = first; b < world.bodies.size(); ++b)
      if (shown_kind(world.bodies[b]) == shown_kind(world.bodies[first]) &&
          std::ranges::find(order, b) == order.end())
        order.push_back(b);
  return order;
}

/// Values by cell, body after body, as those of the shown cells in another order of the bodies. All cells of
/// a rigid body have the values of its one.
std::vector<double> shown_values(const std::vector<double>& values, int components, const World& world,
                                 const std::vector<std::size_t>& order) {
  std::vector<std::ptrdiff_t> begin = {0};
  for (const Body& body : world.bodies)
    begin.push_back(begin.back() + std::ptrdiff_t{components} * body.num_cells());
  std::vector<double> result;
  for (const std::size_t b : order)
    for (std::ptrdiff_t i = world.bodies[b].rigid ? 1 : num_shown_cells(world.bodies[b]);
         i <= num_shown_cells(world.bodies[b]); ++i)
      result.insert(result.end(), values.begin() + begin[b], values.begin() + begin[b + 1]);
  return result;
}

/// The inverse.
std::vector<double> in_order_of_bodies(const std::vector<double>& values, int components, const World& world,
                                       const std::vector<std::size_t>& order) {
  std::vector<std::ptrdiff_t> begin = {0};
  for (const Body& body : world.bodies)
    begin.push_back(begin.back() + std::ptrdiff_t{components} * body.num_cells());
  std::vector<double> result(static_cast<std::size_t>(begin.back()));
  auto from = values.begin();
  for (const std::size_t b : order) {
    if (num_shown_cells(world.bodies[b]) == 0) continue;  // a rigid region: its cells are those of its body
    std::copy_n(from, begin[b + 1] - begin[b], result.begin() + begin[b]);
    from += components * num_shown_cells(world.bodies[b]);
  }
  return result;
}

/// The vertices of rigid bodies behind the nodes of the world.
void add_rigid_vertices(const World& world, int components, std::vector<double>& values) {
  const std::size_t num_nodal = values.size();
  for (const Body& body : world.bodies) {
    if (!has_own_mesh(body)) continue;
    const std::vector<double> own =
        body.rigid->at_vertices(std::span(values).first(num_nodal), components, body.first_node);
    values.insert(values.end(), own.begin(), own.end());
  }
}

}  // namespace

VectorX frame_history(const World& world, const VtuContent& frame) {
  const int width = history_width(world);
  const auto found = std::ranges::find(frame.cell_data, history_name, &VtuValues::name);
  std::size_t num_cells = 0;
  for (const Body& body : world.bodies) num_cells += static_cast<std::size_t>(num_shown_cells(body));
  if (width == 0 || found == frame.cell_data.end() || found->components != width ||
      found->values.size() != num_cells * static_cast<std::size_t>(width))
    return {};
  return history_of_cells(world, in_order_of_bodies(found->values, width, world, bodies_by_kind(world)));
}

VtuContent frame_content(const World& world, const State& state, std::span<const FieldValues> fields) {
  VtuContent content;
  Mesh& mesh = content.file.mesh;
  mesh.vertices.assign(static_cast<std::size_t>(world.num_nodes()), Vector3::Zero());
  for (Index node = 0; node < world.num_nodes(); ++node)
    mesh.vertices[static_cast<std::size_t>(node)] = world.place_of(node, state.positions);
  std::vector<Index> first_point;  // by body, for the nodes of its shown cells
  for (const Body& body : world.bodies) {
    first_point.push_back(body.rigid ? static_cast<Index>(mesh.vertices.size()) : 0);
    if (!has_own_mesh(body)) continue;
    const CarriedPoints points = body.rigid->carried_vertices(body.first_node);
    for (Index v = 0; v < points.num_points(); ++v)
      mesh.vertices.push_back(world.origin + points.at(world.dimension, v, state.positions));
  }
  const std::vector<std::size_t> order = bodies_by_kind(world);
  VtuValues body_numbers{.name = "body", .components = 1, .values = {}};
  for (const std::size_t b : order) {
    const Body& body = world.bodies[b];
    if (num_shown_cells(body) == 0) continue;
    std::vector<Index>& nodes = mesh.block(shown_kind(body)).nodes;
    for (const Index node : body.rigid ? body.rigid->body.cells : body.cells)
      nodes.push_back(first_point[b] + node);
    body_numbers.values.insert(body_numbers.values.end(), static_cast<std::size_t>(num_shown_cells(body)),
                               static_cast<double>(b));
  }
  content.cell_data.push_back(std::move(body_numbers));
  for (const auto& [field, values] : fields) {
    if (field->is_on_nodes()) {
      content.point_data.push_back({field->name, field->components(), values});
      add_rigid_vertices(world, field->components(), content.point_data.back().values);
    } else {
      content.cell_data.push_back(
          {field->name, field->components(), shown_values(values, field->components(), world, order)});
    }
  }
  if (state.history.size() > 0) {
    const int width = history_width(world);
    content.cell_data.push_back(
        {history_name, width, shown_values(history_by_cell(world, state.history), width, world, order)});
  }
  content.time = shown_time(world, state);
  if (state.collider_delay > 0) content.numbers[delay_name] = state.collider_delay;
  return content;
}

std::string numbered_vtu(std::size_t number) {
  const std::string digits = std::to_string(number);
  return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits + ".vtu";
}

double shown_time(const World& world, const State& state) {
  return world.modes ? state.step : world.is_dynamic ? state.time : state.load;
}

void set_shown_time(double shown, const World& world, State& state) {
  if (world.modes) state.step = static_cast<int>(shown);
  const Conditions conditions =
      world.is_dynamic ? Conditions{.time = shown, .load = 1} : world.at_load(world.modes ? 1 : shown);
  state.time = conditions.time;
  state.load = conditions.load;
}

void write_frame(const std::filesystem::path& path, const VtuContent& content) {
  VtuData data{.points = content.file.mesh.vertices,
               .blocks = content.file.mesh.blocks,
               .point_data = {},
               .cell_data = {},
               .time = content.time,
               .numbers = content.numbers};
  for (const VtuValues& array : content.point_data)
    data.point_data.push_back({array.name, array.components, array.values});
  for (const VtuValues& array : content.cell_data)
    data.cell_data.push_back({array.name, array.components, array.values});
  std::filesystem::path partial = path;
  partial += partial_ending;
  try {
    OutputFile file(partial, OutputFile::Mode::truncate, path);
    write_vtu(file.stream(), data);
    file.close();
    std::error_code error;
    std::filesystem::rename(partial, path, error);
    if (error) throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(error.value()));
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw;
  }
}

}  // namespace resilin
