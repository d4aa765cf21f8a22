#include "resilin/io/vtu_decoder.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include <zlib.h>

#include "resilin/core/error.hpp"
#include "resilin/io/base64.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

struct NumberType {
  std::string_view name;
  std::size_t size;
  bool is_real;
  bool is_signed;
};

constexpr std::array<NumberType, 10> number_types = {{{"Float64", 8, true, true},
                                                      {"Float32", 4, true, true},
                                                      {"Int64", 8, false, true},
                                                      {"UInt64", 8, false, false},
                                                      {"Int32", 4, false, true},
                                                      {"UInt32", 4, false, false},
                                                      {"Int16", 2, false, true},
                                                      {"UInt16", 2, false, false},
                                                      {"Int8", 1, false, true},
                                                      {"UInt8", 1, false, false}}};

double number(std::uint64_t bits, const NumberType& type) {
  if (type.is_real && type.size == 8) return std::bit_cast<double>(bits);
  if (type.is_real) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  if (!type.is_signed) return static_cast<double>(bits);
  const auto shift = static_cast<int>(64 - 8 * type.size);
  return static_cast<double>(std::bit_cast<std::int64_t>(bits << shift) >> shift);
}

constexpr std::uint64_t most_expansion =
    1100;  // maximum expansion by zlib, which makes at most about 1032 bytes of one

/// Rest of the data behind so many bytes.
std::string_view behind_first(std::string_view data, std::size_t count, bool is_base64) {
  if (!is_base64) return data.substr(std::min(count, data.size()));
  std::size_t digits = 4 * ((count + 2) / 3), at = 0;
  for (; at < data.size() && digits > 0; ++at) {
    const char c = data[at];
    if (c != ' ' && c != '\n' && c != '\r' && c != '\t') --digits;
  }
  return data.substr(at);
}

}  // namespace

const XmlTag& vtk_root(const std::string& file, const std::vector<XmlTag>& tags, const std::string& type) {
  const auto shown = [](const std::string& name, const std::string& its_type) {
    return "<" + name + " type=\"" + its_type + "\">";
  };
  if (tags.empty()) throw InputError(file, shown("VTKFile", type), "no XML");
  const XmlTag& first = tags.front();
  if (first.name != "VTKFile" || first.attribute("type") != type)
    throw InputError(file, shown("VTKFile", type),
                     shown(printable(first.name), printable(first.attribute("type"))));
  return first;
}

VtuDecoder::VtuDecoder(std::string file, std::string_view bytes, const XmlTag& root)
    : file_(std::move(file)), bytes_(bytes) {
  const std::string order = root.attribute("byte_order", "LittleEndian");
  if (order != "LittleEndian" && order != "BigEndian") {
    throw InputError(file_ + ": byte_order", "LittleEndian or BigEndian", printable(order));
  }
  is_little_endian_ = order == "LittleEndian";
  const std::string header_type = root.attribute("header_type", "UInt32");
  if (header_type != "UInt32" && header_type != "UInt64") {
    throw InputError(file_ + ": header_type", "UInt32 or UInt64", printable(header_type));
  }
  header_size_ = header_type == "UInt32" ? 4 : 8;
  const std::string compressor = root.attribute("compressor");
  is_compressed_ = compressor == "vtkZLibDataCompressor";
  if (!compressor.empty() && !is_compressed_) {
    throw InputError(file_ + ": compressor", "vtkZLibDataCompressor or none", printable(compressor),
                     "save it again without a compressor");
  }
}

void VtuDecoder::set_appended(const XmlTag& tag) {
  const std::string encoding = tag.attribute("encoding");
  if (encoding != "raw" && encoding != "base64") {
    throw InputError(file_ + ": AppendedData", "the encoding raw or base64", printable(encoding));
  }
  is_appended_base64_ = encoding == "base64";
  const std::size_t start = bytes_.find('_', tag.text_begin);
  if (start == bytes_.npos)
    throw InputError(file_ + ": AppendedData", "an underscore before the data", "none");
  appended_ = bytes_.substr(start + 1);
}

std::string VtuDecoder::place(const XmlTag& array) const {
  return file_ + ": array \"" + printable(array.attribute("Name")) + "\"";
}

std::uint64_t VtuDecoder::bits(std::string_view bytes) const {
  std::uint64_t result = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char c = bytes[is_little_endian_ ? bytes.size() - 1 - i : i];
    result = result << 8 | static_cast<unsigned char>(c);
  }
  return result;
}

