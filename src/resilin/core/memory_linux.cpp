#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "resilin/core/memory.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <malloc.h>
#define RESILIN_HEAP_IS_COUNTED
#endif

/// Memory as Linux reports and gives it.
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
      take_less(room, *limit - *usage + cache, "within the limit of its control group (cgroup)");
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
  constexpr double kilobyte = 1024;  // unit of "kB" in the kernel
  const double free = kilobyte * sum_in_file("/proc/meminfo", "MemAvailable:", "SwapFree:");
  if (free > 0) take_less(room, free, "on this machine");
  return room;
}

double memory_in_use() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double heap_bytes() {
#ifdef RESILIN_HEAP_IS_COUNTED
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return 0;
#endif
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

}  // namespace resilin
