#pragma once

#include <string>

#include "command_line.hpp"
#include "resilin/picture/picture.hpp"

namespace resilin::cli {

/// Options that pictures and films share: viewpoint and up direction.
/// @param about_auto  what help says of it besides
void add_view_options(const Command& command, PictureOptions& picture, const std::string& about_auto = "");

/// Colours and the factor on displacements.
void add_color_options(const Command& command, PictureOptions& picture);

/// Default parts of pictures and films that the user leaves out.
struct LeftOut {
  bool no_colliders = false, no_bar = false, no_caption = false;
  void apply(PictureOptions& picture) const;
};

/// Options for the colliders, axes and background around the bodies.
void add_surroundings(const Command& command, PictureOptions& picture, LeftOut& left_out);

}  // namespace resilin::cli
