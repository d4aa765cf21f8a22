#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/energy/dead_load.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Region of a load, and further input of its energy.
struct LoadSite {
  int dimension;
  const VectorX& rest_positions;  ///< reference positions of the nodes of the cells [m]
  const Body& body;
  const ElementInfo& element;
  std::string name;
  std::string where;            ///< begins messages about the selection
  std::vector<Index> nodes;     ///< selected, in the numbering of the cells
  std::vector<Index> vertices;  ///< the same in the body's mesh
  ActiveTime active;
  double thickness = 1;  ///< thickness of plane scenes: what acts per area or volume has it [m]
  const SelectionPart* part = nullptr;  ///< part of a scene that several processes share; else null
};

/// A kind of [[load]]: what it is called, which keys it has and the term that it adds.
struct LoadKind {
  enum class ValueIsNumber { never, in_2D, always };

  std::string name;
  std::string text;                                      ///< for the reference: "per reference volume"
  std::vector<std::string> needs;                        ///< keys that it must have
  std::vector<std::string> has;                          ///< keys that it may have besides
  ValueIsNumber value_is_number = ValueIsNumber::never;  ///< else `value` is a vector
  std::shared_ptr<Energy> (*make)(const LoadDescription& load, const LoadSite& site);
  bool is_on_each_node = false;  ///< acts on nodes, not on cells or their sides

  bool has_number(int dim) const {
    return value_is_number == ValueIsNumber::always || (value_is_number == ValueIsNumber::in_2D && dim == 2);
  }
};

/// Every kind of load. The scene reader, the reference and the property tests walk this list.
const std::vector<LoadKind>& load_kinds();

/// The kind of this name; throws InputError at `place` that lists them when there is none.
const LoadKind& require_load_kind(const std::string& name, const std::string& place);

}  // namespace resilin
