#include "resilin/fit/measurement_table.hpp"

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/marker_table.hpp"
#include "resilin/sensitivity/measured_number.hpp"
#include "resilin/sensitivity/stress_at_place.hpp"

namespace resilin {
namespace {

/// A table of measurements as it is written.
struct RawMeasurements {
  std::string of, what = "elastic";
  std::string file;
  NumberTable table, at, displacement;
  std::optional<Vector3> value;
  std::optional<double> sigma, tolerance;
};

using Raw = RawMeasurements;

Key<Raw> file_key(const char* columns) {
  return key<Raw>({"file", "text", "", "required",
                   std::string("A CSV file whose first line names its columns: ") + columns},
                  [](const SceneNode& node, Raw& raw) {
                    raw.file = read_text(node);
                    raw.table = read_csv(read_path(node));
                  });
}

Key<Raw> not_required(Key<Raw> key) {
  key.doc.default_text = "none";
  key.is_required = false;
  return key;
}

Key<Raw> sigma_key(const char* unit) {
  return key<Raw>({"sigma", "number > 0", unit, "none",
                   "Standard deviation of each number, unless the file has a column for it. Without any it "
                   "is estimated from the residuals."},
                  [](const SceneNode& node, Raw& raw) { raw.sigma = read_number(node, positive); });
}

Key<Raw> rows_key(const char* name, NumberTable Raw::* member, const char* text) {
  return key<Raw>({name, "list of vectors", "m", "a file", text}, [member](const SceneNode& node, Raw& raw) {
    const auto* numbers = std::get_if<SceneValue::Numbers>(&node.value->data);
    if (numbers == nullptr) expect_list(node, "vectors");
    raw.*member = read_rows(node, numbers ? (*numbers)->num_rows() : node.value->array().size(),
                            static_cast<std::size_t>(node.context->dimension), "marker");
  });
}

Keys<Raw> marker_keys() {
  return {
      not_required(file_key(
          "X, Y, Z (reference positions, in 2D without Z) and ux, uy, uz (displacements) or x, y, z "
          "(deformed positions), and sigma, load (the load factor in statics), time (in dynamics), id. Leave "
          "out components that were not measured; without load and time the end of the run counts.")),
      rows_key("at", &Raw::at, "In place of a file: reference positions of the markers ..."),
      rows_key("displacement", &Raw::displacement, "... and their displacements at the end of the run."),
      sigma_key("m"),
      text_key("of", &Raw::of, "the only body", "The body with the markers."),
      key<Raw>({"tolerance", "number >= 0", "m", "rounding",
                "Largest distance of a marker outside the mesh; it then follows the nearest cell."},
               [](const SceneNode& node, Raw& raw) { raw.tolerance = read_number(node, not_negative); }),
  };
}

Key<Raw> of_key(const char* text) {
  return key<Raw>({"of", "text", "", "required", text},
                  [](const SceneNode& node, Raw& raw) { raw.of = read_text(node); });
}

/// One vector or number, or a file of them.
Keys<Raw> value_keys(Key<Raw> of, MeasuredKind kind, const char* columns) {
  const std::string unit = unit_of(kind);
  const char* type = is_number(kind)                ? "number"
                     : kind == MeasuredKind::moment ? "vector, in 2D a number"
                                                    : "vector";
  return {
      std::move(of),
      not_required(file_key(columns)),
      key<Raw>({"value", type, unit, "none", "Value at the end of the run, in place of a file."},
               [kind](const SceneNode& node, Raw& raw) {
                 if (is_number(kind))
                   raw.value = Vector3(read_number(node), 0, 0);
                 else if (kind == MeasuredKind::moment && node.context->dimension == 2)
                   raw.value = Vector3(0, 0, read_number(node));
                 else
                   raw.value = read_vector(node);
               }),
      sigma_key(unit.c_str()),
  };
}

Keys<Raw> keys_of(MeasuredKind kind) {
  switch (kind) {
    case MeasuredKind::markers:
      return marker_keys();
    case MeasuredKind::reaction:
      return value_keys(of_key("Name of the boundary condition or collider."), kind,
                        "fx, fy, fz, and sigma, load, time.");
    case MeasuredKind::section:
      return value_keys(of_key("Name of the section: the force of the side beyond it on the side below."),
                        kind, "fx, fy, fz, and sigma, load, time.");
    case MeasuredKind::moment:
      return value_keys(of_key("Name of the section: the moment about the centroid of the cut."), kind,
                        "mx, my, mz (in 2D mz), and sigma, load, time.");
    case MeasuredKind::energy: {
      Keys<Raw> keys = value_keys(text_key("of", &Raw::of, "all bodies", "Name of the body."), kind,
                                  "energy, and sigma, load, time.");
      keys.push_back(
          key<Raw>({"kind", one_of(energy_kinds()), "", "\"elastic\"", "Which energy."},
                   [](const SceneNode& node, Raw& raw) { raw.what = read_choice(node, energy_kinds()); }));
      return keys;
    }
    case MeasuredKind::volume:
      return value_keys(text_key("of", &Raw::of, "the only body", "Name of the body."), kind,
                        "volume, and sigma, load, time.");
    case MeasuredKind::stress:
      return {
          file_key("X, Y, Z (reference positions, in 2D without Z), stress, and sigma, load, time."),
          sigma_key("Pa"),
          text_key("of", &Raw::of, "the only body", "Name of the body."),
          key<Raw>(
              {"component", one_of(stress_components()), "", "required",
               "Component of the Cauchy stress in the cell that contains the point."},
              [](const SceneNode& node, Raw& raw) { raw.what = read_choice(node, stress_components()); }),
      };
    case MeasuredKind::probe:
      break;
  }
  return value_keys(of_key("Name of the probe."), kind, "ux, uy, uz, and sigma, load, time.");
}

/// The table that `at` and `displacement` are.
void take_rows(const SceneNode& node, Raw& raw) {
  if (!raw.file.empty())
    throw InputError(node.place(), "a file, or at and displacement", "both", "leave one of them out");
  const std::size_t rows = raw.at.num_rows(), dim = static_cast<std::size_t>(node.context->dimension);
  if (raw.displacement.num_rows() != rows)
    throw InputError(node.place() + ".displacement", "as many as in \"at\", " + std::to_string(rows),
                     std::to_string(raw.displacement.num_rows()));
  raw.file = "at, displacement";
  raw.table.num_columns = 2 * dim;
  for (std::size_t i = 0; i < dim; ++i) raw.table.column_names.emplace_back(1, "XYZ"[i]);
  for (std::size_t i = 0; i < dim; ++i) raw.table.column_names.push_back(std::string("u") + "xyz"[i]);
  for (std::size_t r = 0; r < rows; ++r)
    for (const NumberTable* part : {&raw.at, &raw.displacement})
      raw.table.values.insert(raw.table.values.end(),
                              part->values.begin() + static_cast<std::ptrdiff_t>(r * dim),
                              part->values.begin() + static_cast<std::ptrdiff_t>((r + 1) * dim));
}

}  // namespace

MeasuredTable read_measurements(const SceneNode& node, MeasuredKind kind) {
  Raw raw;
  read_table(node, keys_of(kind), raw);
  MeasuredTable table;
  table.kind = kind;
  table.place = node.place();
  table.of = raw.of;
  table.what = raw.what;
  table.tolerance = raw.tolerance;
  const int dim = node.context->dimension;
  if (raw.at.num_columns > 0 || raw.displacement.num_columns > 0) take_rows(node, raw);
  if (raw.file.empty() != raw.value.has_value())
    throw InputError(
        node.place(), kind == MeasuredKind::markers ? "a file, or at and displacement" : "a file or a value",
        raw.value ? "both" : "neither", raw.value ? "leave one of them out" : "add file = \"data.csv\"");
  if (raw.value) {
    MeasuredRow row;
    row.place = node.place();
    row.value = *raw.value;
    for (std::size_t i = 0; i < 3; ++i)
      row.is_measured[i] = is_number(kind)                            ? i == 0
                           : kind == MeasuredKind::moment && dim == 2 ? i == 2
                                                                      : i < static_cast<std::size_t>(dim);
    table.rows.push_back(row);
  } else {
    table.rows = measured_rows(kind, raw.table, dim, node.context->is_dynamic, raw.file, node.place());
  }
  for (MeasuredRow& row : table.rows) {
    if (raw.sigma && row.sigma > 0)
      throw InputError(node.place() + ".sigma", "a number or a column", "both", "leave one of them out");
    if (raw.sigma) row.sigma = *raw.sigma;
  }
  return table;
}

std::vector<TableDoc> measurement_docs() {
  std::vector<TableDoc> docs;
  const auto add = [&](MeasuredKind kind, const char* text) {
    docs.push_back(document("experiment." + spelling(kind), text, keys_of(kind)));
  };
  add(MeasuredKind::markers, "Points of a body.");
  add(MeasuredKind::reaction, "Force of a boundary condition or a collider.");
  add(MeasuredKind::probe, "Displacement of a probe of the scene.");
  add(MeasuredKind::section, "Force through a section of the scene.");
  add(MeasuredKind::moment, "The same cut.");
  add(MeasuredKind::energy, "A sum over bodies.");
  add(MeasuredKind::volume, "That of a body.");
  add(MeasuredKind::stress, "Points of a body.");
  return docs;
}

}  // namespace resilin
