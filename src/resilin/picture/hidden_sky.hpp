#pragma once

#include <vector>

namespace resilin {

/// For each pixel the share of the sky above its surface that what is around it hides, 0 to 1: along twelve
/// directions the steepest rise above the plane of the surface, seen in parallel projection. What lies beyond
/// `radius` hides nothing.
///
/// Source: Bavoil, Sainz & Dimitrov 2008, "Image-space horizon-based ambient occlusion".
/// @param depths  towards the eye [pixels], row by row; minus infinity where nothing is
/// @param radius  [pixels]
std::vector<float> hidden_sky(const std::vector<float>& depths, int width, int height, double radius);

}  // namespace resilin