std::string_view VtuDecoder::appended_at(const XmlTag& array) const {
  std::int64_t offset = 0;
  if (!parse_integer(array.attribute("offset"), offset) || offset < 0 ||
      static_cast<std::uint64_t>(offset) > appended_.size()) {
    throw InputError(place(array),
                     "an offset within the " + std::to_string(appended_.size()) + " bytes of AppendedData",
                     printable(array.attribute("offset")), "the file may be cut");
  }
  return appended_.substr(static_cast<std::size_t>(offset));
}

std::size_t VtuDecoder::end_of_appended(const XmlTag& array) const {
  constexpr std::string_view base64 =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/= \t\r\n";
  const std::string_view data = appended_at(array);
  const std::size_t begin = appended_.size() - data.size();
  if (is_appended_base64_) return std::min(appended_.find_first_not_of(base64, begin), appended_.size());
  const auto number_at = [&](std::uint64_t i) {
    const std::uint64_t at = i * header_size_;
    if (at + header_size_ > data.size()) return std::uint64_t{0};
    return bits(data.substr(static_cast<std::size_t>(at), header_size_));
  };
  std::uint64_t size = header_size_ + number_at(0);
  if (is_compressed_) {
    const std::uint64_t num_blocks = std::min<std::uint64_t>(number_at(0), data.size());
    size = (num_blocks == 0 ? 1 : 3 + num_blocks) * header_size_;
    for (std::uint64_t b = 0; b < num_blocks && size <= data.size(); ++b) size += number_at(3 + b);
  }
  return begin + static_cast<std::size_t>(std::min<std::uint64_t>(size, data.size()));
}

void VtuDecoder::require_end(std::span<const XmlTag> tags) const {
  constexpr std::string_view blanks = " \t\r\n";
  std::string_view rest;
  const auto skip_blanks = [&] { rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size())); };
  const auto refuse = [&](const std::string& expected) {
    throw InputError(file_, expected, std::to_string(rest.size()) + " more bytes");
  };
  if (appended_.data() != nullptr) {
    std::size_t end = 0;
    for (const XmlTag& tag : tags)
      if (tag.name == "DataArray" && tag.attribute("format") == "appended")
        end = std::max(end, end_of_appended(tag));
    rest = appended_.substr(end);
    for (const std::string name : {"</AppendedData", "</VTKFile"}) {
      skip_blanks();
      if (rest.empty()) return;
      if (!rest.starts_with(name)) refuse(name + "> behind the data");
      rest.remove_prefix(name.size());
      skip_blanks();
      if (!rest.starts_with(">")) refuse("the end of " + name + ">");
      rest.remove_prefix(1);
    }
  } else {
    const auto end = std::ranges::find(tags, "/VTKFile", &XmlTag::name);
    if (end == tags.end()) return;
    rest = bytes_.substr(end->text_begin);
  }
  skip_blanks();
  if (!rest.empty()) refuse("the end of the file behind </VTKFile>");
}

/// The header that counts the bytes of an array, checked against those that there are.
std::string VtuDecoder::decoded_base64(const XmlTag& array, std::string_view text) const {
  const std::string start = decode_base64(text, header_size_);
  if (start.size() < header_size_) throw InputError(place(array), "base64 data", "the end of the data");
  const std::uint64_t size = bits(std::string_view(start).substr(0, header_size_));
  if (size > text.size()) {
    throw InputError(place(array), "at most " + std::to_string(text.size()) + " bytes", std::to_string(size),
                     "the file may be cut");
  }
  std::string all = decode_base64(text, header_size_ + static_cast<std::size_t>(size));
  if (all.size() < header_size_ + size) {
    throw InputError(place(array), std::to_string(size) + " bytes of base64 data",
                     std::to_string(all.size() - header_size_), "the file may be cut");
  }
  return all.substr(header_size_, static_cast<std::size_t>(size));
}

