#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "resilin/scene/node.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {

/// Parameter of a sweep: one or more keys of the scene that take the same value, out of a list or of an
/// interval.
struct SweepParameter {
  enum class Kind { list, spaced, interval };

  std::vector<std::string> keys;  ///< as after --set
  std::string name;               ///< name of its column in the table
  std::string place;              ///< place of messages
  SceneValue origin;              ///< where it stands: an empty table with its source and line
  Kind kind = Kind::list;
  std::vector<SceneValue> values;  ///< list
  double from = 0, to = 0;         ///< spaced, interval
  std::uint64_t count = 0;         ///< spaced: how many values from `from` to `to`, both included
  bool is_logarithmic = false;     ///< spaced and intervals: evenly in the logarithm
  bool is_whole = false;           ///< spaced: whole numbers

  /// Number of values; 0 of an interval, which has no end of them.
  std::uint64_t size() const { return kind == Kind::list ? values.size() : count; }
  SceneValue value(std::uint64_t i) const;  ///< one of `size()`
  SceneValue at(double x) const;            ///< for x in [0, 1): of all values, or of the interval
};

/// Reads one parameter's values: a list, or a table with one of linspace, logspace, range, uniform,
/// log_uniform. @throws InputError
void read_parameter_values(const SceneNode& node, SweepParameter& parameter);

/// Whether a value says which values a parameter takes; a table of tables leads on to longer keys.
bool is_parameter_values(const SceneValue& value);

/// The parameters of a sweep: a table [parameters] by keys, nested as TOML has them, in the order of the
/// file.
void read_parameters(const SceneNode& node, std::vector<SweepParameter>& parameters);

/// An entry of [[parameter]].
SweepParameter read_parameter(const SceneNode& node);

/// All that the values of a parameter follow from, as text, for comparison.
std::string describe_values(const SweepParameter& parameter);

}  // namespace resilin
