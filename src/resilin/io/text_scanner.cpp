#include "resilin/io/text_scanner.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text[0] == '+' && text[1] != '-' ? text.substr(1) : text;
}

}  // namespace

std::string printable(std::string_view text) {
  constexpr std::size_t most = 40;
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result;
  for (const char c : text.substr(0, most)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f) {
      result += c;
    } else {
      result += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
    }
  }
  return text.size() > most ? result + "..." : result;
}

bool parse_integer(std::string_view text, std::int64_t& value) {
  text = without_plus(text);
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

bool parse_real(std::string_view text, double& value) {
  text = without_plus(text);
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ptr != text.data() + text.size()) return false;
  if (end.ec == std::errc::result_out_of_range) {
    // Too small is zero; too large is infinite and refused by whoever needs a finite number.
    const std::size_t exponent = text.find_first_of("eE");
    const bool is_tiny = exponent != text.npos && exponent + 1 < text.size() && text[exponent + 1] == '-';
    value = is_tiny ? 0.0 : HUGE_VAL;
    return true;
  }
  return end.ec == std::errc();
}

NumberFault read_real(std::string_view text, std::string_view what, double& value) {
  if (!parse_real(text, value)) {
    return {std::string(what), text.find(',') != text.npos ? "write decimals with a point, not a comma" : ""};
  }
  if (!std::isfinite(value)) return {std::string(what) + " that is finite"};
  return {};
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> pieces;
  while (true) {
    const std::size_t end = text.find(separator);
    pieces.push_back(trimmed(text.substr(0, end)));
    if (end == text.npos) return pieces;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  const auto is_between = [](char c) { return c == ',' || is_blank(c); };
  std::size_t at = 0;
  while (true) {
    while (at < text.size() && is_between(text[at])) ++at;
    if (at == text.size()) return words;
    const std::size_t begin = at;
    while (at < text.size() && !is_between(text[at])) ++at;
    words.push_back(text.substr(begin, at - begin));
  }
}

TextScanner::TextScanner(std::string file, std::string_view text, char comment)
    : file_(std::move(file)), text_(text), comment_(comment) {}

void TextScanner::skip_blanks() {
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (c == comment_ && comment_ != '\0') {
      position_ = std::min(text_.find('\n', position_), text_.size());
    } else if (is_blank(c)) {
      if (c == '\n') ++line_;
      ++position_;
    } else {
      break;
    }
  }
}

bool TextScanner::at_end() {
  skip_blanks();
  return position_ == text_.size();
}

std::string_view TextScanner::peek() {
  skip_blanks();
  std::size_t end = position_;
  while (end < text_.size() && !is_blank(text_[end]) && (comment_ == '\0' || text_[end] != comment_)) ++end;
  return text_.substr(position_, end - position_);
}

std::string_view TextScanner::word(std::string_view what) {
  const std::string_view result = peek();
  if (result.empty()) fail_at_end(what);
  position_ += result.size();
  return result;
}

std::int64_t TextScanner::integer(std::string_view what) {
  const std::string_view text = word(what);
  std::int64_t value = 0;
  if (!parse_integer(text, value)) fail(what, text);
  return value;
}

double TextScanner::real(std::string_view what) {
  const std::string_view text = word(what);
  double value = 0;
  const NumberFault fault = read_real(text, what, value);
  if (!fault.expected.empty()) fail(fault.expected, text, fault.cure);
  return value;
}

Vector3 TextScanner::point(std::string_view what, int num_coordinates) {
  Vector3 result = Vector3::Zero();
  for (int i = 0; i < num_coordinates; ++i) result[i] = real(what);
  return result;
}

std::size_t TextScanner::count(std::string_view what, std::size_t least_bytes) {
  const std::int64_t number = integer("the number of " + std::string(what));
  return checked_count(number, what, least_bytes);
}

std::size_t TextScanner::checked_count(std::int64_t number, std::string_view what,
                                       std::size_t least_bytes) const {
  const std::size_t most = remaining() / least_bytes + 1;
  if (number < 0 || static_cast<std::uint64_t>(number) > most) {
    fail("at most " + std::to_string(most) + " " + std::string(what) +
             " (the rest of the file has no room for more)",
         std::to_string(number), "the number is wrong or the file is cut");
  }
  return static_cast<std::size_t>(number);
}

std::string_view TextScanner::rest_of_line() {
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  std::string_view result = text_.substr(position_, end - position_);
  if (comment_ != '\0') result = result.substr(0, result.find(comment_));
  position_ = end;
  skip_line_end();
  return trimmed(result);
}

bool TextScanner::is_line_done() {
  std::size_t i = position_;
  while (i < text_.size() && text_[i] != '\n' && is_blank(text_[i])) ++i;
  return i == text_.size() || text_[i] == '\n' || (comment_ != '\0' && text_[i] == comment_);
}

std::string_view TextScanner::bytes(std::size_t size, std::string_view what) {
  if (size > remaining()) fail_at_end(what);
  const std::string_view result = text_.substr(position_, size);
  position_ += size;
  return result;
}

void TextScanner::skip_line_end() {
  if (position_ < text_.size() && text_[position_] == '\r') ++position_;
  if (position_ < text_.size() && text_[position_] == '\n') {
    ++position_;
    ++line_;
  }
}

bool TextScanner::skip_past(std::string_view text) {
  const std::size_t found = text_.find(text, position_);
  const std::size_t end = found == text_.npos ? text_.size() : found + text.size();
  line_ += std::count(text_.begin() + static_cast<std::ptrdiff_t>(position_),
                      text_.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  position_ = end;
  return found != text_.npos;
}

std::string TextScanner::place() const { return file_ + ": line " + std::to_string(line_); }

void TextScanner::fail(std::string_view expected, std::string_view got, const std::string& cure) const {
  throw InputError(place(), std::string(expected), printable(got), cure);
}

void TextScanner::fail_at_end(std::string_view what) {
  position_ = text_.size();
  fail(what, "the end of the file" + (section_.empty() ? "" : " inside " + section_), "the file is cut");
}

}  // namespace resilin
