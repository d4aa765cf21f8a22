#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace resilin {

struct MeshFile;
struct NumberTable;
struct SceneMember;

/// A piece of a scene before its meaning is known: what a TOML file, `--set` or a dictionary hold in common.
/// A program may hand over long arrays and meshes as they are.
struct SceneValue {
  using Array = std::vector<SceneValue>;
  using Table = std::vector<SceneMember>;  ///< in the order of the file

  using Numbers = std::shared_ptr<const NumberTable>;
  using MeshHandle = std::shared_ptr<const MeshFile>;

  std::variant<bool, std::int64_t, double, std::string, Array, Table, Numbers, MeshHandle> data;
  std::shared_ptr<const std::string> source;  ///< "beam.toml" or "--set newton.tolerance=1"
  int line = 0;                               ///< from 1; 0 when the source has no lines

  SceneValue();  ///< an empty table

  bool is_table() const { return std::holds_alternative<Table>(data); }
  bool is_array() const { return std::holds_alternative<Array>(data); }
  Table& table() { return std::get<Table>(data); }
  const Table& table() const { return std::get<Table>(data); }
  Array& array() { return std::get<Array>(data); }
  const Array& array() const { return std::get<Array>(data); }

  /// The value under `key`, or null when this is no table or has no such key.
  const SceneValue* find(std::string_view key) const;
  SceneValue* find(std::string_view key);
};

/// One key of a table with its value.
struct SceneMember {
  std::string key;
  SceneValue value;
};

inline SceneValue::SceneValue() : data(Table{}) {}

/// "beam.toml:12", or the source alone when there is no line.
std::string source_and_line(const SceneValue& value);

/// Text of a value in a message: "0.5", "\"text\"", "an array of 2", "a table".
std::string describe(const SceneValue& value);

/// Reads a whole TOML document. Throws InputError "NAME:LINE:COLUMN: ..." when it is not TOML.
SceneValue parse_toml(std::string_view text, const std::string& name);

/// The scene as a TOML document, which reads back as the same values: root and sections by name, all that
/// lies deeper inline. Throws InputError for arrays and meshes that a program handed over.
std::string toml_text(const SceneValue& scene);

/// Sets one value of the scene. `key` is a dotted path in which the entries of a list are named by number
/// (from 0) or by their `name`; a part with dots of its own stands in double quotes: body."a.b".scale. Tables
/// that are missing on the way are made. Throws UnknownKeyError at `place` when the path leads nowhere.
void set_value(SceneValue& scene, std::string_view key, SceneValue value, const std::string& place);

/// The key as it stands when every entry of a list is named by its number: body.0.scale for body.beam.scale.
/// Throws as `set_value` does.
std::string numbered_key(const SceneValue& scene, std::string_view key, const std::string& place);

/// Sets one value of the scene. `assignment` is "KEY=VALUE": KEY as for `set_value`; VALUE as in TOML,
/// where a bare word is a text.
/// Throws InputError when the path leads nowhere or the value cannot be read.
void apply_override(SceneValue& scene, std::string_view assignment);

}  // namespace resilin
