#include <algorithm>
#include <cmath>

#include "resilin/material/law.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/scene/material_library.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const LawInfo* law : laws()) names.emplace_back(law->name);
  return names;
}

std::vector<double> read_numbers(const SceneNode& node) {
  if (const auto* table = std::get_if<SceneValue::Numbers>(&node.value->data)) return (*table)->values;
  expect_list(node, "numbers, one for each branch");
  std::vector<double> numbers;
  for (std::size_t i = 0; i < node.value->array().size(); ++i)
    numbers.push_back(read_number(node.element(i)));
  return numbers;
}

void read_branches(const SceneNode& node, ViscoelasticDescription& v) {
  struct Branch {
    double g = 0, k = 0, tau = 0;
  };
  const Keys<Branch> keys = {number_key("g", &Branch::g, "", any_number, "Share in the moduli that relax."),
                             number_key("k", &Branch::k, "", any_number, "Share in the bulk modulus."),
                             number_key("tau", &Branch::tau, "s", any_number, "Relaxation time.")};
  expect_list(node, "tables { g, k, tau }");
  for (std::size_t i = 0; i < node.value->array().size(); ++i) {
    Branch branch;
    read_table(node.element(i), keys, branch);
    v.g.push_back(branch.g);
    v.k.push_back(branch.k);
    v.tau.push_back(branch.tau);
  }
  if (std::ranges::all_of(v.k, [](double k) { return k == 0; })) v.k.clear();
}

Keys<ViscoelasticDescription> viscoelastic_keys() {
  using V = ViscoelasticDescription;
  return {
      key<V>({"branches", "list of { g, k, tau }", "", "from g, k and tau",
              "The branches one by one, in place of the lists g, k and tau; k may be left out."},
             read_branches),
      key<V>(
          {"g", "list of numbers > 0", "", "required without branches",
           "Share of each branch in the moduli that relax; all sum to less than 1 for instantaneous moduli."},
          [](const SceneNode& node, V& v) { v.g = read_numbers(node); }),
      key<V>(
          {"k", "list of numbers >= 0", "", "none",
           "Share of each branch in the bulk modulus, by which the pressure relaxes; not for the formulation "
           "whole."},
          [](const SceneNode& node, V& v) { v.k = read_numbers(node); }),
      key<V>(
          {"tau", "list of numbers > 0", "s", "required without branches", "Relaxation time of each branch."},
          [](const SceneNode& node, V& v) { v.tau = read_numbers(node); }),
      choice_key("moduli", &V::moduli,
                 "The moduli that the constants of the law describe: under a sudden load, or after a long "
                 "time; g are fractions of these moduli."),
      choice_key(
          "formulation", &V::formulation,
          "What relaxes: the isochoric stress as in Abaqus (simo) or in FEBio's uncoupled viscoelastic "
          "(iso), or the whole stress as in FEBio's viscoelastic (whole)."),
  };
}

void read_viscoelastic(const SceneNode& node, MaterialDescription& material) {
  ViscoelasticDescription& viscoelastic = material.viscoelastic.emplace();
  viscoelastic.place = node.place();
  read_table(node, viscoelastic_keys(), viscoelastic);
  if (node.has("branches") && (node.has("g") || node.has("k") || node.has("tau")))
    node.child("branches").fail_with("give either branches or the lists g, k and tau");
}

Keys<MullinsDescription> mullins_keys() {
  using M = MullinsDescription;
  return {
      number_key("r", &M::r, "", any_number, "> 1: at most 1/r of the isochoric stress is lost."),
      number_key("m", &M::m, "J/m^3", any_number,
                 "Energy density over which the stress is lost: the smaller, the sooner."),
      number_key("beta", &M::beta, "", any_number, "Share of the largest energy density, which adds to m.")};
}

void read_mullins(const SceneNode& node, MaterialDescription& material) {
  MullinsDescription& mullins = material.mullins.emplace();
  mullins.place = node.place();
  read_table(node, mullins_keys(), mullins);
}

/// A material of the library brings its law and constants.
void refuse_beside_library(const SceneNode& table) {
  const LibraryMaterial& material =
      find_library_material(read_text(table.child("library")), table.place() + ".library");
  std::vector<std::string> refused = {"law", "youngs_modulus", "poissons_ratio"};
  for (const ConstantText& constant : require_law(material.law, table.place()).constants)
    refused.emplace_back(constant.name);
  for (const std::string& key : refused)
    if (table.has(key))
      table.child(key).fail_with(
          "\"" + material.name +
          "\" of the library brings its law and constants; leave this out, or give all "
          "of them without library");
}

