#pragma once

#include <string>
#include <utility>
#include <vector>

namespace resilin::bench {

/// Cost of drawing a body in each frame.
struct SkinTiming {
  std::string name;
  int cells = 0, vertices = 0;  ///< cells and vertices of the body; of its skin
  double outside_percent = 0;   ///< vertices that are in no cell
  double build_ms = 0;          ///< the embedding, once
  double apply_ms = 0;          ///< the vertices' places
  double smooth_apply_ms = 0;   ///< the same of the smooth variant
  double normals_ms = 0;        ///< normals of the deformed skin
  double field_ms = 0;          ///< von Mises stress at the vertices
  double encode_ms = 0;         ///< a frame for the page, with normals and field
};

/// A ball of 26,138 vertices in a box of 5 n^3 tetrahedra and, where $RESILIN_SHARED has it, the armadillo of
/// 26,002 vertices in 627 tetrahedra. Medians of wall times on all threads [ms].
std::vector<SkinTiming> measure_skins(int n);

}  // namespace resilin::bench
