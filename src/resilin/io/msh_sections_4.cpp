#include <array>

#include "resilin/core/error.hpp"
#include "resilin/io/msh_input.hpp"

namespace resilin {
namespace {

/// Start of a block of nodes or elements. Version 4.0 names the entity before its dimension.
struct BlockHeader {
  std::int64_t dimension;
  std::int64_t entity;
  std::int64_t third;  ///< parametric flag of nodes, type of elements
};

BlockHeader read_block_header(MshInput& in) {
  const std::int64_t first = in.integer("the dimension of a block's entity");
  const std::int64_t second = in.integer("the tag of a block's entity");
  const std::int64_t third = in.integer("the third number of a block");
  const BlockHeader header =
      in.version < 4.1 ? BlockHeader{second, first, third} : BlockHeader{first, second, third};
  if (header.dimension < 0 || header.dimension > 3) {
    in.text.fail("the dimension of a block's entity (0 to 3)", std::to_string(header.dimension));
  }
  return header;
}

void skip_parameters(MshInput& in, const BlockHeader& header) {
  if (header.third == 0) return;
  for (std::int64_t i = 0; i < header.dimension; ++i) in.real("a parametric coordinate");
}

void read_nodes_of_block(MshReading& file, const BlockHeader& header, std::size_t count) {
  MshInput& in = file.in;
  const auto coordinate_of = [](std::int64_t number) {
    return "a coordinate of node " + std::to_string(number);
  };
  if (in.version < 4.1) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t number = in.integer("a node tag");
      file.mesh.add_vertex(number, in.point(coordinate_of(number)));
      skip_parameters(in, header);
    }
    return;
  }
  std::vector<std::int64_t> numbers(count);
  for (std::int64_t& number : numbers) number = in.size("a node tag");
  for (const std::int64_t number : numbers) {
    file.mesh.add_vertex(number, in.point(coordinate_of(number)));
    skip_parameters(in, header);
  }
}

void read_elements_of_block(MshReading& file, const BlockHeader& header, std::size_t count) {
  MshInput& in = file.in;
  const bool is_41 = in.version >= 4.1;
  std::vector<std::size_t> groups;
  for (const std::int64_t tag : file.physicals[{static_cast<int>(header.dimension), header.entity}]) {
    if (const auto group = file.group(static_cast<int>(header.dimension), tag)) groups.push_back(*group);
  }
  std::array<Index, max_cell_nodes> nodes{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t element = is_41 ? in.size("an element tag") : in.integer("an element tag");
    const CellKind kind = msh_cell_kind(file.mesh, header.third, element);
    const auto size = static_cast<std::size_t>(num_nodes(kind));
    const std::string what = "a node id of element " + std::to_string(element);
    for (std::size_t n = 0; n < size; ++n) {
      nodes[n] = file.mesh.vertex(is_41 ? in.size(what) : in.integer(what), element, kind, n);
    }
    const auto cell = file.mesh.add_cell(kind, element, std::span(nodes).first(size));
    for (const std::size_t group : groups) file.mesh.add_to_group(group, cell);
  }
}

/// Refuses blocks that together hold another number of things than the section's header says.
void require_total(const MshInput& in, std::string_view what, std::size_t promised, std::size_t found) {
  if (promised != found) {
    in.text.fail(std::to_string(promised) + " " + std::string(what) + " as the section says",
                 std::to_string(found));
  }
}

}  // namespace

void read_msh4_entities(MshReading& file) {
  MshInput& in = file.in;
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) count = in.count("entities", 8, 36);
  for (int dim = 0; dim < 4; ++dim) {
    const int num_coordinates = dim == 0 && in.version >= 4.1 ? 3 : 6;
    for (std::size_t e = 0; e < counts[static_cast<std::size_t>(dim)]; ++e) {
      const std::int64_t entity = in.integer("an entity tag");
      for (int i = 0; i < num_coordinates; ++i) in.real("a bound of an entity");
      const std::size_t num_physicals = in.count("physical tags", 2, 4);
      auto& tags = file.physicals[{dim, entity}];
      for (std::size_t i = 0; i < num_physicals; ++i) tags.push_back(in.integer("a physical tag"));
      const std::size_t num_bounding = dim == 0 ? 0 : in.count("bounding entities", 2, 4);
      for (std::size_t i = 0; i < num_bounding; ++i) in.integer("a bounding entity");
    }
  }
}

void read_msh4_nodes(MshReading& file) {
  MshInput& in = file.in;
  const std::size_t num_blocks = in.count("blocks of nodes", 8, 20);
  const std::size_t promised = in.count("nodes", 8, 28);
  if (in.version >= 4.1) {
    in.size("the smallest node tag");
    in.size("the largest node tag");
  }
  std::size_t found = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const BlockHeader header = read_block_header(in);
    const std::size_t count = in.count("nodes", 8, 28);
    found += count;
    read_nodes_of_block(file, header, count);
  }
  require_total(in, "nodes", promised, found);
  file.mesh.finish_vertices();
}

void read_msh4_elements(MshReading& file) {
  MshInput& in = file.in;
  const std::size_t num_blocks = in.count("blocks of elements", 8, 20);
  const std::size_t promised = in.count("elements", 4, 8);
  if (in.version >= 4.1) {
    in.size("the smallest element tag");
    in.size("the largest element tag");
  }
  std::size_t found = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const BlockHeader header = read_block_header(in);
    const std::size_t count = in.count("elements", 4, 8);
    found += count;
    read_elements_of_block(file, header, count);
  }
  require_total(in, "elements", promised, found);
}

}  // namespace resilin
