#include "resilin/core/memory.hpp"

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

void take_less(MemoryRoom& room, double bytes, std::string_view limit) {
  if (bytes < room.bytes) room = {std::max(bytes, 0.0), limit};
}

/// A file that holds one number, as those of control groups do; none when it holds a word ("max") or is not
/// there.
std::optional<double> number_of_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  double number = 0;
  if (file >> number) return number;
  return std::nullopt;
}

/// The sum of the numbers behind these words in a file of lines "WORD NUMBER"; the number may have a unit
/// behind it.
double sum_in_file(const std::filesystem::path& path, std::string_view first, std::string_view second) {
  std::ifstream file(path);
  double sum = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words_of_line(line);
    std::string word;
    double number = 0;
    if (words_of_line >> word >> number && (word == first || word == second)) sum += number;
  }
  return sum;
}

/// Names of the files of a version of control groups.
struct GroupFiles {
  const char *mount, *limit, *soft_limit, *usage, *inactive_cache, *active_cache;
};
constexpr GroupFiles version_1 = {"/sys/fs/cgroup/memory", "memory.limit_in_bytes", nullptr,
                                  "memory.usage_in_bytes", "total_inactive_file",   "total_active_file"};
constexpr GroupFiles version_2 = {"/sys/fs/cgroup", "memory.max",    "memory.high",
                                  "memory.current", "inactive_file", "active_file"};

/// Inside a container the path that the kernel names need not be there: then its mount is the group.
void look_at_group(const GroupFiles& files, const std::string& path, MemoryRoom& room) {
  const std::filesystem::path mount = files.mount;
  for (std::filesystem::path group = std::filesystem::path(path).relative_path();;
       group = group.parent_path()) {
    const std::filesystem::path folder = mount / group;
    const std::optional<double> usage = number_of_file(folder / files.usage);
    for (const char* name : {files.limit, files.soft_limit}) {
      if (name == nullptr || !usage) continue;
      const std::optional<double> limit = number_of_file(folder / name);
      if (!limit) continue;
      const double cache = sum_in_file(folder / "memory.stat", files.inactive_cache, files.active_cache);
      take_less(room, *limit - *usage + cache, "of what the control group of the process allows (cgroup)");
    }
    if (group.empty()) return;
  }
}

/// Lines "HIERARCHY:CONTROLLERS:PATH"; version 2 names no controllers.
void look_at_groups(MemoryRoom& room) {
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    if (controllers == ",,") look_at_group(version_2, line.substr(second + 1), room);
    if (controllers.find(",memory,") != std::string::npos)
      look_at_group(version_1, line.substr(second + 1), room);
  }
}

}  // namespace

MemoryRoom address_space_left() {
  MemoryRoom room{unlimited, ""};
  rlimit address_space{}, data{};
  const bool is_known = getrlimit(RLIMIT_AS, &address_space) == 0 && getrlimit(RLIMIT_DATA, &data) == 0;
  if (!is_known || (address_space.rlim_cur == RLIM_INFINITY && data.rlim_cur == RLIM_INFINITY)) return room;
  std::ifstream file("/proc/self/statm");
  double all = 0, data_used = 0, other = 0;
  file >> all >> other >> other >> other >> other >> data_used;
  const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  if (address_space.rlim_cur != RLIM_INFINITY)
    take_less(room, static_cast<double>(address_space.rlim_cur) - page * all,
              "of the address space allowed (ulimit -v)");
  if (data.rlim_cur != RLIM_INFINITY)
    take_less(room, static_cast<double>(data.rlim_cur) - page * data_used, "of the data allowed (ulimit -d)");
  return room;
}

MemoryRoom free_memory() {
  MemoryRoom room{unlimited, ""};
  look_at_groups(room);
  constexpr double kilobyte = 1024;  // what the kernel calls "kB"
  const double free = kilobyte * sum_in_file("/proc/meminfo", "MemAvailable:", "SwapFree:");
  if (free > 0) take_less(room, free, "on this machine");
  return room;
}

MemoryRoom memory_room() {
  const MemoryRoom may_ask = address_space_left(), may_use = free_memory();
  return may_ask.bytes < may_use.bytes ? may_ask : may_use;
}

std::string words(const MemoryRoom& room) {
  if (room.bytes == unlimited) return "nothing says how much is left";
  return format_bytes(static_cast<std::uintmax_t>(room.bytes)) + " are left " + std::string(room.limit);
}

bool fits(double bytes, MemoryRoom (*room)()) {
  constexpr double small_need = 32e6;  // not worth the look
  return bytes < small_need || bytes <= room().bytes;
}

double memory_in_use() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
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

bool can_allocate(std::size_t bytes) {
  void* const place = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) return false;
  munmap(place, bytes);
  return true;
}

std::unique_ptr<double[]> make_numbers(std::size_t count) {
  std::unique_ptr<double[]> numbers = std::make_unique_for_overwrite<double[]>(count);
#ifdef MADV_HUGEPAGE
  constexpr std::size_t long_array = std::size_t{8} << 20;
  const std::size_t bytes = count * sizeof(double);
  if (bytes >= long_array) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    void* begin = numbers.get();
    std::size_t room = bytes;
    if (std::align(page, bytes - page, begin, room) != nullptr)
      madvise(begin, room / page * page, MADV_HUGEPAGE);  // advice: a refusal changes nothing
  }
#endif
  return numbers;
}

std::string out_of_memory_text(const std::bad_alloc& error) {
  if (dynamic_cast<const OutOfMemory*>(&error) != nullptr) return error.what();
  return "out of memory: more was needed than there is, and " + words(memory_room()) +
         " once it is given back; take fewer cells or simpler elements, fewer threads, or raise the limit";
}

}  // namespace resilin
