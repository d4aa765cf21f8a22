#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/io/mesh_builder.hpp"

namespace resilin {

/// Largest number of a node or an element in a file of lines with numbers.
inline constexpr std::int64_t max_file_number = 2'147'483'647;

/// An entry of a set: numbers from `first` to `last`, or all of another set.
struct InpEntry {
  std::int64_t first = 0, last = 0, step = 1;
  std::string set = {};         ///< lower case; empty for numbers
  std::string instance = {};    ///< lower case; empty: the scope itself
  int side = 0;                 ///< 1, 2, ... of the cells, 0: the cells themselves
  bool names_elements = false;  ///< in a set of nodes: the nodes of a set of elements
};

/// A set of nodes or of elements, or a surface, resolved when all is read.
struct InpSet {
  std::string name;
  std::string place;         ///< "FILE: line N" of its first line
  bool is_internal = false;  ///< made by a program for its own use: no group
  bool has_nodes = false;    ///< a surface of nodes
  std::vector<InpEntry> entries = {};
};

/// Sets by their names, in which small and capital letters are the same.
class InpSets {
 public:
  InpSet& named(const std::string& name, const std::string& place);  ///< made when there is none
  std::optional<std::size_t> find(const std::string& lower_case_name) const;
  const std::vector<InpSet>& all() const { return sets_; }
  std::vector<std::string> names() const;

 private:
  std::vector<InpSet> sets_;
  std::map<std::string, std::size_t, std::less<>> numbers_;
};

/// One element of an Abaqus input file.
struct InpElement {
  std::int64_t number;
  CellKind kind;
  std::size_t first_node;  ///< in `InpPart::element_nodes`
  std::size_t num_nodes;
};

/// Nodes and elements that are numbered together, and what is named among them.
struct InpPart {
  std::string name;
  std::vector<std::int64_t> node_numbers = {};
  std::vector<Vector3> positions = {};
  std::vector<InpElement> elements = {};
  std::vector<std::int64_t> element_nodes = {};
  InpSets node_sets = {}, element_sets = {}, surfaces = {};
  bool has_other_elements = false;  ///< such as springs, which are passed over
};

/// A part in its place: X -> rotation X + translation.
struct InpInstance {
  std::string name;
  std::size_t part;
  Matrix<3> rotation = Matrix<3>::Identity();
  Vector3 translation = Vector3::Zero();
};

/// An input file of Abaqus or CalculiX. Part 0 is what stands outside parts.
struct InpModel {
  std::vector<InpPart> parts;
  std::vector<InpInstance> instances;              ///< the first is part 0
  std::map<std::string, std::size_t> passed_over;  ///< types of elements and how often they are given
};

/// Kind and nodes of the cells of one element type.
struct InpType {
  CellKind kind;
  std::size_t num_nodes;
};

/// The cells of a type such as "C3D10MH" (upper case); empty for springs, masses, beams with three nodes, ...
std::optional<InpType> inp_type(std::string_view type);

/// Corners of side `side` (from 1) of a cell, as Abaqus counts sides; empty where there is none.
std::span<const int> inp_side(CellKind kind, int side);

/// Puts all instances into one mesh.
void build_inp_mesh(const InpModel& model, MeshBuilder& mesh);

}  // namespace resilin
