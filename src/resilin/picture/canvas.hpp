#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/picture/image.hpp"

namespace resilin {

/// A corner of a triangle on the canvas.
struct CanvasVertex {
  Vector3 place;  ///< x to the right, y down [pixels]; z towards the eye [pixels]
  double value;   ///< value of the colour
  double light;   ///< 0 to 1
};

/// Look of a line over the picture behind it.
struct Ink {
  Color color;
  double opacity;
};

/// Draws triangles and lines with a depth buffer, several samples for each pixel in both directions.
///
/// Draw triangles first: lines lie over them where they are not hidden.
class Canvas {
 public:
  /// Colour of a place by value and light.
  using Shader = std::function<Color(double value, double light)>;

  /// @param other  what is drawn is drawn over this background, too
  Canvas(int width, int height, Color background, std::optional<Color> other = {});

  void triangle(const std::array<CanvasVertex, 3>& corners, const Shader& shader);

  /// Darkens what was drawn so far where it lies in hollows, and where bodies meet: little of the sky is seen
  /// from there (ambient occlusion by the depths around each pixel).
  /// @param radius    how far around is looked [pixels]
  /// @param strength  1: where nothing of the sky is seen it is black
  void darken_hollows(double radius, double strength);

  /// Colour and opacity of a place of a veil.
  struct VeilShade {
    Color color;
    double opacity;
  };
  /// By place [pixels], z towards the eye, and light.
  using VeilShader = std::function<VeilShade(const Vector3& place, double light)>;

  /// A triangle through which what lies behind it is seen; it hides nothing.
  void veil(const std::array<CanvasVertex, 3>& corners, const VeilShader& shader);

  /// @param lift  how far towards the eye the line is thought, so that it shows on its own surface [pixels]
  void line(const Vector3& from, const Vector3& to, double width, double lift, const Ink& ink);

  /// The mean of each pixel's samples.
  Image image() const { return image_of(colors_); }
  Image image_over_other() const { return image_of(others_); }

 private:
  static constexpr int samples = 3;  // for each pixel, along each side
  std::size_t offset(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  /// Calls `visit(sample, depth, value, light)` where nothing nearer is.
  template <class Visit>
  void for_each_sample(const std::array<CanvasVertex, 3>& corners, const Visit& visit) const;
  void stamp(const Vector3& middle, double radius, double depth, const Ink& ink);
  void mix_in(std::size_t sample, Color color, double opacity);
  Image image_of(const std::vector<Color>& colors) const;

  int columns_, rows_;  ///< columns and rows of samples
  std::vector<Color> colors_,
      others_;  ///< colors and others of the samples; over the other background, where there is one
  std::vector<float> depths_;
  std::vector<std::uint32_t> last_line_;  ///< last line that touched the sample: each inks it once
  std::uint32_t num_lines_ = 0;
};

}  // namespace resilin
