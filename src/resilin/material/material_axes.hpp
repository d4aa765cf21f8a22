#pragma once

#include <span>

#include "resilin/core/types.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

/// Whether a law that takes two material axes gets parallel ones, which do not name the third.
/// @param directions  unit vectors of all families of the law; a family that is absent is zero
bool has_parallel_axes(const LawInfo& law, std::span<const Vector3> directions);

inline constexpr const char* axes_expected = "two axes in different directions";
inline constexpr const char* axes_cure = "leave the second out, or turn it";

}  // namespace resilin