Keys<MaterialDescription> material_keys() {
  using M = MaterialDescription;
  return {
      key<M>({"library", "text", "", "none",
              "Name of a material of the library, which brings its law, constants, density and Prony series; "
              "`resilin materials --library` lists them ([materials](materials.md#library))."},
             [](const SceneNode& node, M& m) {
               take_from_library(find_library_material(read_text(node), node.place()), m);
               if (m.viscoelastic) m.viscoelastic->place = node.place();
             }),
      choice_key("law", &M::law, law_names(), {},
                 "Constitutive model (strain energy density); `resilin materials` and [laws](laws.md) "
                 "describe each."),
      number_key("density", &M::density, "kg/m^3", not_negative,
                 "Mass per reference volume; > 0 in dynamics."),
      key<M>({"viscoelastic", "[viscoelastic](#viscoelastic)", "", "none",
              "Finite-strain viscoelasticity by a Prony series."},
             read_viscoelastic),
      key<M>({"mullins", "[mullins](#mullins)", "", "none",
              "Softening by the largest strain energy so far (Mullins effect)."},
             read_mullins),
  };
}

/// Constants that every law takes: the small-strain solid.
const std::vector<std::string>& small_strain_names() {
  static const std::vector<std::string> names = {"youngs_modulus", "poissons_ratio"};
  return names;
}

std::string names_of_laws_with_fibres() {
  std::vector<std::string> names;
  for (const LawInfo* law : laws())
    if (law->max_fibres > 0) names.emplace_back(law->name);
  return join(names);
}

/// Names that a law takes besides `law` and `density`.
std::vector<std::string> constant_names(const LawInfo& law) {
  std::vector<std::string> names = small_strain_names();
  for (const ConstantText& constant : law.constants) names.emplace_back(constant.name);
  return names;
}

const CellBlock& solid_cells(const SceneNode& node, const Mesh& mesh) {
  const CellBlock* block = mesh.find_solid(node.context->dimension);
  if (block == nullptr)
    node.fail_with("values for each cell need a mesh with cells; is the key \"mesh\" of the body there?");
  return *block;
}

/// A CSV file, a list or an array of one number for each cell.
std::vector<double> read_cell_values(const SceneNode& node, const Mesh& mesh) {
  return read_rows(node, static_cast<std::size_t>(solid_cells(node, mesh).num_cells()), 1, "cell").values;
}

std::vector<double> read_cell_field(const SceneNode& node, const Mesh& mesh) {
  const std::string name = read_text(node);
  const CellBlock& cells = solid_cells(node, mesh);
  std::vector<std::string> names;
  for (const CellField& field : mesh.cell_fields) {
    if (&mesh.blocks[field.block] != &cells) continue;
    if (field.name == name) return field.values;
    names.push_back(field.name);
  }
  node.fail(names.empty() ? "a field of the mesh's cells; the mesh has none"
                          : "a field of the mesh's cells: " + join(names),
            "give the values in a file: { file = \"values.csv\" }");
}

/// A number, a list of one for each cell, { file = "young.csv" } or { cell_field = "name" }.
void read_constant(const SceneNode& node, const std::string& name, const Mesh& mesh,
                   MaterialDescription& material) {
  if (node.value->is_array() || std::holds_alternative<SceneValue::Numbers>(node.value->data)) {
    material.cell_constants[name] = read_cell_values(node, mesh);
    return;
  }
  if (!node.value->is_table()) {
    material.constants[name] = read_number(node);
    return;
  }
  refuse_unknown_keys(node, {"file", "cell_field"});
  if (node.value->table().size() != 1) node.fail("a number, { file = ... } or { cell_field = ... }");
  material.cell_constants[name] = node.has("file") ? read_cell_values(node.child("file"), mesh)
                                                   : read_cell_field(node.child("cell_field"), mesh);
}

