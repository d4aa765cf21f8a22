#pragma once

#include "resilin/picture/picture.hpp"

namespace resilin {

/// @throws InputError  for options that no picture can have, whatever it shows
void check_picture(const PictureOptions& options);

}  // namespace resilin
