#include "resilin/fit/marker_table.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

using Columns = std::array<std::optional<std::size_t>, 3>;

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
    const bool is_flat = dim_ == 2;
    switch (kind_) {
      case MeasuredKind::markers:
        return is_flat ? "X,Y,ux,uy" : "X,Y,Z,ux,uy,uz";
      case MeasuredKind::reaction:
        return is_flat ? "fx,fy" : "fx,fy,fz";
      case MeasuredKind::probe:
        break;
    }
    return is_flat ? "ux,uy" : "ux,uy,uz";
  }

  std::vector<std::string> known() const {
    std::vector<std::string> names;
    std::vector<std::string> vectors = {kind_ == MeasuredKind::reaction ? "f" : "u"};
    if (kind_ == MeasuredKind::markers) vectors.emplace_back();
    for (const std::string& vector : vectors)
      for (int i = 0; i < dim_; ++i) names.push_back(vector + "xyz"[i]);
    if (kind_ == MeasuredKind::markers)
      for (int i = 0; i < dim_; ++i) names.emplace_back(1, "XYZ"[i]);
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
    values_ = vector(kind_ == MeasuredKind::reaction ? "f" : "u", "xyz");
    if (kind_ == MeasuredKind::markers) {
      const Columns rest = vector("", "XYZ"), small = vector("", "xyz");
      const bool tells_displacements = has_any(values_);
      at_ = has_any(rest) ? rest : small;
      if (!tells_displacements && has_any(rest)) {
        values_ = small;
        holds_places_ = true;
      } else if (tells_displacements && has_any(rest) && has_any(small)) {
        throw InputError(source_, "displacements ux, uy, uz or places x, y, z beside X, Y, Z", "both",
                         "leave one of them out");
      }
      for (int i = 0; i < dim_; ++i)
        if (!at_[static_cast<std::size_t>(i)])
          throw InputError(source_, std::string("a column ") + "XYZ"[i] + ", where the markers are at rest",
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

std::vector<MeasuredRow> measured_rows(MeasuredKind kind, const NumberTable& table, int dim, bool is_dynamic,
                                       const std::string& file, const std::string& place) {
  const std::string source = place + " (" + one_line(file) + ")";
  const MeasuredColumns columns(kind, table, dim, source);
  const auto sigma = columns.find("sigma");
  const auto moment = columns.find(is_dynamic ? "time" : "load");
  if (columns.find(is_dynamic ? "load" : "time"))
    throw InputError(source,
                     is_dynamic ? "a column time, for the scene moves" : "a column load, the load factor",
                     is_dynamic ? "a column load" : "a column time",
                     is_dynamic ? "name it time [s]" : "the scene is at rest");
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
