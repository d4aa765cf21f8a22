#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/fit/field_prior.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// The measured quantity.
enum class MeasuredKind {
  markers,   ///< displacements of points [m]
  reaction,  ///< the force of a support or a collider on the bodies [N]
  probe,     ///< the displacement of a probe [m]
  section,   ///< the force through a section [N]
  moment,    ///< its moment about the middle of the cut [N m]
  energy,    ///< energy of a body, or of all [J]
  volume,    ///< volume of a body [m^3]
  stress,    ///< a component of Cauchy's stress at points of a body [Pa]
};
constexpr std::array<std::string_view, 8> spellings(MeasuredKind) {
  return {"markers", "reaction", "probe", "section", "moment", "energy", "volume", "stress"};
}
/// Whether each row has a place in the rest shape of a body.
constexpr bool has_places(MeasuredKind kind) {
  return kind == MeasuredKind::markers || kind == MeasuredKind::stress;
}
/// Whether it is one number, no vector.
constexpr bool is_number(MeasuredKind kind) {
  return kind == MeasuredKind::energy || kind == MeasuredKind::volume || kind == MeasuredKind::stress;
}

/// Unit in which its numbers are printed.
std::string unit_of(MeasuredKind kind);

/// Identity of a number of a table.
struct MeasuredPlace {
  std::string row;               ///< "markers.csv, row 3"
  int component = 0;             ///< 0: x
  std::optional<double> moment;  ///< load factor at rest, time in motion [s]; none: the end of the run
  Vector3 at = Vector3::Zero();  ///< place of a marker at rest, in the scene [m]
};

/// A row of a table: one vector, of which some components may be missing.
struct MeasuredRow {
  std::string place;             ///< "markers.csv, row 3"
  Vector3 at = Vector3::Zero();  ///< place of a marker at rest, in the scene [m]
  Vector3 value = Vector3::Zero();
  std::array<bool, 3> is_measured = {false, false, false};
  double sigma = 0;              ///< standard deviation of each component; 0: not known
  std::optional<double> moment;  ///< load factor at rest, time in motion [s]; none: the end of the run
};

/// Measurements of one kind in one experiment.
struct MeasuredTable {
  MeasuredKind kind = MeasuredKind::markers;
  std::string place;
  std::string of;                   ///< the body, the support, the collider, the probe or the section
  std::string what;                 ///< name of the energy or stress component
  std::optional<double> tolerance;  ///< how far outside the body a marker may be [m]; none: by rounding
  std::vector<MeasuredRow> rows;
};

/// A scene and what was measured when it was done in a laboratory.
struct SceneExperiment {
  std::string place, name;
  Description description;
  std::vector<MeasuredTable> tables;
};

/// How many numbers a constant is that a scene has, or may have, for each cell.
enum class SoughtPer {
  value,  ///< one for each different value in the scene
  group,  ///< one for each group of cells of the mesh
  cell,   ///< a field: with a prior (field_prior.hpp)
};
constexpr std::array<std::string_view, 3> spellings(SoughtPer) { return {"value", "group", "cell"}; }

/// A number of the scenes that is sought, or several where they have one for each cell.
struct SceneParameter {
  std::string place;
  std::string key;                 ///< see `find_parameter`; of a vector one component: "load.tip.value.x"
  std::vector<std::string> names;  ///< in reports; empty: from the key
  std::vector<double> start;       ///< empty: as the scene has it
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  std::string experiment;  ///< the only one that has it; empty: all have
  SoughtPer per = SoughtPer::value;
};

/// Choice of the prior's weight without a given number.
enum class StrengthRule {
  l_curve,      ///< the corner of the L-curve
  discrepancy,  ///< the misfit that the sigmas expect
};
constexpr std::array<std::string_view, 2> spellings(StrengthRule) { return {"l_curve", "discrepancy"}; }

/// Penalty on fields of material constants.
struct Regularisation {
  std::string place = "fit.regularise";
  PriorKind kind = PriorKind::smooth;
  StrengthRule rule = StrengthRule::l_curve;
  std::optional<double> strength;  ///< strength of the prior beside the sum of squares; none: by the rule
};

/// Input of a fit of whole scenes.
struct SceneFitDescription {
  std::string place = "fit";
  std::string title;
  std::vector<SceneExperiment> experiments;
  std::vector<SceneParameter> parameters;
  double tolerance = 1e-6;            ///< tolerance of the last step, relative to the parameters
  int max_solves = 60;                ///< maximum solves of each scene, from each start
  int starts = 1;                     ///< starts of the search
  Regularisation regularise;          ///< regularisation of fields
  std::vector<std::string> warnings;  ///< warnings of the reader
};

}  // namespace resilin
