#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <ostream>

#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/msh_input.hpp"

// Writes MSH 4.1 ASCII. Cells of one kind that belong to the same groups form one entity, since in MSH a cell
// belongs to groups through its entity.

namespace resilin {
namespace {

/// Cells of one block that belong to the same groups.
struct Entity {
  int dimension;
  int tag;  ///< counts from 1 in each dimension
  CellKind kind;
  std::vector<std::size_t> groups;
  std::vector<Index> nodes;  ///< nodes of all its cells, one after another
  std::vector<Index> cells;  ///< their numbers in the block; empty for points made for a group's vertices
  std::size_t block;
};

/// groups_of[cell] = numbers of the groups that have it.
std::vector<std::vector<std::size_t>> groups_of_cells(const Mesh& mesh, std::size_t block) {
  std::vector<std::vector<std::size_t>> result(static_cast<std::size_t>(mesh.blocks[block].num_cells()));
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    if (block >= mesh.groups[g].cells.size()) continue;
    for (const Index cell : mesh.groups[g].cells[block]) result[static_cast<std::size_t>(cell)].push_back(g);
  }
  return result;
}

/// Vertices of a group that none of its cells has.
std::vector<Index> lone_vertices(const Mesh& mesh, const Group& group) {
  std::vector<bool> is_covered(mesh.vertices.size(), false);
  for (std::size_t b = 0; b < group.cells.size(); ++b) {
    for (const Index cell : group.cells[b]) {
      for (const Index node : mesh.blocks[b].cell(cell)) is_covered[static_cast<std::size_t>(node)] = true;
    }
  }
  std::vector<Index> result;
  for (const Index v : group.vertices) {
    if (!is_covered[static_cast<std::size_t>(v)]) result.push_back(v);
  }
  return result;
}

std::vector<Entity> make_entities(const Mesh& mesh) {
  std::vector<Entity> entities;
  std::array<int, 4> num_entities{};
  const auto make = [&](CellKind kind, std::vector<std::size_t> groups, std::size_t block) -> Entity& {
    const int dim = dimension(kind);
    return entities.emplace_back(
        Entity{dim, ++num_entities[static_cast<std::size_t>(dim)], kind, std::move(groups), {}, {}, block});
  };
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellBlock& block = mesh.blocks[b];
    const auto groups = groups_of_cells(mesh, b);
    std::map<std::vector<std::size_t>, std::size_t> entity_of_groups;
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      const auto& key = groups[static_cast<std::size_t>(cell)];
      const auto [found, is_new] = entity_of_groups.try_emplace(key, entities.size());
      if (is_new) make(block.kind, key, b);
      Entity& entity = entities[found->second];
      const auto nodes = block.cell(cell);
      entity.nodes.insert(entity.nodes.end(), nodes.begin(), nodes.end());
      entity.cells.push_back(cell);
    }
  }
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    const std::vector<Index> vertices = lone_vertices(mesh, mesh.groups[g]);
    for (const Index v : vertices) make(CellKind::point, {g}, mesh.blocks.size()).nodes = {v};
  }
  std::stable_sort(entities.begin(), entities.end(),
                   [](const Entity& a, const Entity& b) { return a.dimension < b.dimension; });
  return entities;
}

std::string coordinates(const Vector3& X) {
  return format_number(X.x()) + ' ' + format_number(X.y()) + ' ' + format_number(X.z());
}

/// A name as MSH can hold it: without quotation marks and line ends.
std::string quoted(std::string name) {
  std::replace_if(name.begin(), name.end(), [](char c) { return c == '"' || c == '\n' || c == '\r'; }, '_');
  return '"' + name + '"';
}

void write_physical_names(std::ostream& stream, const Mesh& mesh, const std::vector<Entity>& entities) {
  std::map<std::pair<int, std::size_t>, bool> is_present;
  for (const Entity& entity : entities) {
    for (const std::size_t g : entity.groups) is_present[{entity.dimension, g}] = true;
  }
  if (is_present.empty()) return;
  stream << "$PhysicalNames\n" << is_present.size() << '\n';
  for (const auto& [key, unused] : is_present) {
    stream << key.first << ' ' << key.second + 1 << ' ' << quoted(mesh.groups[key.second].name) << '\n';
  }
  stream << "$EndPhysicalNames\n";
}

