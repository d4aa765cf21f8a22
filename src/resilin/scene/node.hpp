#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/types.hpp"
#include "resilin/scene/csv.hpp"
#include "resilin/scene/value.hpp"

/// Typed reading of scene values. Every failure is an InputError that begins with the place of the value.
namespace resilin {

class MeshCache;

/// There is no such key, whatever its value.
class UnknownKeyError : public InputError {
 public:
  using InputError::InputError;
};

/// Context of a value.
struct SceneContext {
  std::filesystem::path folder;  ///< relative paths are beside the scene
  int dimension = 3;
  bool is_dynamic = false;
  std::int64_t max_box_cells = 0;
  MeshCache* meshes = nullptr;  ///< cache for scenes that share meshes; may be null
  bool is_for_real_time = false;
  std::vector<std::string> warnings;
};

/// A value together with the way that leads to it.
struct SceneNode {
  const SceneValue* value;
  std::string path;  ///< "body[0].material"
  SceneContext* context;

  std::string place() const;                    ///< "beam.toml:12: body[0].material"
  SceneNode child(std::string_view key) const;  ///< value of a key that the table has
  SceneNode element(std::size_t i) const;       ///< element of an array
  bool has(std::string_view key) const { return value->find(key) != nullptr; }

  [[noreturn]] void fail(const std::string& expected, const std::string& cure = {}) const;
  [[noreturn]] void fail_with(const std::string& problem) const;  ///< where no single value is wrong
  void warn(const std::string& message) const;
};

/// The numbers that a key may take.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  bool min_is_allowed = true;
  double max = std::numeric_limits<double>::infinity();

  bool contains(double x) const { return (min_is_allowed ? x >= min : x > min) && x <= max; }
  std::string text() const;  ///< "> 0"; empty for all numbers
};
inline constexpr Range any_number{};
inline constexpr Range positive{0, false};
inline constexpr Range not_negative{0, true};
inline constexpr Range at_least_one{1, true};

/// Values of a node. They throw InputError with file, line and key, what was expected and what came.
double read_number(const SceneNode& node, const Range& range = any_number);
int read_integer(const SceneNode& node, const Range& range = any_number);
bool read_flag(const SceneNode& node);
std::string read_text(const SceneNode& node);
/// One number for each coordinate of the scene; the third is zero in 2D.
Vector3 read_vector(const SceneNode& node);
/// dimension x dimension numbers as a list of rows; the rest is zero in 2D.
Eigen::Matrix3d read_matrix(const SceneNode& node);
/// Rows of `num_columns` numbers: a CSV file, a list of rows (of numbers, for one column) or an array.
/// `of_what` completes "one row for each ...".
NumberTable read_rows(const SceneNode& node, std::size_t num_rows, std::size_t num_columns,
                      const std::string& of_what);
/// The path of a file that is there, beside the scene unless absolute.
std::filesystem::path read_path(const SceneNode& node);
/// Throws unless the value is a table or, for the second, a list of `count` entries (any number for -1).
void expect_table(const SceneNode& node);
void expect_list(const SceneNode& node, const std::string& of_what, int count = -1);

}  // namespace resilin
