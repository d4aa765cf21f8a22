#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A straight line in the reference configuration, projected onto the nearest surface of the bodies: a leak
/// path, or a section through a contact.
struct SurfaceLine {
  int dimension = 3;                                     ///< 2 or 3: that of the scene
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();  ///< ends, in the scene's coordinates [m]
  std::string body;                                      ///< its name; empty: whichever is nearest
  int num_points = 201;                                  ///< evenly spaced, both ends included
};

/// Values of a field along such a line, of frames of a run.
struct LineValues {
  std::vector<double> distances;            ///< from the first end, in the reference configuration [m]
  std::vector<std::vector<double>> frames;  ///< by frame: one number per point
};

/// Values of fields on the vertices, of all frames or of one. Between vertices they are linear.
/// @param folder  of a run that has left frames and its scene
/// @param field   "contact_pressure", "displacement.z", "nodal_von_mises", ...
/// @param frame   its number, -1 for the last; none: all
/// @throws InputError  for a folder without them, a field that has no value at vertices, an unknown body, a
///                     line of another dimension
LineValues values_along(const std::filesystem::path& folder, const SurfaceLine& line,
                        const std::string& field, std::optional<int> frame = std::nullopt);

}  // namespace resilin
