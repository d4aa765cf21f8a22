#include "mutation.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace resilin::testing {
namespace {

constexpr std::size_t largest_input = 1 << 20;

constexpr std::array<std::string_view, 26> odd_numbers = {"0",
                                                          "-1",
                                                          "1",
                                                          "2",
                                                          "4",
                                                          "255",
                                                          "65536",
                                                          "2147483647",
                                                          "2147483648",
                                                          "4294967295",
                                                          "4294967296",
                                                          "99999999999999",
                                                          "9223372036854775807",
                                                          "-9223372036854775808",
                                                          "18446744073709551616",
                                                          "nan",
                                                          "-inf",
                                                          "1e308",
                                                          "-1e400",
                                                          "1e-320",
                                                          "1,5",
                                                          "0x10",
                                                          "1.",
                                                          ".",
                                                          "",
                                                          "%s"};

constexpr std::array<std::uint64_t, 12> odd_words = {
    0,          1,          0xff,       0x7fffffff,         0x80000000,         0xffffffff,
    0x01000000, 0xfffffffe, 1ull << 32, 0x7fffffffffffffff, 0x8000000000000000, 0xffffffffffffffff};

bool is_numeric(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '.' || c == 'e'; }

std::size_t line_start(const std::string& text, std::size_t at) {
  const std::size_t found = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  return found == std::string::npos ? 0 : found + 1;
}

std::size_t line_end(const std::string& text, std::size_t at) {
  const std::size_t found = text.find('\n', at);
  return found == std::string::npos ? text.size() : found + 1;
}

std::string random_line(const std::string& text, Dice& dice) {
  const std::size_t begin = line_start(text, dice.below(text.size()));
  return text.substr(begin, line_end(text, begin) - begin);
}

void flip_bits(std::string& text, Dice& dice) {
  for (std::size_t n = 1 + dice.below(4); n > 0 && !text.empty(); --n) {
    char& c = text[dice.below(text.size())];
    c = static_cast<char>(c ^ (1 << dice.below(8)));
  }
}

void replace_number(std::string& text, Dice& dice) {
  const std::size_t start = dice.below(text.size());
  std::size_t begin = start;
  while (begin < text.size() && !is_numeric(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && is_numeric(text[end])) ++end;
  text.replace(begin, end - begin, odd_numbers[dice.below(odd_numbers.size())]);
}

void replace_binary_word(std::string& text, Dice& dice) {
  const std::size_t size = dice.below(2) == 0 ? 4 : 8;
  if (text.size() < size) return;
  std::uint64_t word = odd_words[dice.below(odd_words.size())];
  const std::size_t begin = dice.below(text.size() - size + 1);
  for (std::size_t i = 0; i < size; ++i, word >>= 8) text[begin + i] = static_cast<char>(word & 0xff);
}

void remove_piece(std::string& text, Dice& dice) {
  const std::size_t begin = dice.below(text.size());
  text.erase(begin, 1 + dice.below(std::min<std::size_t>(64, text.size() - begin)));
}

void remove_line(std::string& text, Dice& dice) {
  const std::size_t begin = line_start(text, dice.below(text.size()));
  text.erase(begin, line_end(text, begin) - begin);
}

void double_line(std::string& text, Dice& dice) {
  const std::string line = random_line(text, dice);
  text.insert(line_start(text, dice.below(text.size())), line);
}

void insert_bytes(std::string& text, Dice& dice) {
  std::string bytes;
  for (std::size_t n = 1 + dice.below(8); n > 0; --n) bytes += static_cast<char>(dice.below(256));
  text.insert(dice.below(text.size() + 1), bytes);
}

/// The start of this file and the end of another one.
void splice(std::string& text, const std::string& other, Dice& dice) {
  text = text.substr(0, dice.below(text.size() + 1)) + other.substr(dice.below(other.size() + 1));
}

void mutate_once(std::string& text, const std::vector<std::string>& others, Dice& dice) {
  const auto other = [&]() -> const std::string& { return others[dice.below(others.size())]; };
  switch (dice.below(12)) {
    case 0:
      return flip_bits(text, dice);
    case 1:
      return text.resize(dice.below(text.size() + 1));
    case 2:
    case 3:
    case 4:
      return replace_number(text, dice);
    case 5:
      return replace_binary_word(text, dice);
    case 6:
      return remove_piece(text, dice);
    case 7:
      return remove_line(text, dice);
    case 8:
      return double_line(text, dice);
    case 9:
      return insert_bytes(text, dice);
    case 10:
      return splice(text, other(), dice);
    default:
      text.insert(line_start(text, dice.below(text.size())), random_line(other(), dice));
  }
}

}  // namespace

std::string mutated(const std::string& original, const std::vector<std::string>& others, Dice& dice) {
  std::string text = original;
  for (std::size_t n = 1 + dice.below(4); n > 0; --n) mutate_once(text, others, dice);
  if (text.size() > largest_input) text.resize(largest_input);
  return text;
}

}  // namespace resilin::testing
