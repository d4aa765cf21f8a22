#include <algorithm>
#include <array>
#include <compare>
#include <set>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/inp_model.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/io/vtu.hpp"

namespace resilin {
namespace {

constexpr int own_instance = -1;
constexpr std::size_t most_nodes_of_element = 27;

/// One node or element of an instance, or one of the sides of an element.
struct InpItem {
  int instance;  ///< own_instance: the one of the part in which the set is
  Index local;   ///< in its part
  int side = 0;

  auto operator<=>(const InpItem&) const = default;
};
using InpItems = std::vector<InpItem>;

/// The sets of a part, resolved.
struct InpContent {
  NumberIndex nodes, elements;
  std::vector<InpItems> node_sets = {}, element_sets = {}, surfaces = {};
};

/// Turns what is named into nodes and elements.
class InpResolver {
 public:
  InpResolver(const InpModel& model, MeshBuilder& mesh) : model_(&model), mesh_(&mesh) {}

  std::vector<InpContent> contents() {
    contents_.resize(model_->parts.size());
    for (std::size_t p = 0; p < contents_.size(); ++p) index(p);
    for (std::size_t i = 1; i < model_->instances.size(); ++i)
      instances_.emplace(lower_case(model_->instances[i].name), i);
    for (std::size_t p = contents_.size(); p-- > 0;) resolve(p);  // the assembly names those of parts
    if (num_unknown_ > 0)
      mesh_->warn(std::to_string(num_unknown_) + " ids in sets, such as " + example_ +
                  ", belong to no node or element");
    return std::move(contents_);
  }

 private:
  void index(std::size_t p) {
    const InpPart& part = model_->parts[p];
    for (const std::int64_t number : part.node_numbers) contents_[p].nodes.add(number);
    for (const InpElement& element : part.elements) contents_[p].elements.add(element.number);
    contents_[p].nodes.sort();
    contents_[p].elements.sort();
  }

  void resolve(std::size_t p) {
    const InpPart& part = model_->parts[p];
    InpContent& content = contents_[p];
    for (const InpSet& set : part.element_sets.all())
      content.element_sets.push_back(items(set, p, /*is_of_nodes=*/false));
    for (const InpSet& set : part.node_sets.all())
      content.node_sets.push_back(items(set, p, /*is_of_nodes=*/true));
    for (const InpSet& set : part.surfaces.all()) content.surfaces.push_back(items(set, p, set.has_nodes));
  }

