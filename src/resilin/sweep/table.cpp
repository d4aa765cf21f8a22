#include "resilin/sweep/table.hpp"

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "resilin/core/csv_cell.hpp"

namespace resilin {
namespace {

using Json = nlohmann::ordered_json;

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.is_structured() ? csv_cell(value.dump()) : value.dump();
  return csv_cell(value.get_ref<const std::string&>());
}

Json part(const Json& row, const char* group, const std::string& name) {
  const auto table = row.find(group);
  if (table == row.end() || !table->is_object()) return nullptr;
  const auto entry = table->find(name);
  return entry == table->end() ? Json(nullptr) : *entry;
}

void write_line(std::ostream& stream, const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) stream << (i == 0 ? "" : ",") << cells[i];
  stream << '\n';
}

const std::vector<const char*>& numbers() {
  static const std::vector<const char*> names = {"steps", "newton_iterations", "unknowns", "seconds", "kept",
                                                 "reason"};
  return names;
}

}  // namespace

void write_csv(const SweepFolder& folder, std::ostream& stream) {
  const Sweep& sweep = folder.sweep();
  std::vector<std::string> cells = {"scene", "hash"};
  for (const SweepParameter& parameter : sweep.parameters()) cells.push_back(cell(parameter.name));
  cells.emplace_back("status");
  for (const Quantity& quantity : sweep.quantities()) cells.push_back(cell(quantity.name));
  for (const char* name : numbers()) cells.emplace_back(name);
  write_line(stream, cells);
  for (std::uint64_t i = 0; i < sweep.size(); ++i) {
    const SceneHash hash = sweep.hash(i);
    const std::string line = folder.line(hash);
    if (line.empty()) continue;
    const Json row = Json::parse(line, nullptr, false);
    if (!row.is_object()) continue;
    cells = {std::to_string(i), hash.text()};
    for (const SweepParameter& parameter : sweep.parameters())
      cells.push_back(cell(part(row, "parameters", parameter.name)));
    cells.push_back(cell(row.value("status", Json(nullptr))));
    for (const Quantity& quantity : sweep.quantities())
      cells.push_back(cell(part(row, "quantities", quantity.name)));
    for (const char* name : numbers()) cells.push_back(cell(row.value(name, Json(nullptr))));
    write_line(stream, cells);
  }
}

}  // namespace resilin
