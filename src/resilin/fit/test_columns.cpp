#include "resilin/fit/test_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/units.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

/// A name of a column, without its unit: "Nominal stress (MPa)" is nominal_stress in MPa.
struct Heading {
  std::string name, unit;

  explicit Heading(const std::string& text) {
    const std::size_t open = text.find_first_of("[("), close = text.find_first_of("])");
    if (open != std::string::npos && close != std::string::npos && close > open)
      unit = text.substr(open + 1, close - open - 1);
    for (const char c : text.substr(0, open))
      name += c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    while (name.ends_with('_')) name.pop_back();
  }
};

/// Other names of a column.
std::vector<std::string> other_names(ColumnRole role) {
  switch (role) {
    case ColumnRole::stretch:
      return {"lambda", "stretch_ratio"};
    case ColumnRole::strain:
      return {"engineering_strain", "nominal_strain"};
    case ColumnRole::shear:
      return {"gamma", "shear_strain"};
    case ColumnRole::nominal_stress:
      return {"stress", "engineering_stress", "shear_stress"};
    default:
      return {};
  }
}

std::vector<ColumnRole> load_roles(TestMode mode) {
  if (mode == TestMode::simple_shear) return {ColumnRole::shear, ColumnRole::displacement};
  std::vector<ColumnRole> roles = {ColumnRole::stretch, ColumnRole::strain, ColumnRole::displacement};
  if (mode == TestMode::volumetric) roles.push_back(ColumnRole::volume_ratio);
  return roles;
}

std::vector<ColumnRole> stress_roles(TestMode mode) {
  std::vector<ColumnRole> roles = {ColumnRole::nominal_stress, ColumnRole::force};
  if (mode == TestMode::volumetric) roles.push_back(ColumnRole::pressure);
  return roles;
}

std::string role_names(const std::vector<ColumnRole>& roles) {
  std::vector<std::string> names;
  for (const ColumnRole role : roles) names.push_back(spelling(role));
  return join(names, " or ");
}

/// Finds and converts the columns of a test.
class ColumnFinder {
 public:
  ColumnFinder(const RawTest& raw, const std::string& place) : raw_(raw), place_(place) {
    for (const std::string& name : raw.table.column_names) headings_.emplace_back(name);
  }

  struct Found {
    ColumnRole role;
    std::vector<double> values;
    std::string unit;  ///< unit of the heading
  };

  Found require(const std::vector<ColumnRole>& roles, std::size_t place_without_names) const {
    std::optional<Found> found;
    for (const ColumnRole role : roles)
      if (std::optional<Found> column = find(role); column && is_said(role)) return *column;
    for (const ColumnRole role : roles)
      if (std::optional<Found> column = find(role)) {
        if (found) refuse_both(found->role, role);
        found = std::move(column);
      }
    if (found) return *found;
    if (has_file() && headings_.empty()) return unnamed(roles, place_without_names);
    refuse_missing(roles);
  }

  std::optional<Found> find(ColumnRole role) const {
    if (const auto list = raw_.lists.find(role); list != raw_.lists.end())
      return Found{role, list->second, {}};
    if (const auto column = raw_.columns.find(role); column != raw_.columns.end())
      return at(role, require_named(column->second));
    std::vector<std::string> names = other_names(role);
    names.insert(names.begin(), spelling(role));
    for (const std::string& name : names)
      for (std::size_t i = 0; i < headings_.size(); ++i)
        if (headings_[i].name == name) return at(role, i);
    return std::nullopt;
  }

 private:
  bool is_said(ColumnRole role) const { return raw_.lists.contains(role) || raw_.columns.contains(role); }
  bool has_file() const { return !raw_.file.empty(); }
  std::string source() const { return has_file() ? place_ + " (" + printable(raw_.file) + ")" : place_; }

  Found at(ColumnRole role, std::size_t column) const {
    Found found{role, {}, headings_.empty() ? std::string() : headings_[column].unit};
    for (std::size_t i = 0; i < raw_.table.num_rows(); ++i)
      found.values.push_back(raw_.table.values[i * raw_.table.num_columns + column]);
    return found;
  }