  InpItems items(const InpSet& set, std::size_t p, bool is_of_nodes) {
    InpItems result;
    std::set<std::pair<std::string, std::string>> names;  // names in it already
    for (const InpEntry& entry : set.entries) {
      if (entry.set.empty())
        add_numbers(result, entry, set, p, is_of_nodes);
      else if (names.emplace(entry.instance, entry.set + '/' + std::to_string(entry.side)).second)
        add_set(result, entry, set, p, is_of_nodes);
    }
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  struct Scope {
    std::size_t part;
    int instance;
  };
  Scope scope_of(const InpEntry& entry, const InpSet& set, std::size_t p) const {
    if (entry.instance.empty()) return {p, p == 0 ? 0 : own_instance};
    const auto found = instances_.find(entry.instance);
    if (found == instances_.end())
      throw InputError(set.place, "the name of an *INSTANCE in \"" + printable(set.name) + "\"",
                       printable(entry.instance));
    return {model_->instances[found->second].part, static_cast<int>(found->second)};
  }

  void add_numbers(InpItems& result, const InpEntry& entry, const InpSet& set, std::size_t p,
                   bool is_of_nodes) {
    const Scope scope = scope_of(entry, set, p);
    const InpContent& content = contents_[scope.part];
    const NumberIndex& index = is_of_nodes ? content.nodes : content.elements;
    const auto size = static_cast<std::int64_t>(index.numbers().size());
    if ((entry.last - entry.first) / entry.step > size) {
      for (std::int64_t i = 0; i < size; ++i) {
        const std::int64_t number = index.numbers()[static_cast<std::size_t>(i)];
        if (number >= entry.first && number <= entry.last && (number - entry.first) % entry.step == 0)
          result.push_back({scope.instance, static_cast<Index>(i), entry.side});
      }
      return;
    }
    for (std::int64_t number = entry.first; number <= entry.last; number += entry.step) {
      const Index found = index.find(number);
      if (found >= 0)
        result.push_back({scope.instance, found, entry.side});
      else if (is_of_nodes || !model_->parts[scope.part].has_other_elements)
        note_unknown(number, set);
    }
  }

  void note_unknown(std::int64_t number, const InpSet& set) {
    if (num_unknown_++ == 0) example_ = std::to_string(number) + " in \"" + printable(set.name) + "\"";
  }

  void add_set(InpItems& result, const InpEntry& entry, const InpSet& set, std::size_t p, bool is_of_nodes) {
    const Scope scope = scope_of(entry, set, p);
    const InpPart& part = model_->parts[scope.part];
    const bool takes_nodes = is_of_nodes && !entry.names_elements;
    const InpSets& sets = takes_nodes ? part.node_sets : part.element_sets;
    const std::vector<InpItems>& known =
        takes_nodes ? contents_[scope.part].node_sets : contents_[scope.part].element_sets;
    const auto found = sets.find(entry.set);
    if (!found || *found >= known.size()) {
      if (found && &sets.all()[*found] == &set) return;  // itself
      throw InputError(set.place, "names of sets that are given before \"" + printable(set.name) + "\"",
                       printable(entry.set), did_you_mean(entry.set, sets.names()));
    }
    for (const InpItem& item : known[*found]) {
      const int instance = item.instance == own_instance ? scope.instance : item.instance;
      if (entry.names_elements)
        add_nodes_of(result, scope.part, instance, item.local);
      else
        result.push_back({instance, item.local, entry.side});
    }
  }

  void add_nodes_of(InpItems& result, std::size_t p, int instance, Index element) {
    const std::size_t part = instance > 0 ? model_->instances[static_cast<std::size_t>(instance)].part : p;
    const InpElement& found = model_->parts[part].elements[static_cast<std::size_t>(element)];
    for (std::size_t n = 0; n < found.num_nodes; ++n) {
      const Index node = contents_[part].nodes.find(model_->parts[part].element_nodes[found.first_node + n]);
      if (node >= 0) result.push_back({instance, node});
    }
  }

  const InpModel* model_;
  MeshBuilder* mesh_;
  std::vector<InpContent> contents_;
  std::map<std::string, std::size_t> instances_;
  std::size_t num_unknown_ = 0;
  std::string example_;
};

/// Puts instances side by side. Where there are several, numbers of the second begin at a power of ten.
class InpAssembler {
 public:
  InpAssembler(const InpModel& model, MeshBuilder& mesh) : model_(&model), mesh_(&mesh) {}

  void build() {
    foresee();
    find_offsets();
    for (std::size_t i = 0; i < model_->instances.size(); ++i) add_vertices(i);
    mesh_->finish_vertices();
    for (std::size_t i = 0; i < model_->instances.size(); ++i) add_cells(i);
    contents_ = InpResolver(*model_, *mesh_).contents();
    find_names();
    for (std::size_t i = 0; i < model_->instances.size(); ++i) add_groups(i);
  }

 private:
  const InpPart& part_of(std::size_t instance) const {
    return model_->parts[model_->instances[instance].part];
  }

  /// Instances of instances are not there, but a part may be placed many times.
  void foresee() const {
    double bytes = 0;
    for (std::size_t i = 0; i < model_->instances.size(); ++i)
      bytes += 100.0 * static_cast<double>(part_of(i).positions.size() + part_of(i).elements.size());
    if (!fits(bytes))
      foresee_memory(bytes, "placing the instances of parts", "take fewer of them, or raise the limit");
  }

