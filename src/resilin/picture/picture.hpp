#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "resilin/io/vtu.hpp"
#include "resilin/picture/image.hpp"

namespace resilin {

/// The name that stands for no field: bodies have colours of their own.
inline constexpr const char* no_field = "none";

/// Content and look of a picture. The same frame and options give the same bits.
struct PictureOptions {
  std::string field;               ///< as for `pick_field`; empty or `no_field`: the bodies alone
  std::string label;               ///< title of the colour bar; empty: the field's name and component
  std::string unit;                ///< unit of the field: "Pa"
  int width = 1200, height = 900;  ///< [pixels]
  std::optional<std::array<double, 2>> range;  ///< range of the colours; default: that of the field
  std::string map = "auto";                    ///< a colour map; auto: diverging for two signs
  std::string view = "auto";                   ///< see `make_camera`; auto: `telling_direction`
  std::string up = "auto";                     ///< axis that points up; auto: `vertical`
  Vector3 vertical = Vector3::UnitZ();         ///< against gravity
  double scale = 1;                            ///< factor on displacements
  std::string edges = "auto";                  ///< edges of cells: "auto" (where there is room), "on", "off"
  bool shows_rest = false;                     ///< outline of the rest shape
  bool shows_colliders = true;                 ///< the part of them near the bodies
  bool is_dark = false;                        ///< background
  bool is_transparent = false;                 ///< background; `is_dark` says what it is to be put on
  bool shows_bar = true;                       ///< for the colours of the field
  bool shows_caption = true;
  std::string caption;  ///< in the corner; empty: the moment, or the mode, of what a run has left
  /// Least and greatest value of the field, where they are not those of the frame.
  std::optional<std::array<double, 2>> extremes;
  std::optional<std::array<Vector3, 2>> reach;  ///< corners of the box that is framed; default: what is drawn
  double smallest_range = 0;  ///< smallest range of the colours: what differs less is rounding
  bool has_skins = false;     ///< triangles of the frame are surfaces in space, to be drawn
};

/// Draws a frame: the deformed body, shaded and coloured, with a colour bar and the axes. Colliders are
/// drawn as veils through which bodies are seen, with the shadows of bodies on them; in 2D as lines. Without
/// a field each body has its colour, by the cell data "body" of the frame.
///
/// The points of the frame are at their deformed places; `scale` and the rest shape need its `displacement`.
/// @param colliders  triangles, lines and points
/// @throws InputError  for a field that the frame has not, a size out of bounds, a frame without cells
Image draw_picture(const VtuContent& frame, const PictureOptions& options, const Mesh& colliders = {});

}  // namespace resilin