  Found unnamed(const std::vector<ColumnRole>& roles, std::size_t column) const {
    if (column >= raw_.table.num_columns)
      throw InputError(source(), "a column " + role_names(roles), "a file of one column without names",
                       "give the columns names in the first line");
    return at(roles.front(), column);
  }

  std::size_t require_named(const std::string& name) const {
    const std::vector<std::string>& names = raw_.table.column_names;
    const auto found = std::ranges::find(names, name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    if (names.empty())
      throw InputError(source(), "a first line of column names, for \"" + printable(name) + "\"",
                       "numbers alone");
    refuse_word(source() + ".columns", name, names);
  }

  [[noreturn]] void refuse_both(ColumnRole a, ColumnRole b) const {
    throw InputError(source(), spelling(a) + " or " + spelling(b), "both",
                     "say which: columns = { " + spelling(a) + " = \"...\" }");
  }

  [[noreturn]] void refuse_missing(const std::vector<ColumnRole>& roles) const {
    if (headings_.empty())
      throw InputError(source(), "a file, or a list " + role_names(roles), "neither",
                       "add file = \"test.csv\" with named columns");
    std::vector<std::string> names;
    for (const Heading& heading : headings_) names.push_back(heading.name);
    for (const ColumnRole role : roles) {
      const std::string near = nearest_word(spelling(role), names);
      if (!near.empty())
        throw InputError(source(), "a column " + role_names(roles), "the columns " + join(names),
                         "did you mean \"" + spelling(role) + "\" by \"" + near + "\"?");
    }
    throw InputError(source(), "a column " + role_names(roles), "the columns " + join(names),
                     "say which it is: columns = { " + spelling(roles.front()) + " = \"" +
                         raw_.table.column_names.front() + "\" }");
  }

  const RawTest& raw_;
  const std::string& place_;
  std::vector<Heading> headings_;
};

double required_size(double size, const char* key, ColumnRole role, const std::string& place) {
  if (size > 0) return size;
  throw InputError(place,
                   std::string("the key \"") + key + "\" of the undeformed specimen beside " + spelling(role),
                   "nothing", std::string("add ") + key + " = ...");
}

/// The stretches, or amounts of shear, of a column.
std::vector<double> loads_of(const RawTest& raw, const ColumnFinder::Found& column,
                             const std::string& place) {
  std::vector<double> loads = column.values;
  const bool is_shear = raw.mode == TestMode::simple_shear;
  for (double& load : loads) {
    if (column.role == ColumnRole::strain) load += 1;
    if (column.role == ColumnRole::volume_ratio) load = std::cbrt(load);
    if (column.role == ColumnRole::displacement) {
      const double length = required_size(raw.length, "length", column.role, place);
      load = load / length + (is_shear ? 0 : 1);
    }
  }
  for (std::size_t i = 0; i < loads.size() && !is_shear; ++i)
    if (!(loads[i] > 0))
      throw InputError(place + ", row " + std::to_string(i + 1), "a stretch above 0", format_number(loads[i]),
                       column.role == ColumnRole::stretch
                           ? "an undeformed specimen has the stretch 1; if the column holds engineering "
                             "strains, name it strain"
                           : "a specimen keeps some of its length");
  return loads;
}

/// Factor from a column of stresses to Pa.
double stress_factor(const RawTest& raw, const ColumnFinder::Found& column, const std::string& place,
                     MaterialTest& test) {
  if (column.role == ColumnRole::force) {
    const double length = require_unit(length_units(), raw.length_unit, place + ".length_unit").in_si;
    const double area = required_size(raw.area, "area", column.role, place) * length * length;
    const std::string name = column.unit.empty() ? raw.force_unit : column.unit;
    test.has_unit = true;
    test.unit = raw.unit.value_or("Pa");
    test.unit_in_pascal = require_unit(stress_units(), test.unit, place + ".unit").in_si;
    return require_unit(force_units(), name, place + ".force_unit").in_si / area;
  }
  if (raw.unit && !column.unit.empty() && *raw.unit != column.unit)
    throw InputError(place + ".unit", "the unit of the column, " + printable(column.unit),
                     printable(*raw.unit), "leave one of them out");
  test.has_unit = raw.unit.has_value() || !column.unit.empty();
  test.unit = raw.unit.value_or(column.unit.empty() ? "Pa" : column.unit);
  test.unit_in_pascal = require_unit(stress_units(), test.unit, place + ".unit").in_si;
  return test.unit_in_pascal;
}

/// A pressure presses the faces of the strained block; nominal stress is per rest area.
void turn_pressures(const std::vector<double>& stretches, std::vector<double>& values, double sign) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= sign * stretches[i] * stretches[i];
}