  void find_offsets() {
    std::int64_t largest = 0;
    std::size_t num_used = 0;
    for (std::size_t i = 0; i < model_->instances.size(); ++i) {
      for (const std::int64_t number : part_of(i).node_numbers) largest = std::max(largest, number);
      for (const InpElement& element : part_of(i).elements) largest = std::max(largest, element.number);
    }
    std::int64_t stride = 10;
    while (stride <= largest) stride *= 10;
    for (std::size_t i = 0; i < model_->instances.size(); ++i) {
      offsets_.push_back(stride * static_cast<std::int64_t>(num_used));
      if (!part_of(i).positions.empty()) ++num_used;
    }
    has_several_ = num_used > 1;
  }

  void add_vertices(std::size_t instance) {
    const InpPart& part = part_of(instance);
    const InpInstance& placed = model_->instances[instance];
    first_vertex_.push_back(mesh_->num_vertices());
    for (std::size_t n = 0; n < part.positions.size(); ++n) {
      const Vector3 position = placed.rotation * part.positions[n] + placed.translation;
      if (!position.allFinite())
        throw InputError(mesh_->cell_place(part.node_numbers[n]), "a place that is finite", "infinity");
      mesh_->add_vertex(offsets_[instance] + part.node_numbers[n], position);
    }
  }

  /// Numbers of the nodes of an element in the whole.
  std::span<const std::int64_t> numbers_of(std::size_t instance, const InpElement& element) {
    const InpPart& part = part_of(instance);
    for (std::size_t n = 0; n < element.num_nodes; ++n)
      numbers_[n] = offsets_[instance] + part.element_nodes[element.first_node + n];
    return std::span(numbers_).first(element.num_nodes);
  }

  void add_cells(std::size_t instance) {
    cells_.emplace_back();
    for (const InpElement& element : part_of(instance).elements)
      cells_.back().push_back(mesh_->add_cell_of_numbers(element.kind, offsets_[instance] + element.number,
                                                         numbers_of(instance, element)));
  }

  /// A side as a cell of its own; the cell itself for side 0.
  std::optional<MeshBuilder::Cell> cell_of(const InpItem& item) {
    const auto instance = static_cast<std::size_t>(item.instance);
    const auto local = static_cast<std::size_t>(item.local);
    if (item.side == 0) return cells_[instance][local];
    const auto known = sides_.find(item);
    if (known != sides_.end()) return known->second;
    const InpElement& element = part_of(instance).elements[local];
    const std::span<const int> corners = inp_side(element.kind, item.side);
    if (corners.empty()) return cells_[instance][local];
    const auto cell = add_side(instance, element, corners);
    if (cell) sides_.emplace(item, *cell);
    return cell;
  }

  std::optional<MeshBuilder::Cell> add_side(std::size_t instance, const InpElement& element,
                                            std::span<const int> corners) {
    const std::int64_t number = offsets_[instance] + element.number;
    std::array<Index, most_nodes_of_element> nodes{};
    const auto size = static_cast<std::size_t>(num_nodes(element.kind));
    const std::span<const std::int64_t> numbers = numbers_of(instance, element);
    for (std::size_t n = 0; n < size; ++n) nodes[n] = mesh_->vertex(numbers[n], number);
    exchange_vtk_nodes(element.kind, std::span(nodes).first(size));
    std::vector<int> positions(corners.begin(), corners.end());
    CellKind kind = corners.size() == 2   ? CellKind::line
                    : corners.size() == 3 ? CellKind::triangle
                                          : CellKind::quadrilateral;
    if (is_second_order(element.kind)) {
      for (const CellSide& side : cell_sides(element.kind)) {
        if (!std::ranges::is_permutation(side.corners(), corners)) continue;
        kind = side.kind;
        positions.assign(side.all().begin(), side.all().end());
      }
    }
    std::vector<Index> vertices;
    for (const int position : positions) vertices.push_back(nodes[static_cast<std::size_t>(position)]);
    const std::set<Index> distinct(vertices.begin(), vertices.end());
    if (distinct.size() < std::min<std::size_t>(3, vertices.size())) return std::nullopt;  // a collapsed cell
    return mesh_->add_cell(kind, number, vertices);
  }