/// Compressed data: numbers of blocks, of the bytes of a block, of those of the last one (0: as
/// many) and of those that each has become; then the blocks, each a zlib stream. In base64 the numbers are
/// encoded by themselves. Source: Kitware, "VTK XML formats", compressed data.
std::string VtuDecoder::decompressed(const XmlTag& array, std::string_view data, bool is_base64) const {
  const auto first = [&](std::string_view from, std::size_t count) {
    const std::string bytes =
        is_base64 ? decode_base64(from, count) : std::string(from.substr(0, std::min(count, from.size())));
    if (bytes.size() < count)
      throw InputError(place(array), std::to_string(count) + " bytes", std::to_string(bytes.size()),
                       "the file may be cut");
    return bytes.substr(0, count);
  };
  const auto number_at = [&](const std::string& bytes, std::size_t i) {
    return bits(std::string_view(bytes).substr(i * header_size_, header_size_));
  };
  const std::uint64_t num_blocks = number_at(first(data, header_size_), 0);
  if (num_blocks > data.size() / header_size_)
    throw InputError(place(array), "blocks within the file", std::to_string(num_blocks) + " of them",
                     "the file may be cut");
  if (num_blocks == 0) return {};
  const std::size_t head_size = (3 + static_cast<std::size_t>(num_blocks)) * header_size_;
  const std::string head = first(data, head_size);
  std::uint64_t packed_size = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    if (number_at(head, 3 + b) > data.size())
      throw InputError(place(array), "blocks within the file", "a longer one", "the file may be cut");
    packed_size += number_at(head, 3 + b);
  }
  const std::string packed =
      first(behind_first(data, head_size, is_base64), static_cast<std::size_t>(packed_size));
  std::string result;
  std::size_t begin = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const std::uint64_t last = number_at(head, 2);
    const std::uint64_t size = b + 1 == num_blocks && last > 0 ? last : number_at(head, 1);
    const auto packed_block = static_cast<std::size_t>(number_at(head, 3 + b));
    if (size / most_expansion > packed_block + 1)
      throw InputError(place(array), "blocks of zlib", "one that promises more than zlib can hold");
    std::string block(static_cast<std::size_t>(size), '\0');
    auto found = static_cast<uLongf>(size);
    const int status =
        uncompress(reinterpret_cast<Bytef*>(block.data()), &found,
                   reinterpret_cast<const Bytef*>(packed.data() + begin), static_cast<uLong>(packed_block));
    if (status != Z_OK || found != size)
      throw InputError(place(array), "blocks of zlib", "one that is damaged", "the file may be cut");
    result += block;
    begin += packed_block;
  }
  return result;
}

std::string VtuDecoder::raw_bytes(const XmlTag& array) const {
  if (is_compressed_) {
    const bool is_inline = array.attribute("format") == "binary";
    return decompressed(array, is_inline ? array.text : appended_at(array), is_inline || is_appended_base64_);
  }
  if (array.attribute("format") == "binary") return decoded_base64(array, array.text);
  const std::string_view data = appended_at(array);
  if (is_appended_base64_) return decoded_base64(array, data);
  if (data.size() < header_size_)
    throw InputError(place(array), "data", "the end of the file", "the file is cut");
  const std::uint64_t size = bits(data.substr(0, header_size_));
  if (size > data.size() - header_size_) {
    throw InputError(place(array), "at most " + std::to_string(data.size() - header_size_) + " bytes",
                     std::to_string(size), "the file may be cut");
  }
  return std::string(data.substr(header_size_, static_cast<std::size_t>(size)));
}

std::vector<double> VtuDecoder::values(const XmlTag& array) const {
  const std::string type_name = array.attribute("type");
  const auto type = std::find_if(number_types.begin(), number_types.end(),
                                 [&](const NumberType& known) { return known.name == type_name; });
  if (type == number_types.end())
    throw InputError(place(array), "a type such as Float64", printable(type_name));
  std::vector<double> result;
  const std::string format = array.attribute("format", "ascii");
  if (format == "ascii") {
    TextScanner text(file_, array.text);
    while (!text.at_end()) {
      const std::string_view word = text.word("");
      double value = 0;
      if (!parse_real(word, value)) throw InputError(place(array), "numbers", printable(word));
      result.push_back(value);
    }
    return result;
  }
  if (format != "appended" && format != "binary") {
    throw InputError(place(array), "the format ascii, binary or appended", printable(format));
  }
  const std::string bytes = raw_bytes(array);
  if (bytes.size() % type->size != 0)
    throw InputError(place(array), "whole numbers of " + std::to_string(type->size) + " bytes",
                     std::to_string(bytes.size()) + " bytes");
  result.reserve(bytes.size() / type->size);
  for (std::size_t at = 0; at + type->size <= bytes.size(); at += type->size) {
    result.push_back(number(bits(std::string_view(bytes).substr(at, type->size)), *type));
  }
  return result;
}

}  // namespace resilin
