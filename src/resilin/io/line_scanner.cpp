#include "resilin/io/line_scanner.hpp"

#include <algorithm>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

/// "1.5D3" and "1.5+3" as "1.5e3" and "1.5e+3"; any other text as it is.
std::string in_c_notation(std::string_view text) {
  std::string result(text);
  const std::size_t exponent = result.find_first_of("dD");
  if (exponent != result.npos) {
    result[exponent] = 'e';
  } else if (result.find_first_of("eE") == result.npos) {
    const std::size_t sign = result.find_first_of("+-", 1);
    if (sign != result.npos) result.insert(sign, 1, 'e');
  }
  return result;
}

}  // namespace

LineScanner::LineScanner(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {}

bool LineScanner::next() {
  if (is_repeated_) {
    is_repeated_ = false;
    return true;
  }
  if (position_ == text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  line_ = text_.substr(position_, end - position_);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  position_ = std::min(end + 1, text_.size());
  ++number_;
  return true;
}

void LineScanner::repeat() { is_repeated_ = true; }

std::string LineScanner::place() const { return file_ + ": line " + std::to_string(number_); }

void LineScanner::fail(std::string_view expected, std::string_view got, const std::string& cure) const {
  throw InputError(place(), std::string(expected), got.empty() ? "nothing" : printable(got), cure);
}

std::int64_t LineScanner::integer(std::string_view field, std::string_view what) const {
  std::int64_t value = 0;
  if (!parse_integer(field, value)) fail(what, field);
  return value;
}

double LineScanner::real(std::string_view field, std::string_view what) const {
  double value = 0;
  std::string converted;
  std::string_view number = field;
  if (!parse_real(field, value)) {
    converted = in_c_notation(field);
    if (parse_real(converted, value)) number = converted;
  }
  const NumberFault fault = read_real(number, what, value);
  if (!fault.expected.empty()) fail(fault.expected, field, fault.cure);
  return value;
}

}  // namespace resilin