/// A direction, a list or an array of one for each cell, or { file = "fibres.csv" }. In 2D a third number is
/// the component across the plane.
std::vector<Vector3> read_directions(const SceneNode& node, const Mesh& mesh) {
  const bool is_list = node.value->is_array() && !node.value->array().empty();
  const auto has_three = [](const SceneValue& value) {
    return value.is_array() && value.array().size() == 3;
  };
  if (is_list && !node.value->array().front().is_array()) {
    if (!has_three(*node.value)) return {read_vector(node)};
    Vector3 direction;
    for (std::size_t i = 0; i < 3; ++i)
      direction[static_cast<Eigen::Index>(i)] = read_number(node.element(i));
    return {direction};
  }
  if (node.value->is_table()) refuse_unknown_keys(node, {"file"});
  const SceneNode rows = node.value->is_table() ? node.child("file") : node;
  const bool has_across = is_list && std::ranges::all_of(node.value->array(), has_three);
  const std::size_t dim = has_across ? 3 : static_cast<std::size_t>(node.context->dimension);
  const NumberTable table =
      read_rows(rows, static_cast<std::size_t>(solid_cells(node, mesh).num_cells()), dim, "cell");
  std::vector<Vector3> directions(table.num_rows(), Vector3::Zero());
  for (std::size_t i = 0; i < table.values.size(); ++i)
    directions[i / dim][static_cast<Eigen::Index>(i % dim)] = table.values[i];
  return directions;
}

void read_fibres(const SceneNode& node, const Mesh& mesh, MaterialDescription& material) {
  expect_list(node, "directions, one for each family of fibres");
  for (std::size_t i = 0; i < node.value->array().size(); ++i)
    material.fibres.push_back(read_directions(node.element(i), mesh));
}

/// Constants and fibres of a law, from their table. The small-strain solid that `material` has is replaced by
/// the formula's own constants where those are given.
void read_law(const SceneNode& node, const Mesh& mesh, const LawInfo& law, MaterialDescription& material) {
  if (!std::isnan(law.only_poissons_ratio)) material.constants["poissons_ratio"] = law.only_poissons_ratio;
  if (node.has("fibres")) read_fibres(node.child("fibres"), mesh, material);
  const auto is_given = [&node](const ConstantText& constant) {
    return !constant.is_free && node.has(std::string(constant.name));
  };
  if (std::ranges::any_of(law.constants, is_given)) material.constants.clear();
  for (const std::string& name : constant_names(law)) {
    if (!node.has(name)) continue;
    material.constants.erase(name);
    read_constant(node.child(name), name, mesh, material);
  }
}

/// Puts a part of a sum behind those before it.
void add_part(const LawInfo& law, const std::string& place, std::size_t number, MaterialDescription part,
              MaterialDescription& material) {
  const auto most = static_cast<std::size_t>(law.max_fibres);
  if (part.fibres.size() > most || (most > 0 && part.fibres.empty()))
    throw InputError(place + ".fibres",
                     most == 0 ? "nothing: " + std::string(law.name) + " has no fibres"
                               : "1 to " + std::to_string(most) + " families of directions",
                     part.fibres.empty() ? "none" : std::to_string(part.fibres.size()) + " families");
  part.fibres.resize(most);  // an empty one is absent
  for (const auto& [name, value] : part.constants) material.constants[sum_constant(number, name)] = value;
  for (auto& [name, values] : part.cell_constants)
    material.cell_constants[sum_constant(number, name)] = std::move(values);
  for (auto& directions : part.fibres) material.fibres.push_back(std::move(directions));
}

void read_sum(const SceneNode& node, const Mesh& mesh, MaterialDescription& material) {
  expect_list(node, "tables { law, ... }, the parts of the sum");
  const std::size_t count = node.value->array().size();
  if (count < 2 || count > most_in_sum)
    node.fail("2 to " + std::to_string(most_in_sum) + " tables { law, ... }", "for one law leave sum out");
  material.constants.clear();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    const SceneNode entry = node.element(i);
    expect_table(entry);
    if (!entry.has("law")) entry.fail_with("a part of a sum needs its law");
    names.push_back(read_choice(entry.child("law"), law_names()));
    const LawInfo& law = require_law(names.back(), entry.place() + ".law");
    if (law.is_quadratic)
      entry.child("law").fail("a law for large strain", "take saint_venant_kirchhoff or corotated");
    std::vector<std::string> known = constant_names(law);
    known.insert(known.end(), {"law", "fibres"});
    refuse_unknown_keys(entry, known);
    MaterialDescription part;
    part.constants.clear();
    const bool is_hooke = entry.has("youngs_modulus");
    read_law(entry, mesh, law, part);
    if (!is_hooke && !entry.has("poissons_ratio")) part.constants.erase("poissons_ratio");
    add_part(law, entry.place(), i, std::move(part), material);
  }
  material.law = sum_name(names);
}

