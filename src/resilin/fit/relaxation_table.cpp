#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/scene/csv.hpp"

namespace resilin {
namespace {

/// Column of the data: its name, others for it, and where it goes.
struct RelaxationColumn {
  const char* name;
  std::vector<std::string> words;
  std::vector<double> RelaxationDescription::* values;
  const char* unit;  ///< the only one; empty: any
  const char* text;
};

const std::vector<RelaxationColumn>& relaxation_columns() {
  using R = RelaxationDescription;
  static const std::vector<RelaxationColumn> columns = {
      {"time", {"t"}, &R::times, "s", "Time after the sudden strain of a relaxation test."},
      {"modulus",
       {"stress", "force", "nominal_stress", "relaxation_modulus"},
       &R::moduli,
       "",
       "Modulus, stress or force at these times, in any unit: the strain is held."},
      {"frequency", {"f"}, &R::frequencies, "Hz", "Frequency of a dynamic test (DMA)."},
      {"storage", {"storage_modulus"}, &R::storage, "", "Storage modulus at these frequencies, in any unit."},
      {"loss", {"loss_modulus"}, &R::loss, "", "Loss modulus, in the same unit."},
  };
  return columns;
}

/// "Storage modulus (MPa)" as "storage_modulus" and "MPa".
std::pair<std::string, std::string> name_and_unit(const std::string& heading) {
  std::pair<std::string, std::string> parts;
  const std::size_t open = heading.find_first_of("[("), close = heading.find_first_of("])");
  if (open != std::string::npos && close != std::string::npos && close > open)
    parts.second = heading.substr(open + 1, close - open - 1);
  for (const char c : heading.substr(0, open))
    parts.first +=
        c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  while (parts.first.ends_with('_')) parts.first.pop_back();
  return parts;
}

void take_columns(const SceneNode& node, RelaxationDescription& r) {
  r.source = printable(read_text(node));
  const NumberTable table = read_csv(read_path(node));
  if (table.num_rows() == 0) node.fail_with("expected rows of numbers in " + r.source + ", got none");
  if (table.column_names.empty())
    node.fail_with("expected a first line of column names in " + r.source +
                   ": time, modulus, or frequency, storage, loss");
  for (std::size_t i = 0; i < table.column_names.size(); ++i) {
    const auto [name, unit] = name_and_unit(table.column_names[i]);
    for (const RelaxationColumn& column : relaxation_columns()) {
      if (name != column.name && std::ranges::find(column.words, name) == column.words.end()) continue;
      if (*column.unit != '\0' && !unit.empty() && unit != column.unit)
        node.fail_with("expected " + std::string(column.name) + " [" + column.unit + "] in " + r.source +
                       ", got [" + printable(unit) + "]; convert the column");
      std::vector<double>& values = r.*column.values;
      if (!values.empty())
        node.fail_with("expected one column " + std::string(column.name) + " in " + r.source + ", got two");
      for (std::size_t row = 0; row < table.num_rows(); ++row)
        values.push_back(table.values[row * table.num_columns + i]);
    }
  }
}

Keys<RelaxationDescription> relaxation_keys() {
  using R = RelaxationDescription;
  Keys<R> keys = {key<R>({"file", "text", "", "none",
                          "A CSV file whose first line names its columns: time and modulus (or stress, "
                          "force), or frequency, storage and loss."},
                         take_columns)};
  for (const RelaxationColumn& column : relaxation_columns())
    keys.push_back(
        key<R>({column.name, "list of numbers", column.unit, "a column of the file", column.text},
               [values = column.values](const SceneNode& node, R& r) { r.*values = read_column(node); }));
  keys.push_back(integer_key("branches", &R::branches, Range{.min = 0, .max = 100},
                             "Number of relaxation times, evenly over the logarithm of time; 0: one for each "
                             "decade of the data."));
  keys.push_back(key<R>({"tau", "list of numbers > 0", "s", "evenly over the data",
                         "Relaxation times, in place of branches. Those that do not help get no share."},
                        [](const SceneNode& node, R& r) {
                          r.tau = read_column(node);
                          for (const double tau : r.tau)
                            if (!(tau > 0 && std::isfinite(tau))) node.fail("relaxation times > 0 s");
                        }));
  return keys;
}

void check_relaxation(const RelaxationDescription& r) {
  const bool is_dynamic = !r.frequencies.empty() || !r.storage.empty() || !r.loss.empty();
  const bool is_static = !r.times.empty() || !r.moduli.empty();
  if (is_dynamic == is_static)
    throw InputError(r.place, "time and modulus, or frequency, storage and loss",
                     is_static ? "both" : "neither", "add file = \"relaxation.csv\" with such columns");
  const std::vector<double>& at = is_static ? r.times : r.frequencies;
  for (const RelaxationColumn& column : relaxation_columns()) {
    const bool is_of_statics =
        column.values == &RelaxationDescription::times || column.values == &RelaxationDescription::moduli;
    if (is_of_statics != is_static) continue;
    const std::vector<double>& values = r.*column.values;
    if (values.size() != at.size() || values.empty())
      throw InputError(r.place + "." + column.name,
                       at.empty() ? "numbers" : std::to_string(at.size()) + " numbers",
                       std::to_string(values.size()));
    const bool may_be_zero =
        column.values == &RelaxationDescription::times || column.values == &RelaxationDescription::loss;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!(std::isfinite(values[i]) && (values[i] > 0 || (may_be_zero && values[i] == 0))))
        throw InputError(r.place + "." + column.name + ", row " + std::to_string(i + 1),
                         may_be_zero ? "a number >= 0" : "a number > 0", format_number(values[i]));
  }
}

}  // namespace

RelaxationDescription read_relaxation_root(const SceneNode& root) {
  RelaxationDescription relaxation;
  refuse_unknown_keys(root, {"title", "relaxation"});
  const SceneNode table = root.child("relaxation");
  relaxation.source = "the lists";
  read_table(table, relaxation_keys(), relaxation);
  relaxation.place = table.place();
  if (root.has("title")) relaxation.title = read_text(root.child("title"));
  check_relaxation(relaxation);
  return relaxation;
}

TableDoc relaxation_doc() {
  return document(
      "[relaxation]",
      "A relaxation test or a dynamic test, in a file of its own: `resilin fit` finds the Prony series "
      "of `viscoelastic` ([fit.md](fit.md#relaxation)).",
      relaxation_keys());
}

}  // namespace resilin
