#pragma once

#include <string>

#include "command_line.hpp"
#include "resilin/picture/picture.hpp"

namespace resilin::cli {

/// What pictures and films are told alike: from where, and which way is up.
/// @param about_auto  what help says of it besides
void add_view_options(const Command& command, PictureOptions& picture, const std::string& about_auto = "");

/// Colours and the factor on displacements.
void add_color_options(const Command& command, PictureOptions& picture);

/// What pictures and films have unless it is asked that they have it not.
struct LeftOut {
  bool no_colliders = false, no_bar = false, no_caption = false;
  void apply(PictureOptions& picture) const;
};

/// What is drawn besides the bodies, and on what.
void add_surroundings(const Command& command, PictureOptions& picture, LeftOut& left_out);

}  // namespace resilin::cli
