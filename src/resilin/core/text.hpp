#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// "a, b, c".
std::string join(std::span<const std::string> words, std::string_view separator = ", ");

/// The candidate that differs least from `word` in single-letter edits; empty when none is near enough to be
/// meant: two letters may differ, or half of them, but not all.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

/// The cure of a misspelled word: "did you mean "NEAREST"?", empty when no candidate is near enough.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// The shortest decimal text that reads back as the same double, independent of the locale.
std::string format_number(double value);

/// Three digits: "0.0123", "1.23e-09", independent of the locale.
std::string format_short(double value);

/// "0.50", "-1.20" with a true minus sign, and "0.00" without one: so many decimals, as pictures have them.
std::string format_fixed(double value, int decimals);

/// "(0.1, -2, 1e-09)": each coordinate by format_short.
std::string format_point(const Vector3& point, int dim = 3);

/// "2025-01-31 12:00:00", now and in the time zone of this machine.
std::string local_time();

/// "512 B", "34 kB", "5.6 MB": three digits at most, steps of 1000.
std::string format_bytes(std::uintmax_t count);

/// The text on one line that any terminal shows as it is: control characters, marks that turn the direction
/// of writing and bytes that are no UTF-8 become \xNN, byte by byte.
std::string one_line(std::string_view text);

/// A text file without the mark that some editors put before UTF-8. @throws InputError naming `place` for
/// UTF-16 and UTF-32
std::string_view without_byte_order_mark(std::string_view bytes, const std::string& place);

/// Rows as lines of text, their columns as wide as the widest entry, two blanks between.
std::string format_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace resilin