Keys<MaterialDescription> sum_keys() {
  using M = MaterialDescription;
  return {
      key<M>({"sum", "list of tables { law, ... }", "", "none",
              "A sum of laws in place of one: each table has a `law`, its constants and its `fibres`. Moduli "
              "may be "
              "zero or left out ([materials](materials.md#sums-of-models))."},
             [](const SceneNode&, M&) {}),
  };
}

}  // namespace

void read_material(const SceneNode& node, const Mesh& mesh, MaterialDescription& material) {
  expect_table(node);
  material.place = node.place();
  if (node.has("sum")) {
    for (const char* key : {"law", "fibres"})
      if (node.has(key)) node.child(key).fail_with("stands in the tables of sum; leave it out here");
    if (node.has("library"))
      node.child("library").fail_with("brings its law and constants; leave it or sum out");
    read_table(node, material_keys(), material, {"sum"});
    return read_sum(node.child("sum"), mesh, material);
  }
  if (node.has("library")) {
    refuse_beside_library(node);
    material.law = find_library_material(read_text(node.child("library")), node.place()).law;
  }
  if (node.has("law")) material.law = read_choice(node.child("law"), law_names());
  const LawInfo& law = require_law(material.law, node.place() + ".law");
  std::vector<std::string> known = constant_names(law);
  known.insert(known.end(), {"fibres", "sum"});
  read_table(node, material_keys(), material, known);
  read_law(node, mesh, law, material);
}

TableDoc viscoelastic_doc() {
  return document(
      "viscoelastic",
      "Prony series of a material: stress relaxes by 1 - sum_i g_i (1 - exp(-t / tau_i)) "
      "([materials](materials.md#viscoelasticity)). The pressure relaxes by k in the same way, in the "
      "formulation whole by g. In a static analysis the time is the load factor times `simulation.end_time`.",
      viscoelastic_keys());
}

TableDoc mullins_doc() {
  return document("mullins",
                  "Mullins softening of a material (Ogden-Roxburgh): below the largest isochoric energy "
                  "density W_max of a "
                  "point its stress is 1 - erf((W_max - W) / (m + beta W_max)) / r times that of the law "
                  "([materials](materials.md#mullins-softening)). One of m and beta is above zero.",
                  mullins_keys());
}

TableDoc material_doc() {
  const MaterialDescription defaults;
  TableDoc doc = document(
      "material",
      "Young's modulus and Poisson's ratio describe the small-strain response; each law converts them to its "
      "own constants. "
      "Alternatively give the constants of a law's formula by name; [laws](laws.md) says which may be "
      "left out and which may be given beside Young's modulus. "
      "A constant may vary from cell to "
      "cell: a list, or `{ file = \"young.csv\" }`, with one number for each cell, or `{ "
      "cell_field = \"name\" }` of the mesh.",
      material_keys());
  const auto add = [&](const char* name, const char* type, const char* unit, const char* text) {
    doc.keys.push_back({name, type, unit, default_text(defaults.constants.at(name)), text});
  };
  const TableDoc sum = document("sum", "", sum_keys());
  doc.keys.insert(doc.keys.begin() + 1, sum.keys.front());
  add("youngs_modulus", "number > 0", "Pa", "Young's modulus at small strain.");
  add("poissons_ratio", "number > -1 and < 0.5", "", "Poisson's ratio at small strain.");
  doc.keys.push_back({"fibres", "list of directions", "", "",
                      "For " + names_of_laws_with_fibres() +
                          ": a reference direction for each fibre family (in 2D a third number is the "
                          "component across the plane), or `{ file = \"fibres.csv\" }` or "
                          "a list with one for each cell; they rotate with the body's rotate."});
  for (const LawInfo* law : laws()) {
    for (const ConstantText& constant : law->constants) {
      const std::string name(constant.name);
      const auto known = std::ranges::find(doc.keys, name, &KeyDoc::name);
      if (known == doc.keys.end()) {
        ConstantText pure = constant;
        pure.unit = "";
        doc.keys.push_back(
            {name, range_text(pure), std::string(constant.unit), "", "Of " + std::string(law->name) + "."});
      } else {
        known->text.insert(known->text.size() - 1, ", " + std::string(law->name));
      }
    }
  }
  return doc;
}

}  // namespace resilin
