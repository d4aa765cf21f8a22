#include <array>

#include "resilin/io/msh_input.hpp"

namespace resilin {
namespace {

/// "tags... nodes..." of one element; the first tag is the physical group.
void read_element(MshReading& file, std::int64_t type, std::int64_t element, std::size_t num_tags) {
  MshInput& in = file.in;
  const CellKind kind = msh_cell_kind(file.mesh, type, element);
  std::int64_t physical_tag = 0;
  for (std::size_t t = 0; t < num_tags; ++t) {
    const std::int64_t tag = in.integer("a tag of element " + std::to_string(element));
    if (t == 0) physical_tag = tag;
  }
  std::array<Index, max_cell_nodes> nodes{};
  const auto size = static_cast<std::size_t>(num_nodes(kind));
  const std::string what = "a node id of element " + std::to_string(element);
  for (std::size_t n = 0; n < size; ++n) nodes[n] = file.mesh.vertex(in.integer(what), element, kind, n);
  const auto cell = file.mesh.add_cell(kind, element, std::span(nodes).first(size));
  if (const auto group = file.group(dimension(kind), physical_tag)) file.mesh.add_to_group(*group, cell);
}

}  // namespace

void read_msh2_nodes(MshReading& file) {
  MshInput& in = file.in;
  const std::size_t count = in.text.count("nodes", in.is_binary ? 28 : 8);
  in.text.skip_line_end();
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t number = in.integer("a node number");
    file.mesh.add_vertex(number, in.point("a coordinate of node " + std::to_string(number)));
  }
  file.mesh.finish_vertices();
}

/// As $Nodes, and behind each place the dimension and the number of its entity and its parameters there.
void read_msh2_parametric_nodes(MshReading& file) {
  MshInput& in = file.in;
  const std::size_t count = in.text.count("nodes", in.is_binary ? 36 : 12);
  in.text.skip_line_end();
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t number = in.integer("a node number");
    file.mesh.add_vertex(number, in.point("a coordinate of node " + std::to_string(number)));
    const std::int64_t dim = in.integer("the dimension of an entity");
    in.integer("the number of an entity");
    if (dim < 0 || dim > 3) in.text.fail("the dimension of an entity (0 to 3)", std::to_string(dim));
    for (std::int64_t p = 0; p < (dim < 3 ? dim : 0); ++p)
      in.real("a parameter of node " + std::to_string(number));
  }
  file.mesh.finish_vertices();
}

/// "number type physical elementary size nodes..." of each element of version 1.
void read_msh1_elements(MshReading& file) {
  TextScanner& text = file.in.text;
  const std::size_t count = text.count("elements", 12);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t element = text.integer("an element number");
    const std::string of_element = " of element " + std::to_string(element);
    const CellKind kind = msh_cell_kind(file.mesh, text.integer("the type" + of_element), element);
    const std::int64_t physical = text.integer("the physical group" + of_element);
    text.integer("the elementary entity" + of_element);
    const std::int64_t size = text.integer("the number of nodes" + of_element);
    if (size != num_nodes(kind))
      text.fail(std::to_string(num_nodes(kind)) + " nodes" + of_element, std::to_string(size));
    std::array<Index, max_cell_nodes> nodes{};
    const auto used = std::span(nodes).first(static_cast<std::size_t>(size));
    for (std::size_t n = 0; n < used.size(); ++n)
      used[n] = file.mesh.vertex(text.integer("a node id" + of_element), element, kind, n);
    const auto cell = file.mesh.add_cell(kind, element, used);
    if (const auto group = file.group(dimension(kind), physical)) file.mesh.add_to_group(*group, cell);
  }
}

void read_msh2_elements(MshReading& file) {
  MshInput& in = file.in;
  const std::size_t count = in.text.count("elements", in.is_binary ? 8 : 6);
  in.text.skip_line_end();
  std::size_t num_read = 0;
  while (num_read < count) {
    if (in.is_binary) {  // blocks of elements of one type
      const std::int64_t type = in.integer("an element type");
      const std::int64_t num_following = in.integer("the number of elements of one type");
      const std::size_t in_block = in.text.checked_count(num_following, "elements of one type", 8);
      const std::size_t num_tags = in.text.checked_count(in.integer("the number of tags"), "tags", 4);
      if (in_block == 0 || in_block > count - num_read) {
        in.text.fail("1 to " + std::to_string(count - num_read) + " elements in the block",
                     std::to_string(num_following));
      }
      for (std::size_t i = 0; i < in_block; ++i) {
        const std::int64_t element = in.integer("an element number");
        read_element(file, type, element, num_tags);
      }
      num_read += in_block;
    } else {
      const std::int64_t element = in.integer("an element number");
      const std::int64_t type = in.integer("the type of element " + std::to_string(element));
      const std::size_t num_tags = in.text.count("tags", 2);
      read_element(file, type, element, num_tags);
      ++num_read;
    }
  }
}

}  // namespace resilin