  /// A set that only one instance has is a group of its name, another of "INSTANCE.NAME".
  void find_names() {
    for (std::size_t i = 0; i < model_->instances.size(); ++i)
      for (const InpSets* sets : {&part_of(i).node_sets, &part_of(i).element_sets, &part_of(i).surfaces})
        for (const InpSet& set : sets->all()) scopes_[lower_case(set.name)].insert(i);
  }

  std::string group_name(std::size_t instance, const InpSet& set) const {
    const bool is_plain = instance == 0 || scopes_.at(lower_case(set.name)).size() == 1;
    return is_plain ? set.name : model_->instances[instance].name + "." + set.name;
  }

  void add_groups(std::size_t instance) {
    const InpPart& part = part_of(instance);
    const InpContent& content = contents_[model_->instances[instance].part];
    if (has_several_ && instance > 0) {
      for (const MeshBuilder::Cell& cell : cells_[instance])
        mesh_->add_to_group(mesh_->group(model_->instances[instance].name), cell);
    }
    add_sets(instance, part.node_sets, content.node_sets, /*has_nodes=*/true);
    add_sets(instance, part.element_sets, content.element_sets, /*has_nodes=*/false);
    add_sets(instance, part.surfaces, content.surfaces, /*has_nodes=*/false);
  }

  void add_sets(std::size_t instance, const InpSets& sets, const std::vector<InpItems>& items,
                bool has_nodes) {
    for (std::size_t s = 0; s < items.size(); ++s) {
      const InpSet& set = sets.all()[s];
      if (set.is_internal || items[s].empty()) continue;
      const std::size_t group = mesh_->group(group_name(instance, set));
      for (InpItem item : items[s]) {
        if (item.instance == own_instance) item.instance = static_cast<int>(instance);
        if (has_nodes || set.has_nodes)
          mesh_->add_vertex_to_group(group,
                                     first_vertex_[static_cast<std::size_t>(item.instance)] + item.local);
        else if (const auto cell = cell_of(item))
          mesh_->add_to_group(group, *cell);
      }
    }
  }

  const InpModel* model_;
  MeshBuilder* mesh_;
  std::vector<InpContent> contents_;
  std::vector<std::int64_t> offsets_;                  ///< offsets of the numbers of each instance
  std::vector<Index> first_vertex_;                    ///< first vertex of each instance
  std::vector<std::vector<MeshBuilder::Cell>> cells_;  ///< cells of each instance
  std::map<InpItem, MeshBuilder::Cell> sides_;
  std::map<std::string, std::set<std::size_t>> scopes_;  ///< instances that have a set of a name
  std::array<std::int64_t, most_nodes_of_element> numbers_{};
  bool has_several_ = false;
};

}  // namespace

InpSet& InpSets::named(const std::string& name, const std::string& place) {
  const auto [found, is_new] = numbers_.try_emplace(lower_case(name), sets_.size());
  if (is_new) sets_.push_back({.name = name, .place = place});
  return sets_[found->second];
}

std::optional<std::size_t> InpSets::find(const std::string& lower_case_name) const {
  const auto found = numbers_.find(lower_case_name);
  return found == numbers_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> InpSets::names() const {
  std::vector<std::string> result;
  for (const InpSet& set : sets_) result.push_back(set.name);
  return result;
}

void build_inp_mesh(const InpModel& model, MeshBuilder& mesh) { InpAssembler(model, mesh).build(); }

}  // namespace resilin
