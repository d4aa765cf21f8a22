#include <cstddef>
#include <cstdlib>
#include <memory>

#include "resilin/core/memory.hpp"

/// WebAssembly's memory grows up to 4 GiB, less where the browser says no, and never shrinks.
namespace resilin {
namespace {

constexpr double page = 65536;         // bytes
constexpr double most = 65536 * page;  // limit of 32-bit addresses

double size_of_memory() { return page * static_cast<double>(__builtin_wasm_memory_size(0)); }

}  // namespace

MemoryRoom address_space_left() {
  return {most - size_of_memory(), "of the 4 GiB that WebAssembly has at most"};
}

MemoryRoom free_memory() { return address_space_left(); }

double memory_in_use() { return size_of_memory(); }

bool can_allocate(std::size_t bytes) {
  void* const place = std::malloc(bytes);
  std::free(place);
  return place != nullptr;
}

std::unique_ptr<double[]> make_numbers(std::size_t count) {
  return std::make_unique_for_overwrite<double[]>(count);
}

}  // namespace resilin
