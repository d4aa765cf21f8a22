#pragma once

#include <string>
#include <string_view>

#include "resilin/world/description.hpp"

namespace resilin {

/// Exact binary image of a description with its meshes, from which the same world is made again.
std::string serialize(const Description& description);

/// The description of an image.
/// @throws InputError  naming `place`, when the image is damaged or of another version
Description deserialize_description(std::string_view image, const std::string& place);

}  // namespace resilin
