#pragma once

#include <memory>
#include <string_view>

#include "resilin/picture/image.hpp"

namespace resilin {

/// Text in DejaVu Sans at one size.
class TextPen {
 public:
  /// @param size  height of an em [pixels]
  explicit TextPen(double size);
  ~TextPen();
  TextPen(const TextPen&) = delete;
  TextPen& operator=(const TextPen&) = delete;

  /// @param text  UTF-8
  /// @return      [pixels]
  double width(std::string_view text) const;
  double digit_height() const;

  /// Draws with the left end of the base line at (x, y); what is outside the image is left out.
  void draw(Image& image, double x, double y, std::string_view text, Color color) const;

 private:
  struct Face;
  std::unique_ptr<Face> face_;
};

}  // namespace resilin
