#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// What was measured.
enum class MeasuredKind {
  markers,   ///< displacements of points [m]
  reaction,  ///< the force of a support on the bodies [N]
  probe,     ///< the displacement of a probe [m]
};
constexpr std::array<std::string_view, 3> spellings(MeasuredKind) { return {"markers", "reaction", "probe"}; }

/// A row of a table: one vector, of which some components may be missing.
struct MeasuredRow {
  std::string place;             ///< "markers.csv, row 3"
  Vector3 at = Vector3::Zero();  ///< of a marker: where it is at rest, in the scene [m]
  Vector3 value = Vector3::Zero();
  std::array<bool, 3> is_measured = {false, false, false};
  double sigma = 0;              ///< standard deviation of each component; 0: not known
  std::optional<double> moment;  ///< load factor at rest, time in motion [s]; none: the end of the run
};

struct MeasuredTable {
  MeasuredKind kind = MeasuredKind::markers;
  std::string place;
  std::string of;                   ///< the body, the support or the probe
  std::optional<double> tolerance;  ///< how far outside the body a marker may be [m]; none: by rounding
  std::vector<MeasuredRow> rows;
};

/// A scene and what was measured when it was done in a laboratory.
struct SceneExperiment {
  std::string place, name;
  Description description;
  std::vector<MeasuredTable> tables;
};

/// A number of the scenes that is sought, or several where they have one for each cell: one for each value.
struct SceneParameter {
  std::string place;
  std::string key;                 ///< see `find_parameter`; of a vector one component: "load.tip.value.x"
  std::vector<std::string> names;  ///< in reports; empty: from the key
  std::vector<double> start;       ///< empty: as the scene has it
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  std::string experiment;  ///< the only one that has it; empty: all have
};

/// What is asked for where whole scenes are fitted.
struct SceneFitDescription {
  std::string place = "fit";
  std::string title;
  std::vector<SceneExperiment> experiments;
  std::vector<SceneParameter> parameters;
  double tolerance = 1e-6;            ///< of the last step, relative to the parameters
  int max_solves = 60;                ///< of each scene
  std::vector<std::string> warnings;  ///< of the reader
};

}  // namespace resilin
