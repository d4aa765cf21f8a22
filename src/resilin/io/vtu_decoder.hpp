#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/io/xml.hpp"

namespace resilin {

/// The VTKFile tag of a VTK XML file, which comes first and has this type.
const XmlTag& vtk_root(const std::string& file, const std::vector<XmlTag>& tags, const std::string& type);

/// Turns the DataArray elements of a VTK XML file into numbers.
class VtuDecoder {
 public:
  /// `root` is the VTKFile tag; `bytes` the whole file.
  VtuDecoder(std::string file, std::string_view bytes, const XmlTag& root);

  /// `tag` is the AppendedData tag.
  void set_appended(const XmlTag& tag);

  /// All values of an array, integers as the doubles nearest to them.
  std::vector<double> values(const XmlTag& array) const;

  /// Throws InputError where more follows the data and the end tags.
  /// @param tags  of the file, in order
  void require_end(std::span<const XmlTag> tags) const;

  /// "FILE: array "NAME"".
  std::string place(const XmlTag& array) const;

 private:
  std::string_view appended_at(const XmlTag& array) const;
  /// Where the appended data of an array end, counted from their start.
  std::size_t end_of_appended(const XmlTag& array) const;
  std::string raw_bytes(const XmlTag& array) const;
  std::string decompressed(const XmlTag& array, std::string_view data, bool is_base64) const;
  std::uint64_t header(std::string_view bytes) const;
  std::string decoded_base64(const XmlTag& array, std::string_view text) const;
  std::uint64_t bits(std::string_view bytes) const;

  std::string file_;
  std::string_view bytes_;
  bool is_little_endian_ = true;
  std::size_t header_size_ = 4;
  std::string_view appended_;
  bool is_appended_base64_ = false;
  bool is_compressed_ = false;
};

}  // namespace resilin