void write_entities(std::ostream& stream, const Mesh& mesh, const std::vector<Entity>& entities) {
  std::array<int, 4> counts{};
  for (const Entity& entity : entities) ++counts[static_cast<std::size_t>(entity.dimension)];
  stream << "$Entities\n" << counts[0] << ' ' << counts[1] << ' ' << counts[2] << ' ' << counts[3] << '\n';
  for (const Entity& entity : entities) {
    Vector3 low = mesh.vertices[static_cast<std::size_t>(entity.nodes[0])];
    Vector3 high = low;
    for (const Index node : entity.nodes) {
      low = low.cwiseMin(mesh.vertices[static_cast<std::size_t>(node)]).eval();
      high = high.cwiseMax(mesh.vertices[static_cast<std::size_t>(node)]).eval();
    }
    stream << entity.tag << ' ' << coordinates(low);
    if (entity.dimension > 0) stream << ' ' << coordinates(high);
    stream << ' ' << entity.groups.size();
    for (const std::size_t g : entity.groups) stream << ' ' << g + 1;
    stream << (entity.dimension > 0 ? " 0\n" : "\n");
  }
  stream << "$EndEntities\n";
}

void write_nodes(std::ostream& stream, const Mesh& mesh, const std::vector<Entity>& entities) {
  const std::size_t count = mesh.vertices.size();
  const int dim = entities.empty() ? 3 : entities.back().dimension;
  const int tag = entities.empty() ? 1 : entities.back().tag;
  stream << "$Nodes\n1 " << count << " 1 " << count << '\n' << dim << ' ' << tag << " 0 " << count << '\n';
  for (std::size_t v = 1; v <= count; ++v) stream << v << '\n';
  for (const Vector3& X : mesh.vertices) stream << coordinates(X) << '\n';
  stream << "$EndNodes\n";
}

/// @return number in the file of each cell of each block
std::vector<std::vector<std::size_t>> write_elements(std::ostream& stream, const Mesh& mesh,
                                                     const std::vector<Entity>& entities) {
  std::vector<std::vector<std::size_t>> numbers;
  for (const CellBlock& block : mesh.blocks)
    numbers.emplace_back(static_cast<std::size_t>(block.num_cells()));
  std::size_t total = 0;
  for (const Entity& e : entities) total += e.nodes.size() / static_cast<std::size_t>(num_nodes(e.kind));
  stream << "$Elements\n" << entities.size() << ' ' << total << " 1 " << total << '\n';
  std::size_t number = 0;
  for (const Entity& entity : entities) {
    const auto size = static_cast<std::size_t>(num_nodes(entity.kind));
    const std::size_t num_cells = entity.nodes.size() / size;
    stream << entity.dimension << ' ' << entity.tag << ' ' << msh_element_type(entity.kind) << ' '
           << num_cells << '\n';
    for (std::size_t i = 0; i < num_cells; ++i) {
      stream << ++number;
      for (std::size_t n = 0; n < size; ++n) stream << ' ' << entity.nodes[i * size + n] + 1;
      stream << '\n';
      if (!entity.cells.empty()) numbers[entity.block][static_cast<std::size_t>(entity.cells[i])] = number;
    }
  }
  stream << "$EndElements\n";
  return numbers;
}

void write_field(std::ostream& stream, const CellField& field, const std::vector<std::size_t>& numbers) {
  stream << "$ElementData\n1\n" << quoted(field.name) << "\n1\n0\n3\n0\n1\n" << field.values.size() << '\n';
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    stream << numbers[i] << ' ' << format_number(field.values[i]) << '\n';
  }
  stream << "$EndElementData\n";
}

}  // namespace

void write_msh(std::ostream& stream, const Mesh& mesh) {
  const std::vector<Entity> entities = make_entities(mesh);
  stream << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  write_physical_names(stream, mesh, entities);
  write_entities(stream, mesh, entities);
  write_nodes(stream, mesh, entities);
  const auto numbers = write_elements(stream, mesh, entities);
  for (const CellField& field : mesh.cell_fields) write_field(stream, field, numbers[field.block]);
}

}  // namespace resilin
