#include "resilin/world/state.hpp"

#include <bit>
#include <cstring>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

static_assert(std::endian::native == std::endian::little, "images are little-endian");

constexpr std::string_view magic = "resilin state 6\n";

template <class T>
void put(std::string& image, const T& value) {
  image.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void put(std::string& image, const VectorX& values) {
  put(image, static_cast<std::int64_t>(values.size()));
  image.append(reinterpret_cast<const char*>(values.data()),
               static_cast<std::size_t>(values.size()) * sizeof(double));
}

/// FNV-1a, enough to notice a damaged file.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  return hash;
}

class Reader {
 public:
  Reader(std::string_view image, const std::string& place) : rest_(image), place_(place) {}

  template <class T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  VectorX get_vector() {
    const auto size = get<std::int64_t>();
    if (size < 0 || static_cast<std::uint64_t>(size) > rest_.size() / sizeof(double)) fail();
    VectorX values(size);
    if (size > 0) {
      const std::size_t bytes = static_cast<std::size_t>(size) * sizeof(double);
      std::memcpy(values.data(), take(bytes).data(), bytes);
    }
    return values;
  }

 private:
  [[noreturn]] void fail() const {
    throw InputError(place_, "a complete checkpoint", "a truncated one", "run again without --resume");
  }

  std::string_view take(std::size_t size) {
    if (size > rest_.size()) fail();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::string_view rest_;
  const std::string& place_;
};

}  // namespace

std::string serialize(const State& state) {
  std::string image(magic);
  put(image, static_cast<std::int64_t>(state.step));
  put(image, static_cast<std::int64_t>(state.mode));
  put(image, state.time);
  put(image, state.load);
  put(image, state.positions);
  put(image, state.velocities);
  put(image, state.load_increment);
  put(image, state.previous_load);
  put(image, state.previous_positions);
  put(image, state.arc_length);
  put(image, state.load_weight);
  put(image, state.accelerations);
  put(image, state.previous_velocities);
  put(image, state.previous_time_step);
  put(image, state.time_step);
  put(image, state.collider_delay);
  put(image, state.dissipated_energy);
  put(image, checksum(image));
  return image;
}

State deserialize_state(std::string_view image, const std::string& place) {
  if (image.substr(0, magic.size()) != magic) {
    throw InputError(place, "a checkpoint of this version", "something else", "run again without --resume");
  }
  Reader reader(image.substr(magic.size()), place);
  State state;
  state.step = static_cast<int>(reader.get<std::int64_t>());
  state.mode = static_cast<int>(reader.get<std::int64_t>());
  state.time = reader.get<double>();
  state.load = reader.get<double>();
  state.positions = reader.get_vector();
  state.velocities = reader.get_vector();
  state.load_increment = reader.get<double>();
  state.previous_load = reader.get<double>();
  state.previous_positions = reader.get_vector();
  state.arc_length = reader.get<double>();
  state.load_weight = reader.get<double>();
  state.accelerations = reader.get_vector();
  state.previous_velocities = reader.get_vector();
  state.previous_time_step = reader.get<double>();
  state.time_step = reader.get<double>();
  state.collider_delay = reader.get<double>();
  state.dissipated_energy = reader.get<double>();
  const auto sum = reader.get<std::uint64_t>();
  if (sum != checksum(image.substr(0, image.size() - sizeof(sum)))) {
    throw InputError(place, "a checkpoint as it was written", "a damaged one", "run again without --resume");
  }
  return state;
}

}  // namespace resilin
