#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/line_scanner.hpp"
#include "resilin/io/mesh_builder.hpp"
#include "resilin/io/text_scanner.hpp"

// Universal files (I-DEAS UNV): nodes (datasets 15, 781 and 2411), elements (2412) and groups (2429 to 2477);
// other datasets are passed over. Source: SDRC/UC, "Universal File Datasets".

namespace resilin {
namespace {

struct UnvType {
  std::int64_t descriptor;
  CellKind kind;
  std::size_t num_nodes;
};
constexpr std::array<UnvType, 12> unv_types = {{{41, CellKind::triangle, 3},
                                                {51, CellKind::triangle, 3},
                                                {61, CellKind::triangle, 3},
                                                {81, CellKind::triangle, 3},
                                                {91, CellKind::triangle, 3},
                                                {44, CellKind::quadrilateral, 4},
                                                {54, CellKind::quadrilateral, 4},
                                                {84, CellKind::quadrilateral, 4},
                                                {94, CellKind::quadrilateral, 4},
                                                {111, CellKind::tetrahedron, 4},
                                                {112, CellKind::prism, 6},
                                                {115, CellKind::hexahedron, 8}}};
constexpr std::int64_t parabolic_triangle[] = {42, 52, 62, 82, 92};
constexpr std::int64_t parabolic_tetrahedron = 118;

/// Second-order cells go around: corner, middle, corner, ... Positions of our nodes in theirs.
constexpr std::array<std::size_t, 6> triangle6_order = {0, 2, 4, 1, 3, 5};
constexpr std::array<std::size_t, 10> tetrahedron10_order = {0, 2, 4, 9, 1, 3, 5, 6, 7, 8};

class UnvReader {
 public:
  explicit UnvReader(const MeshSource& source)
      : lines_(source.name, source.bytes), mesh_(source.name, "UNV") {}

  MeshFile read() {
    for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
      if (word != "-1") lines_.fail("-1 before a dataset", word);
      read_dataset();
    }
    mesh_.finish_vertices();
    for (const Element& element : elements_) add(element);
    for (const Group& group : groups_) add(group);
    if (num_passed_over_ > 0)
      mesh_.warn(std::to_string(num_passed_over_) + " elements of other kinds, such as descriptor " +
                 std::to_string(passed_over_) + ", are skipped");
    return mesh_.finish();
  }

 private:
  struct Element {
    std::int64_t number, descriptor;
    std::vector<std::int64_t> nodes;
  };
  struct Group {
    std::string name;
    std::vector<std::int64_t> nodes, elements;
  };

  /// The next line that is not empty, when it is one word; empty at the end.
  std::string_view next_word() {
    while (lines_.next())
      if (!trimmed(lines_.line()).empty()) return trimmed(lines_.line());
    return {};
  }

  /// The words of the next line of a dataset; empty at its end.
  std::vector<std::string_view> next_record() {
    while (lines_.next()) {
      if (trimmed(lines_.line()) == "-1") break;
      if (!trimmed(lines_.line()).empty()) return words_of(lines_.line());
    }
    return {};
  }
  std::vector<std::string_view> record(std::string_view what, std::size_t least) {
    std::vector<std::string_view> words = next_record();
    if (words.size() < least)
      lines_.fail(std::string(what) + " (" + std::to_string(least) + " numbers)", trimmed(lines_.line()),
                  "the file may be cut");
    return words;
  }

  void read_dataset() {
    const std::string_view word = next_word();
    const std::int64_t dataset = lines_.integer(word, "the number of a dataset");
    if (dataset == 2411 || dataset == 781) {
      read_nodes();
    } else if (dataset == 15) {
      read_short_nodes();
    } else if (dataset == 2412 || dataset == 780) {
      read_elements();
    } else if (dataset == 2429 || dataset == 2430 || dataset == 2432 || dataset == 2435 || dataset == 2452 ||
               dataset == 2467 || dataset == 2477) {
      read_groups(dataset == 2429 || dataset == 2430 || dataset == 2432 ? 2 : 4);
    } else {
      while (lines_.next() && trimmed(lines_.line()) != "-1") {
      }
    }
  }

  Vector3 point(std::span<const std::string_view> words, std::int64_t node) const {
    Vector3 position;
    for (std::size_t i = 0; i < 3; ++i)
      position[static_cast<int>(i)] = lines_.real(words[i], "a coordinate of node " + std::to_string(node));
    return position;
  }

  void read_nodes() {
    while (true) {
      const std::vector<std::string_view> head = next_record();
      if (head.empty()) return;
      const std::int64_t node = lines_.integer(head[0], "a node number");
      const std::vector<std::string_view> place = record("coordinates of node " + std::to_string(node), 3);
      mesh_.add_vertex(node, point(place, node));
    }
  }

  void read_short_nodes() {
    while (true) {
      const std::vector<std::string_view> words = next_record();
      if (words.empty()) return;
      const std::int64_t node = lines_.integer(words[0], "a node number");
      if (words.size() < 7)
        lines_.fail("4 numbers and 3 coordinates of node " + std::to_string(node), trimmed(lines_.line()));
      mesh_.add_vertex(node, point(std::span(words).subspan(4), node));
    }
  }

