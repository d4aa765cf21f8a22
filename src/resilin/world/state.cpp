#include "resilin/world/state.hpp"

#include <cmath>
#include <cstdint>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr std::string_view magic = "resilin state 10\n";
constexpr const char* begin_again = "run again without --resume";
constexpr int largest_step = 1000000000;           ///< so that the counter never overflows in what follows
constexpr double smallest_load_increment = 1e-10;  ///< far below what load control ever tries

enum class Sign { any, not_negative };
enum class Size { full, full_or_empty };

/// Every member of a state once, in the order of its image, with what it may be.
template <class AnyState, class Visitor>
void visit_members(AnyState& state, Visitor&& visitor) {
  visitor.count("step", state.step);
  visitor.count("mode", state.mode);
  visitor.number("time", state.time, Sign::not_negative);
  visitor.number("load", state.load, Sign::any);
  visitor.vector("positions", state.positions, Size::full);
  visitor.vector("velocities", state.velocities, Size::full);
  visitor.number("load_increment", state.load_increment, Sign::not_negative);
  visitor.number("previous_load", state.previous_load, Sign::any);
  visitor.vector("previous_positions", state.previous_positions, Size::full);
  visitor.number("arc_length", state.arc_length, Sign::not_negative);
  visitor.number("load_weight", state.load_weight, Sign::not_negative);
  visitor.vector("accelerations", state.accelerations, Size::full_or_empty);
  visitor.vector("previous_velocities", state.previous_velocities, Size::full_or_empty);
  visitor.number("previous_time_step", state.previous_time_step, Sign::not_negative);
  visitor.number("time_step", state.time_step, Sign::not_negative);
  visitor.number("collider_delay", state.collider_delay, Sign::not_negative);
  visitor.number("dissipated_energy", state.dissipated_energy, Sign::any);
  visitor.number("friction_work", state.friction_work, Sign::any);
  visitor.count("unsettled_steps", state.unsettled_steps);
  visitor.number("friction_mismatch", state.friction_mismatch, Sign::not_negative);
  visitor.number("energy_excess", state.energy_excess, Sign::any);
  visitor.number("largest_kinetic_energy", state.largest_kinetic_energy, Sign::not_negative);
  visitor.count("guarded_steps", state.guarded_steps);
  visitor.count("divided_steps", state.divided_steps);
  visitor.number("removed_energy", state.removed_energy, Sign::not_negative);
  visitor.count("jumps", state.jumps);
  visitor.number("largest_jump", state.largest_jump, Sign::not_negative);
  visitor.number("largest_jump_load", state.largest_jump_load, Sign::any);
}

struct Writer {
  ArchiveWriter& archive;

  void count(const char*, int value) { archive(std::int64_t{value}); }
  void number(const char*, double value, Sign) { archive(value); }
  void vector(const char*, const VectorX& values, Size) { archive(values); }
};

struct Reader {
  ArchiveReader& archive;
  const std::string& place;

  void count(const char* name, int& value) {
    std::int64_t number = 0;
    archive(number);
    if (number < 0 || number > largest_step) {
      throw InputError(place, std::string(name) + " from 0 to " + std::to_string(largest_step),
                       std::to_string(number), begin_again);
    }
    value = static_cast<int>(number);
  }
  void number(const char*, double& value, Sign) { archive(value); }
  void vector(const char*, VectorX& values, Size) { archive(values); }
};

struct Checker {
  Eigen::Index num_unknowns;
  const std::string& place;

  [[noreturn]] void fail(const char* name, const std::string& expected, const std::string& got) const {
    throw InputError(place, "a checkpoint with " + std::string(name) + " " + expected, got, begin_again);
  }
  void count(const char* name, int value) const {
    if (value < 0 || value > largest_step)
      fail(name, "from 0 to " + std::to_string(largest_step), std::to_string(value));
  }
  void number(const char* name, double value, Sign sign) const {
    if (!std::isfinite(value)) fail(name, "finite", format_number(value));
    if (sign == Sign::not_negative && value < 0) fail(name, ">= 0", format_number(value));
  }
  void vector(const char* name, const VectorX& values, Size size) const {
    if (size == Size::full_or_empty && values.size() == 0) return;
    if (values.size() != num_unknowns) {
      fail(name, "of " + std::to_string(num_unknowns) + " DOFs",
           std::to_string(values.size()) + ", as of another mesh");
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

void check_state(const State& state, Eigen::Index num_unknowns, const std::string& place) {
  const Checker checker{num_unknowns, place};
  visit_members(state, checker);
  if (state.previous_time_step > 0 && state.previous_velocities.size() == 0)
    checker.fail("previous_velocities", "after a step of " + format_number(state.previous_time_step) + " s",
                 "none");
  if (!(state.load_increment >= smallest_load_increment && state.load_increment <= 1))
    checker.fail("load_increment", "from " + format_number(smallest_load_increment) + " to 1",
                 format_number(state.load_increment));
}

}  // namespace resilin
