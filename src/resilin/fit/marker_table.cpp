#include "resilin/fit/marker_table.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

using Columns = std::array<std::optional<std::size_t>, 3>;

/// The columns of what is measured, and which component each is.
std::vector<std::pair<std::string, std::size_t>> value_columns(MeasuredKind kind, int dim) {
  if (is_number(kind)) return {{spelling(kind), 0}};
  if (kind == MeasuredKind::moment && dim == 2) return {{"mz", 2}};
  const bool is_force = kind == MeasuredKind::reaction || kind == MeasuredKind::section;
  const char letter = is_force ? 'f' : kind == MeasuredKind::moment ? 'm' : 'u';
  std::vector<std::pair<std::string, std::size_t>> columns;
  for (std::size_t i = 0; i < static_cast<std::size_t>(dim); ++i)
    columns.emplace_back(std::string(1, letter) + "xyz"[i], i);
  return columns;
}

/// The columns of a table by their names.
class MeasuredColumns {
 public:
  MeasuredColumns(MeasuredKind kind, const NumberTable& table, int dim, const std::string& source)
      : kind_(kind), table_(table), dim_(dim), source_(source) {
    if (table.column_names.empty())
      throw InputError(source, "a first line that names the columns, such as " + example(), "numbers alone");
    const std::vector<std::string> names = known();
    for (const std::string& name : table.column_names) {
      if (std::ranges::find(names, name) == names.end()) refuse_word(source, name, names);
      if (std::ranges::count(table.column_names, name) > 1)
        throw InputError(source, "each column once", "\"" + name + "\" twice");
    }
    find_vectors();
  }

  std::optional<std::size_t> find(const std::string& name) const {
    const auto found = std::ranges::find(table_.column_names, name);
    if (found == table_.column_names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - table_.column_names.begin());
  }

  bool holds_places() const { return holds_places_; }
  const Columns& at() const { return at_; }
  const Columns& values() const { return values_; }

 private:
  std::string example() const {
    std::vector<std::string> names;
    for (int i = 0; i < dim_ && has_places(kind_); ++i) names.emplace_back(1, "XYZ"[i]);
    for (const auto& [name, component] : value_columns(kind_, dim_)) names.push_back(name);
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
    return text;
  }

  std::vector<std::string> known() const {
    std::vector<std::string> names;
    for (const auto& [name, component] : value_columns(kind_, dim_)) names.push_back(name);
    for (const char* letters : {kind_ == MeasuredKind::markers ? "xyz" : "", has_places(kind_) ? "XYZ" : ""})
      for (int i = 0; i < dim_ && letters[0] != 0; ++i) names.emplace_back(1, letters[i]);
    for (const char* name : {"sigma", "load", "time", "id"}) names.emplace_back(name);
    return names;
  }

  Columns vector(const std::string& before, const char* letters) const {
    Columns columns;
    for (int i = 0; i < dim_; ++i) columns[static_cast<std::size_t>(i)] = find(before + letters[i]);
    return columns;
  }

  static bool has_any(const Columns& columns) {
    return std::ranges::any_of(columns, [](const auto& column) { return column.has_value(); });
  }

  void find_vectors() {
    for (const auto& [name, component] : value_columns(kind_, dim_)) values_[component] = find(name);
    if (has_places(kind_)) {
      const Columns rest = vector("", "XYZ"), small = vector("", "xyz");
      const bool tells_values = has_any(values_);
      at_ = has_any(rest) ? rest : small;
      if (!tells_values && has_any(rest) && kind_ == MeasuredKind::markers) {
        values_ = small;
        holds_places_ = true;
      } else if (tells_values && has_any(rest) && has_any(small)) {
        throw InputError(source_, "displacements ux, uy, uz or positions x, y, z beside X, Y, Z", "both",
                         "leave one of them out");
      }
      for (int i = 0; i < dim_; ++i)
        if (!at_[static_cast<std::size_t>(i)])
          throw InputError(source_, std::string("a column ") + "XYZ"[i] + ", a reference position",
                           "the columns " + join(table_.column_names), "for example " + example());
    }
    if (!has_any(values_))
      throw InputError(source_, "a column of what was measured", "the columns " + join(table_.column_names),
                       "for example " + example());
  }

  MeasuredKind kind_;
  const NumberTable& table_;
  int dim_;
  std::string source_;
  Columns at_, values_;
  bool holds_places_ = false;
};

}  // namespace

std::string unit_of(MeasuredKind kind) {
  switch (kind) {
    case MeasuredKind::markers:
    case MeasuredKind::probe:
      return "m";
    case MeasuredKind::reaction:
    case MeasuredKind::section:
      return "N";
    case MeasuredKind::moment:
      return "N m";
    case MeasuredKind::energy:
      return "J";
    case MeasuredKind::volume:
      return "m^3";
    case MeasuredKind::stress:
      break;
  }
  return "Pa";
}

std::vector<MeasuredRow> measured_rows(MeasuredKind kind, const NumberTable& table, int dim, bool is_dynamic,
                                       const std::string& file, const std::string& place) {
  const std::string source = place + " (" + one_line(file) + ")";
  const MeasuredColumns columns(kind, table, dim, source);
  const auto sigma = columns.find("sigma");
  const auto moment = columns.find(is_dynamic ? "time" : "load");
  if (columns.find(is_dynamic ? "load" : "time"))
    throw InputError(
        source, is_dynamic ? "a column time, because the scene is dynamic" : "a column load, the load factor",
        is_dynamic ? "a column load" : "a column time",
        is_dynamic ? "name it time [s]" : "the scene is static");
  std::vector<MeasuredRow> rows;
  for (std::size_t r = 0; r < table.num_rows(); ++r) {
    const auto cell = [&](std::size_t column) { return table.values[r * table.num_columns + column]; };
    MeasuredRow row;
    row.place = source + ", row " + std::to_string(r + 1);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (const auto at = columns.at()[i]) row.at[k] = cell(*at);
      const auto value = columns.values()[i];
      if (!value) continue;
      row.is_measured[i] = true;
      row.value[k] = cell(*value) - (columns.holds_places() ? row.at[k] : 0);
    }
    if (sigma) {
      row.sigma = cell(*sigma);
      if (!(row.sigma > 0)) throw InputError(row.place, "a sigma above 0", format_number(row.sigma));
    }
    if (moment) row.moment = cell(*moment);
    rows.push_back(row);
  }
  if (rows.empty()) throw InputError(source, "rows of numbers", "none");
  return rows;
}

}  // namespace resilin
