#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resilin/fields/scalar_field.hpp"
#include "resilin/view/shown_surface.hpp"
#include "resilin/world/shown_colliders.hpp"

namespace resilin {

/// Data that a page receives before the first frame, besides the world and its surface.
struct ViewHeader {
  std::string title;
  std::string version;                     ///< version of the program
  Vector3 up = Vector3::UnitZ();           ///< in 2D always y
  Vector3 gravity = Vector3::Zero();       ///< [m/s^2]
  std::optional<double> ground{};          ///< height of a ground plane along `up`, to be drawn [m]
  std::vector<ScalarField> fields{};       ///< fields of frames, in their order
  std::vector<ShownCollider> colliders{};  ///< to be drawn, but for that ground
};

/// About how large a field's values are where they mean something: the extent of the bodies, the speed of
/// waves in them, their stiffness, 1 for ratios. Differences far below are rounding.
double field_scale(const FieldInfo& field, const World& world);

/// Fields as the page reads them, a list of objects (docs/view_protocol.md, "Header").
std::string encode_fields(std::span<const ScalarField> fields, const World& world);
/// One of them.
std::string encode_field_info(const ScalarField& field, const World& world);

/// The keys that the headers of live scenes and recordings share, as one object of JSON
/// (docs/view_protocol.md, "Header").
std::string encode_header(const ViewHeader& header, const World& world, const ShownSurface& surface);

}  // namespace resilin
