#include "resilin/world/state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr std::string_view magic = "resilin state 12\n";
constexpr const char* begin_again = "run again without --resume";
constexpr int largest_step = 1000000000;           ///< so that the counter never overflows in what follows
constexpr double smallest_load_increment = 1e-10;  ///< far below what load control ever tries

/// Members that may be below zero.
constexpr std::array<std::string_view, 6> signed_numbers = {
    "load", "previous_load", "largest_jump_load", "dissipated_energy", "friction_work", "energy_excess"};
/// Vectors that may be empty.
constexpr std::array<std::string_view, 4> optional_vectors = {"accelerations", "previous_velocities",
                                                              "released_forces", "support_places"};

template <std::size_t count>
bool is_one_of(std::string_view name, const std::array<std::string_view, count>& names) {
  return std::ranges::find(names, name) != names.end();
}

/// Each number in 8 bytes.
struct Writer {
  ArchiveWriter& archive;

  void operator()(std::string_view, int value) const { archive(std::int64_t{value}); }
  void operator()(std::string_view, double value) const { archive(value); }
  void operator()(std::string_view, const VectorX& values) const { archive(values); }
};

struct Reader {
  ArchiveReader& archive;
  const std::string& place;

  void operator()(std::string_view name, int& value) const {
    std::int64_t number = 0;
    archive(number);
    if (number < 0 || number > largest_step) {
      throw InputError(place, std::string(name) + " from 0 to " + std::to_string(largest_step),
                       std::to_string(number), begin_again);
    }
    value = static_cast<int>(number);
  }
  void operator()(std::string_view, double& value) const { archive(value); }
  void operator()(std::string_view, VectorX& values) const { archive(values); }
};

struct Checker {
  Eigen::Index num_unknowns, num_history_values;
  const std::string& place;

  [[noreturn]] void fail(std::string_view name, const std::string& expected, const std::string& got) const {
    throw InputError(place, "a checkpoint with " + std::string(name) + " " + expected, got, begin_again);
  }
  void operator()(std::string_view name, int value) const {
    if (value < 0 || value > largest_step)
      fail(name, "from 0 to " + std::to_string(largest_step), std::to_string(value));
  }
  void operator()(std::string_view name, double value) const {
    if (!std::isfinite(value)) fail(name, "finite", format_number(value));
    if (!is_one_of(name, signed_numbers) && value < 0) fail(name, ">= 0", format_number(value));
  }
  void operator()(std::string_view name, const VectorX& values) const {
    if (values.size() == 0 && is_one_of(name, optional_vectors)) return;
    const bool is_history = name == "history";
    const Eigen::Index size = is_history ? num_history_values : num_unknowns;
    if (values.size() != size) {
      fail(name, "of " + std::to_string(size) + (is_history ? " internal variables" : " DOFs"),
           std::to_string(values.size()) + (is_history ? ", as of other materials" : ", as of another mesh"));
    }
    if (!values.allFinite()) fail(name, "finite", "inf or nan");
  }
};

}  // namespace

std::string serialize(const State& state) {
  ArchiveWriter archive;
  visit_members(state, Writer{archive});
  return sealed(magic, archive.take());
}

State deserialize_state(std::string_view image, const std::string& place) {
  ArchiveReader archive(unsealed(image, magic, place, begin_again), place, begin_again);
  State state;
  visit_members(state, Reader{archive, place});
  archive.end();
  return state;
}

void check_state(const State& state, Eigen::Index num_unknowns, Eigen::Index num_history_values,
                 const std::string& place) {
  const Checker checker{num_unknowns, num_history_values, place};
  visit_members(state, checker);
  if (state.previous_time_step > 0 && state.previous_velocities.size() == 0)
    checker.fail("previous_velocities", "after a step of " + format_number(state.previous_time_step) + " s",
                 "none");
  if (!(state.load_increment >= smallest_load_increment && state.load_increment <= 1))
    checker.fail("load_increment", "from " + format_number(smallest_load_increment) + " to 1",
                 format_number(state.load_increment));
}

}  // namespace resilin
