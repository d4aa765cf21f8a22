#include "resilin/io/vtu_decoder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "resilin/core/error.hpp"
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

std::optional<unsigned> base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<unsigned>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<unsigned>(c - 'a') + 26;
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0') + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return std::nullopt;
}

/// Decodes groups of four digits until `most` bytes are there, the text ends or a digit is wrong. Padding
/// ends a group, not the text: some programs encode the header and the data one after the other.
std::string decode_base64(std::string_view text, std::size_t most) {
  std::string bytes;
  std::uint32_t group = 0;
  int num_digits = 0;
  int num_padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const auto digit = base64_digit(c);
    if (!digit && c != '=') break;
    if (c == '=') ++num_padding;
    group = group << 6 | digit.value_or(0);
    if (++num_digits < 4) continue;
    for (int i = 0; i < 3 - std::min(num_padding, 3); ++i)
      bytes += static_cast<char>(group >> (16 - 8 * i) & 0xff);
    if (bytes.size() >= most) break;
    group = 0;
    num_digits = num_padding = 0;
  }
  return bytes;
}

}  // namespace

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
  if (!root.attribute("compressor").empty()) {
    throw InputError(file_, "data without compression", printable(root.attribute("compressor")),
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

std::string VtuDecoder::raw_bytes(const XmlTag& array) const {
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
  result.reserve(bytes.size() / type->size);
  for (std::size_t at = 0; at + type->size <= bytes.size(); at += type->size) {
    result.push_back(number(bits(std::string_view(bytes).substr(at, type->size)), *type));
  }
  return result;
}

}  // namespace resilin
