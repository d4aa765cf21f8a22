#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/test_columns.hpp"
#include "resilin/fit/units.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

std::vector<std::string> unit_names(std::span<const Unit> units) {
  std::vector<std::string> names;
  for (const Unit& unit : units) names.emplace_back(unit.name);
  return names;
}

Key<RawTest> unit_key(const char* name, std::string RawTest::* member, std::span<const Unit> units,
                      const char* text) {
  const std::vector<std::string> names = unit_names(units);
  return key<RawTest>({name, one_of(names), "", default_text(RawTest{}.*member), text},
                      [=](const SceneNode& node, RawTest& test) { test.*member = read_choice(node, names); });
}

void read_column_names(const SceneNode& node, RawTest& test) {
  expect_table(node);
  refuse_unknown_keys(node, all_spellings<ColumnRole>());
  for (const SceneMember& member : node.value->table())
    if (const std::optional<ColumnRole> role = find_spelled<ColumnRole>(member.key))
      test.columns[*role] = read_text(node.child(member.key));
}

Key<RawTest> list_key(ColumnRole role, const char* unit, const char* text) {
  return key<RawTest>({spelling(role), "list of numbers", unit, "a column of the file", text},
                      [=](const SceneNode& node, RawTest& test) { test.lists[role] = read_column(node); });
}

void read_table_file(const SceneNode& node, RawTest& test) {
  test.file = read_text(node);
  test.table = read_csv(read_path(node));
  if (test.table.num_rows() == 0)
    node.fail_with("expected rows of numbers in " + printable(test.file) + ", got none");
}

Keys<RawTest> material_test_keys() {
  using T = RawTest;
  return {
      text_key("name", &T::name, "the mode", "Name in tables and pictures."),
      {.doc = {"mode", one_of(all_spellings<TestMode>()), "", "required",
               "A planar test (a wide sheet of constant width) is also called pure shear; confined: fixed "
               "sides; volumetric: equal motion of all sides."},
       .read = [](const SceneNode& node, T& test) { test.mode = read_choice<TestMode>(node); },
       .is_required = true},
      key<T>({"file", "text", "", "none",
              "A CSV file whose first line names its columns, as below; without names the first is the "
              "strain measure, the second the stress."},
             read_table_file),
      key<T>({"columns", "table of texts", "", "the names below",
              "Column names of the file: { stretch = \"lambda_1\", nominal_stress = \"P\" }."},
             read_column_names),
      list_key(ColumnRole::stretch, "", "Stretch: length over reference length."),
      list_key(ColumnRole::strain, "", "Engineering strain, stretch - 1, in place of stretch."),
      list_key(ColumnRole::shear, "", "Amount of shear (tangent of the angle) in simple_shear."),
      list_key(ColumnRole::volume_ratio, "", "Volume over reference volume in a volumetric test."),
      list_key(ColumnRole::displacement, "length_unit",
               "Displacement of the end, in place of stretch; needs length."),
      list_key(ColumnRole::nominal_stress, "unit",
               "Nominal stress: force over reference area; positive in tension."),
      list_key(ColumnRole::pressure, "unit", "Pressure of a volumetric test, in place of nominal_stress."),
      list_key(ColumnRole::force, "force_unit", "Force, in place of nominal_stress; needs area."),
      key<T>(
          {"unit", one_of(unit_names(stress_units())), "", "that of the column's name, else Pa",
           "Unit of the stresses, also in the report."},
          [](const SceneNode& node, T& test) { test.unit = read_choice(node, unit_names(stress_units())); }),
      key<T>({"sigma", "number > 0 or list of numbers", "unit", "none",
              "Standard deviation of the stresses, for residual = \"sigma\"."},
             [](const SceneNode& node, T& test) {
               if (node.value->is_array() || std::holds_alternative<SceneValue::Numbers>(node.value->data))
                 test.lists[ColumnRole::sigma] = read_column(node);
               else
                 test.sigma = read_number(node, positive);
             }),
      number_key("weight", &T::weight, "", positive, "Weight of the squared residuals of this test."),
      key<T>({"length", "number > 0", "length_unit", "none",
              "Reference length of the specimen (in simple shear its height), with displacement."},
             [](const SceneNode& node, T& test) { test.length = read_number(node, positive); }),
      key<T>({"area", "number > 0", "length_unit^2", "none",
              "Reference area of the loaded section, with force."},
             [](const SceneNode& node, T& test) { test.area = read_number(node, positive); }),
      unit_key("length_unit", &T::length_unit, length_units(), "Unit of displacement, length and area."),
      unit_key("force_unit", &T::force_unit, force_units(), "Unit of force."),
  };
}

}  // namespace

std::vector<double> read_column(const SceneNode& node) {
  if (const auto* numbers = std::get_if<SceneValue::Numbers>(&node.value->data)) {
    if ((*numbers)->num_columns != 1) node.fail("a list of numbers");
    return (*numbers)->values;
  }
  expect_list(node, "numbers");
  std::vector<double> values;
  for (std::size_t i = 0; i < node.value->array().size(); ++i) values.push_back(read_number(node.element(i)));
  return values;
}

MaterialTest read_material_test(const SceneNode& node) {
  RawTest raw;
  read_table(node, material_test_keys(), raw);
  if (raw.name.empty()) raw.name = spelling(raw.mode);
  return test_of(raw, node.place(), node.context->warnings);
}

TableDoc material_test_doc() {
  return document("[[test]]", "A homogeneous test of one specimen.", material_test_keys());
}

}  // namespace resilin