  void read_elements() {
    while (true) {
      const std::vector<std::string_view> head = next_record();
      if (head.empty()) return;
      if (head.size() < 6)
        lines_.fail("6 numbers of an element", trimmed(lines_.line()), "the file may be cut");
      Element element{
          lines_.integer(head[0], "an element number"), lines_.integer(head[1], "a descriptor"), {}};
      const std::int64_t size = lines_.integer(head[5], "a number of nodes");
      if (size < 1 || size > 1000) lines_.fail("a number of nodes from 1 to 1000", head[5]);
      const bool is_beam = element.descriptor == 11 || (element.descriptor >= 21 && element.descriptor <= 24);
      const std::string what = "nodes of element " + std::to_string(element.number);
      if (is_beam) record("the orientation of a beam", 1);
      while (element.nodes.size() < static_cast<std::size_t>(size))
        for (const std::string_view word : record(what, 1))
          element.nodes.push_back(lines_.integer(word, what));
      if (element.nodes.size() != static_cast<std::size_t>(size))
        lines_.fail(std::to_string(size) + " " + what, std::to_string(element.nodes.size()));
      elements_.push_back(std::move(element));
    }
  }

  /// Entries are "type, number" and two more numbers in newer datasets: type 7 for nodes, 8 for elements.
  void read_groups(std::size_t numbers_per_entry) {
    while (true) {
      const std::vector<std::string_view> head = next_record();
      if (head.empty()) return;
      const std::int64_t count = lines_.integer(head.back(), "the number of entries of a group");
      if (count < 0 || static_cast<std::uint64_t>(count) > lines_.remaining())
        lines_.fail("a number of entries that the file has room for", head.back());
      if (!lines_.next()) lines_.fail("the name of a group", "the end of the file", "the file is cut");
      Group group{std::string(trimmed(lines_.line())), {}, {}};
      const std::size_t size = static_cast<std::size_t>(count) * numbers_per_entry;
      std::vector<std::int64_t> numbers;
      while (numbers.size() < size)
        for (const std::string_view word : record("entries of a group", 1))
          numbers.push_back(lines_.integer(word, "a number in a group"));
      for (std::size_t i = 0; i + 1 < numbers.size(); i += numbers_per_entry) {
        if (numbers[i] == 7) group.nodes.push_back(numbers[i + 1]);
        if (numbers[i] == 8) group.elements.push_back(numbers[i + 1]);
      }
      if (!group.name.empty()) groups_.push_back(std::move(group));
    }
  }

  void add(const Element& element) {
    const std::size_t size = element.nodes.size();
    if (std::ranges::find(parabolic_triangle, element.descriptor) != std::end(parabolic_triangle) &&
        size == 6)
      return add_in_order(element, CellKind::triangle6, triangle6_order);
    if (element.descriptor == parabolic_tetrahedron && size == 10)
      return add_in_order(element, CellKind::tetrahedron10, tetrahedron10_order);
    const bool is_line = (element.descriptor == 11 || element.descriptor == 21) && size == 2;
    const auto found = std::ranges::find_if(unv_types, [&](const UnvType& type) {
      return element.descriptor == type.descriptor && size == type.num_nodes;
    });
    if (is_line) {
      mesh_.add_cell_of_numbers(CellKind::line, element.number, element.nodes);
    } else if (found != unv_types.end()) {
      mesh_.add_cell_of_numbers(found->kind, element.number, element.nodes);
    } else {
      ++num_passed_over_;
      passed_over_ = element.descriptor;
    }
  }

  void add_in_order(const Element& element, CellKind kind, std::span<const std::size_t> order) {
    std::vector<std::int64_t> nodes;
    for (const std::size_t position : order) nodes.push_back(element.nodes[position]);
    mesh_.add_cell_of_numbers(kind, element.number, nodes);
  }

  void add(const Group& group) {
    std::size_t num_unknown = 0;
    for (const std::int64_t node : group.nodes) {
      const Index vertex = mesh_.find_vertex(node);
      if (vertex >= 0)
        mesh_.add_vertex_to_group(mesh_.group(group.name), vertex);
      else
        ++num_unknown;
    }
    for (const std::int64_t element : group.elements) {
      MeshBuilder::Cell cell{};
      if (mesh_.find_cell(element, cell))
        mesh_.add_to_group(mesh_.group(group.name), cell);
      else
        ++num_unknown;
    }
    if (num_unknown > num_passed_over_)
      mesh_.warn("group \"" + printable(group.name) + "\" names " + std::to_string(num_unknown) +
                 " nodes or elements that the file does not have");
  }

  LineScanner lines_;
  MeshBuilder mesh_;
  std::vector<Element> elements_;
  std::vector<Group> groups_;
  std::size_t num_passed_over_ = 0;
  std::int64_t passed_over_ = 0;
};

}  // namespace

MeshFile read_unv(const MeshSource& source) { return UnvReader(source).read(); }

}  // namespace resilin
