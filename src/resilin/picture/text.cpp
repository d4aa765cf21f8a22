#include "resilin/picture/text.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "resilin/picture/font_bytes.hpp"

namespace resilin {
namespace {

/// Takes the next character off the front; text comes from us or from names in files, so that a broken
/// sequence is passed over as one odd character.
std::uint32_t next_character(std::string_view& text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length == 1 || text.size() < length) {
    text.remove_prefix(1);
    return first;
  }
  std::uint32_t code = first & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  text.remove_prefix(length);
  return code;
}

void check(FT_Error error) {
  if (error != 0) throw std::runtime_error("FreeType: error " + std::to_string(error));
}

constexpr double unit = 64;  // FreeType counts in 1/64 pixel

}  // namespace

struct TextPen::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;

  explicit Face(double size) {
    check(FT_Init_FreeType(&library));
    const std::span<const unsigned char> font = font_bytes();
    check(FT_New_Memory_Face(library, font.data(), static_cast<FT_Long>(font.size()), 0, &face));
    check(FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(size * unit)), 72, 72));
  }
  ~Face() {
    FT_Done_Face(face);
    FT_Done_FreeType(library);
  }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;

  /// The glyph of the next character; false when the text is at its end.
  bool load(std::string_view& text, FT_Int32 flags) const {
    if (text.empty()) return false;
    check(FT_Load_Char(face, next_character(text), FT_LOAD_NO_HINTING | flags));
    return true;
  }
};

TextPen::TextPen(double size) : face_(std::make_unique<Face>(size)) {}
TextPen::~TextPen() = default;

double TextPen::width(std::string_view text) const {
  double width = 0;
  while (face_->load(text, FT_LOAD_DEFAULT))
    width += static_cast<double>(face_->face->glyph->advance.x) / unit;
  return width;
}

double TextPen::digit_height() const {
  std::string_view digit = "0";
  face_->load(digit, FT_LOAD_DEFAULT);
  return static_cast<double>(face_->face->glyph->metrics.horiBearingY) / unit;
}

void TextPen::draw(Image& image, double x, double y, std::string_view text, Color color) const {
  const FT_GlyphSlot glyph = face_->face->glyph;
  while (!text.empty()) {
    // The fraction of a pixel moves the outline, so that letters stand evenly.
    FT_Vector shift = {static_cast<FT_Pos>((x - std::floor(x)) * unit), 0};
    FT_Set_Transform(face_->face, nullptr, &shift);
    face_->load(text, FT_LOAD_RENDER);
    const int left = static_cast<int>(std::floor(x)) + glyph->bitmap_left;
    const int top = static_cast<int>(std::lround(y)) - glyph->bitmap_top;
    for (int row = 0; row < static_cast<int>(glyph->bitmap.rows); ++row)
      for (int column = 0; column < static_cast<int>(glyph->bitmap.width); ++column) {
        const int px = left + column, py = top + row;
        if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
        const unsigned char coverage = glyph->bitmap.buffer[row * glyph->bitmap.pitch + column];
        image.at(px, py) = mix(image.at(px, py), color, coverage / 255.0);
      }
    x += static_cast<double>(glyph->advance.x) / unit;
  }
  FT_Set_Transform(face_->face, nullptr, nullptr);
}

}  // namespace resilin