void require_length(const std::vector<double>& values, const MaterialTest& test, ColumnRole role) {
  if (values.size() == test.load.size()) return;
  throw InputError(test.place + "." + spelling(role),
                   std::to_string(test.load.size()) + " numbers, as many as there are loads",
                   std::to_string(values.size()));
}

void read_sigmas(const RawTest& raw, const ColumnFinder& finder, double factor, bool is_pressure,
                 MaterialTest& test) {
  if (const auto column = finder.find(ColumnRole::sigma)) {
    if (raw.sigma) throw InputError(test.place + ".sigma", "a number or a column", "both");
    test.sigma = column->values;
    require_length(test.sigma, test, ColumnRole::sigma);
  } else if (raw.sigma) {
    test.sigma.assign(test.load.size(), *raw.sigma);
  }
  for (std::size_t i = 0; i < test.sigma.size(); ++i) {
    if (!(test.sigma[i] > 0))
      throw InputError(test.place + ", row " + std::to_string(i + 1), "a sigma above 0",
                       format_number(test.sigma[i]));
    test.sigma[i] *= factor;
  }
  if (is_pressure) turn_pressures(test.load, test.sigma, 1);
}

/// Takes out the points at rest; a stress there is a preload, which no law has.
void leave_rest_out(MaterialTest& test, std::vector<std::string>& warnings) {
  double largest = 0;
  for (const double stress : test.stress) largest = std::max(largest, std::abs(stress));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < test.load.size(); ++i) {
    if (std::abs(test.load[i] - rest_load(test.mode)) < 1e-9) {
      if (std::abs(test.stress[i]) > 0.01 * largest)
        warnings.push_back(test.place + ": a stress of " +
                           format_short(test.stress[i] / test.unit_in_pascal) + " " + test.unit +
                           " at zero strain; every law has none there: subtract the preload");
      continue;
    }
    test.load[kept] = test.load[i];
    test.stress[kept] = test.stress[i];
    if (!test.sigma.empty()) test.sigma[kept] = test.sigma[i];
    ++kept;
  }
  test.load.resize(kept);
  test.stress.resize(kept);
  if (!test.sigma.empty()) test.sigma.resize(kept);
}

/// Stresses that pull where the specimen is pushed.
void warn_of_signs(const MaterialTest& test, std::vector<std::string>& warnings) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < test.num_points(); ++i)
    wrong += (test.load[i] - rest_load(test.mode)) * test.stress[i] < 0 ? 1 : 0;
  if (2 * wrong > test.num_points())
    warnings.push_back(test.place +
                       ": most stresses have the other sign than the strain; tension is positive, "
                       "and so is a stretch above 1");
}

}  // namespace

MaterialTest test_of(const RawTest& raw, const std::string& place, std::vector<std::string>& warnings) {
  MaterialTest test;
  test.place = place;
  test.name = raw.name;
  test.mode = raw.mode;
  test.weight = raw.weight;
  const ColumnFinder finder(raw, place);
  const ColumnFinder::Found load = finder.require(load_roles(raw.mode), 0);
  const ColumnFinder::Found stress = finder.require(stress_roles(raw.mode), 1);
  test.load = loads_of(raw, load, place);
  test.stress = stress.values;
  require_length(test.stress, test, stress.role);
  const double factor = stress_factor(raw, stress, place, test);
  for (double& value : test.stress) value *= factor;
  const bool is_pressure = stress.role == ColumnRole::pressure;
  if (is_pressure) turn_pressures(test.load, test.stress, -1);
  read_sigmas(raw, finder, factor, is_pressure, test);
  leave_rest_out(test, warnings);
  if (test.num_points() == 0)
    throw InputError(place, "points at nonzero strain",
                     raw.file.empty() ? "none" : "none in " + printable(raw.file));
  warn_of_signs(test, warnings);
  return test;
}

}  // namespace resilin
