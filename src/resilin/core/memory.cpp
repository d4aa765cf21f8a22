#include "resilin/core/memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"

namespace resilin {

MemoryRoom memory_room() {
  const MemoryRoom may_ask = address_space_left(), may_use = free_memory();
  return may_ask.bytes < may_use.bytes ? may_ask : may_use;
}

std::string words(const MemoryRoom& room) {
  if (room.bytes == std::numeric_limits<double>::infinity()) return "nothing says how much is left";
  return format_bytes(static_cast<std::uintmax_t>(room.bytes)) + " are left " + std::string(room.limit);
}

bool fits(double bytes, MemoryRoom (*room)()) {
  constexpr double small_need = 32e6;  // not worth the look
  return bytes < small_need || bytes <= room().bytes;
}

void foresee_memory(double bytes, const std::string& what, const std::string& cure) {
  if (fits(bytes)) return;
  throw OutOfMemory("out of memory: " + what + " needs " + format_bytes(static_cast<std::uintmax_t>(bytes)) +
                    ", " + words(memory_room()) + "; " + cure);
}

std::string what_would_fit(double count, double bytes, const std::string& units) {
  const double in_use = memory_in_use(), share = (in_use + memory_room().bytes) / (in_use + bytes);
  double number = std::min(share, 1.0) * count;
  const double digit = std::pow(10.0, std::floor(std::log10(std::max(number, 1.0))) - 1);
  number = std::floor(number / digit) * digit;
  return "some " + std::to_string(static_cast<std::int64_t>(number)) + " " + units + " would fit";
}

std::string out_of_memory_text(const std::bad_alloc& error) {
  if (dynamic_cast<const OutOfMemory*>(&error) != nullptr) return error.what();
  return "out of memory: more was needed than there is, and " + words(memory_room()) +
         " once it is given back; take fewer cells or simpler elements, fewer threads, or raise the limit";
}

void take_pages(void* begin, std::size_t bytes) {
  constexpr std::size_t page = 4096, pages_per_chunk = 256, much = std::size_t{4} << 20;
  if (bytes < much) return;
  auto* const first = static_cast<volatile char*>(begin);
  parallel_for(bytes / page, pages_per_chunk, [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) first[k * page] = 0;
  });
}

}  // namespace resilin
