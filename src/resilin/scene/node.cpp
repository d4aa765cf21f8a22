#include "resilin/scene/node.hpp"

#include <cmath>
#include <limits>
#include <system_error>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/vocabulary.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

/// The cure of a text where something else is wanted: dimension = "axisymmetric", radius = "1,5".
std::string cure_of_text(std::string text) {
  const std::size_t comma = text.find(',');
  double number = 0;
  if (comma != text.npos) {
    text[comma] = '.';
    if (parse_real(text, number)) return "write decimals with a point: " + text;
  }
  return foreign_word_cure(text);
}

}  // namespace

std::string SceneNode::place() const {
  const std::string start = source_and_line(*value);
  return path.empty() ? start : start + ": " + path;
}

SceneNode SceneNode::child(std::string_view key) const {
  return {value->find(key), path.empty() ? std::string(key) : path + "." + std::string(key), context};
}

SceneNode SceneNode::element(std::size_t i) const {
  return {&value->array()[i], path + "[" + std::to_string(i) + "]", context};
}

void SceneNode::fail(const std::string& expected, const std::string& cure) const {
  const auto* text = std::get_if<std::string>(&value->data);
  const bool is_plain_text = cure.empty() && text != nullptr;
  throw InputError(place(), expected, describe(*value), is_plain_text ? cure_of_text(*text) : cure);
}

void SceneNode::fail_with(const std::string& problem) const { throw InputError(place(), problem); }

void SceneNode::warn(const std::string& message) const {
  context->warnings.push_back(place() + ": " + message);
}

std::string Range::text() const {
  std::string text;
  if (std::isfinite(min)) text = (min_is_allowed ? ">= " : "> ") + format_number(min);
  if (std::isfinite(max)) text += (text.empty() ? "<= " : " and <= ") + format_number(max);
  return text;
}

double read_number(const SceneNode& node, const Range& range) {
  const std::string expected = range.text().empty() ? "a number" : "a number " + range.text();
  double x = std::numeric_limits<double>::quiet_NaN();
  if (const auto* integer = std::get_if<std::int64_t>(&node.value->data)) x = static_cast<double>(*integer);
  if (const auto* real = std::get_if<double>(&node.value->data)) x = *real;
  if (!std::isfinite(x) || !range.contains(x)) node.fail(expected);
  return x;
}

int read_integer(const SceneNode& node, const Range& range) {
  const std::string expected = range.text().empty() ? "a whole number" : "a whole number " + range.text();
  const auto* integer = std::get_if<std::int64_t>(&node.value->data);
  if (integer == nullptr || !range.contains(static_cast<double>(*integer))) node.fail(expected);
  if (*integer > std::numeric_limits<int>::max() || *integer < std::numeric_limits<int>::min()) {
    node.fail(expected + " that fits 32 bits");
  }
  return static_cast<int>(*integer);
}

bool read_flag(const SceneNode& node) {
  const auto* flag = std::get_if<bool>(&node.value->data);
  if (flag == nullptr) node.fail("true or false");
  return *flag;
}

std::string read_text(const SceneNode& node) {
  const auto* text = std::get_if<std::string>(&node.value->data);
  if (text == nullptr) node.fail("a text");
  return *text;
}

namespace {

/// Lengths are wrong mostly because the scene has another dimension: say so.
void expect_coordinates(const SceneNode& node, const std::string& of_what) {
  const int dim = node.context->dimension;
  const std::string expected =
      std::to_string(dim) + " " + of_what + " since simulation.dimension is " + std::to_string(dim);
  if (!node.value->is_array()) node.fail(expected);
  const std::size_t size = node.value->array().size();
  if (size == static_cast<std::size_t>(dim)) return;
  const bool may_have_commas = size > 3 && size <= static_cast<std::size_t>(2 * dim);  // [0,5, 1,2]
  throw InputError(node.place(), expected, std::to_string(size),
                   may_have_commas ? "decimals need a point, not a comma" : "");
}

}  // namespace

Vector3 read_vector(const SceneNode& node) {
  expect_coordinates(node, "numbers");
  Vector3 vector = Vector3::Zero();
  for (int i = 0; i < node.context->dimension; ++i) {
    vector[i] = read_number(node.element(static_cast<std::size_t>(i)));
  }
  return vector;
}

Eigen::Matrix3d read_matrix(const SceneNode& node) {
  expect_coordinates(node, "rows of numbers");
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  for (int i = 0; i < node.context->dimension; ++i) {
    matrix.row(i) = read_vector(node.element(static_cast<std::size_t>(i))).transpose();
  }
  return matrix;
}

namespace {

/// The table of a list of rows; a row of one number may be the number itself.
NumberTable table_of_list(const SceneNode& list, std::size_t num_columns) {
  NumberTable table{.num_columns = num_columns, .values = {}};
  for (std::size_t i = 0; i < list.value->array().size(); ++i) {
    const SceneNode row = list.element(i);
    if (!row.value->is_array() && num_columns == 1) {
      table.values.push_back(read_number(row));
      continue;
    }
    expect_list(row, "numbers", static_cast<int>(num_columns));
    for (std::size_t k = 0; k < num_columns; ++k) table.values.push_back(read_number(row.element(k)));
  }
  return table;
}

}  // namespace

NumberTable read_rows(const SceneNode& node, std::size_t num_rows, std::size_t num_columns,
                      const std::string& of_what) {
  const auto counted = [](std::size_t rows, std::size_t columns) {
    return std::to_string(rows) + " rows of " + std::to_string(columns) +
           (columns == 1 ? " number" : " numbers");
  };
  NumberTable table;
  if (const auto* numbers = std::get_if<SceneValue::Numbers>(&node.value->data)) {
    table = **numbers;
  } else if (node.value->is_array()) {
    table = table_of_list(node, num_columns);
  } else if (std::holds_alternative<std::string>(node.value->data)) {
    table = read_csv(read_path(node));
  } else {
    node.fail("the name of a CSV file or a list, with " + counted(num_rows, num_columns));
  }
  if (table.num_columns != num_columns || table.num_rows() != num_rows) {
    node.fail_with("expected " + counted(num_rows, num_columns) + " (one row for each " + of_what +
                   "), got " + std::to_string(table.num_rows()) + " rows of " +
                   std::to_string(table.num_columns));
  }
  return table;
}

std::filesystem::path read_path(const SceneNode& node) {
  const std::string text = read_text(node);
  if (text.empty() || text.find('\0') != std::string::npos) node.fail("the name of a file");
  std::filesystem::path path = node.context->folder / text;
  std::error_code failure;
  if (std::filesystem::status(path, failure).type() == std::filesystem::file_type::not_found)
    node.fail_with(one_line(path.string()) + ": no such file");
  return path;
}

void expect_table(const SceneNode& node) {
  if (!node.value->is_table()) node.fail("a table { ... }");
}

void expect_list(const SceneNode& node, const std::string& of_what, int count) {
  const std::string expected =
      count < 0 ? "a list of " + of_what : "a list of " + std::to_string(count) + " " + of_what;
  if (!node.value->is_array()) node.fail(expected);
  if (count >= 0 && node.value->array().size() != static_cast<std::size_t>(count)) node.fail(expected);
}

}  // namespace resilin
