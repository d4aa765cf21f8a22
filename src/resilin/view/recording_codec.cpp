#include "resilin/view/recording_codec.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

constexpr std::size_t head_size = 32;  ///< head size of a payload, before the ranges of the fields
constexpr std::int32_t largest_step =
    1 << 28;  ///< largest step of a place in one frame; what is left follows in the next

/// For each vertex the highest of its neighbours with lower numbers.
std::vector<std::uint32_t> lower_neighbours(const ShownSurface& surface) {
  std::vector<std::uint32_t> parents(static_cast<std::size_t>(surface.num_vertices()));
  std::vector<bool> has_parent(parents.size(), false);
  for (std::size_t v = 0; v < parents.size(); ++v) parents[v] = static_cast<std::uint32_t>(v);
  const auto connect = [&](std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    if (low == high || (has_parent[high] && parents[high] >= low)) return;
    parents[high] = low;
    has_parent[high] = true;
  };
  for (const auto& [a, b, c] : surface.triangles()) {
    connect(a, b);
    connect(b, c);
    connect(c, a);
  }
  for (const auto& [a, b] : surface.edges()) connect(a, b);
  for (const ShownSurface::Tetrahedron& corners : surface.tetrahedra())
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) connect(corners[i], corners[j]);
  return parents;
}

double power_of_two_up_to(double value) { return std::exp2(std::floor(std::log2(value))); }

/// 0, -1, 1, -2, 2 ... as 0, 1, 2, 3, 4 ...
std::uint32_t folded(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}
std::int32_t unfolded(std::uint32_t code) {
  return static_cast<std::int32_t>(code >> 1) ^ -static_cast<std::int32_t>(code & 1);
}

/// Bytes [begin, begin + count) of `stream` are the lowest of each number, and so on.
void put_planes(std::span<const std::int32_t> values, std::size_t num_planes, std::string& stream) {
  const std::size_t begin = stream.size(), count = values.size();
  stream.resize(begin + num_planes * count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t code = folded(values[i]);
    for (std::size_t k = 0; k < num_planes; ++k)
      stream[begin + k * count + i] = static_cast<char>(static_cast<unsigned char>(code >> (8 * k)));
  }
}

std::vector<std::int32_t> take_planes(std::string_view& stream, std::size_t num_planes, std::size_t count) {
  std::vector<std::int32_t> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t code = 0;
    for (std::size_t k = 0; k < num_planes; ++k)
      code |= static_cast<std::uint32_t>(static_cast<unsigned char>(stream[k * count + i])) << (8 * k);
    values[i] = unfolded(code);
  }
  stream.remove_prefix(num_planes * count);
  return values;
}

/// values[v] less that of its neighbour, in place; from the last on, so that neighbours are still whole.
void subtract_parents(std::span<const std::uint32_t> parents, std::span<std::int32_t> values) {
  for (std::size_t v = values.size(); v-- > 0;)
    if (parents[v] != v) values[v] -= values[parents[v]];
}
void add_parents(std::span<const std::uint32_t> parents, std::span<std::int32_t> values) {
  for (std::size_t v = 0; v < values.size(); ++v)
    if (parents[v] != v) values[v] += values[parents[v]];
}

/// Empty when `bytes` do not inflate to exactly so many.
std::string inflated(std::string_view bytes, std::size_t expected) {
  std::string stream(expected, '\0');
  auto size = static_cast<uLongf>(expected);
  const int status =
      uncompress(reinterpret_cast<Bytef*>(stream.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 static_cast<uLong>(bytes.size()));
  if (status != Z_OK || size != expected) stream.clear();
  return stream;
}

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <class T>
T take(std::string_view& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  bytes.remove_prefix(sizeof(T));
  return value;
}

std::int32_t level_of(float value, FieldRange range) {
  if (!std::isfinite(value)) return 0;
  const double width = static_cast<double>(range.greatest) - static_cast<double>(range.least);
  const double share =
      width > 0 ? (static_cast<double>(value) - static_cast<double>(range.least)) / width : 0;
  return 1 + static_cast<std::int32_t>(std::lround(share * (RecordingCodec::field_levels - 1)));
}

float value_of(std::int32_t level, FieldRange range) {
  if (level == 0) return std::numeric_limits<float>::quiet_NaN();
  const float share = static_cast<float>(level - 1) / (RecordingCodec::field_levels - 1);
  return range.least + (range.greatest - range.least) * share;
}

}  // namespace

std::string deflated(std::string_view stream) {
  uLongf size = compressBound(static_cast<uLong>(stream.size()));
  std::string bytes(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(stream.data()),
                static_cast<uLong>(stream.size()), Z_DEFAULT_COMPRESSION);
  if (status != Z_OK) throw std::bad_alloc();
  bytes.resize(size);
  return bytes;
}

RecordingCodec::RecordingCodec(const ShownSurface& surface, std::size_t num_fields, double extent,
                               std::size_t num_colliders)
    : num_fields_(num_fields),
      num_colliders_(num_colliders),
      smallest_quantum_(power_of_two_up_to(1e-12 * extent)),
      largest_quantum_(power_of_two_up_to(1e-5 * extent)),
      quantum_(smallest_quantum_),
      parents_(lower_neighbours(surface)),
      displacements_(3 * parents_.size(), 0.0) {}

/// Never falls, so that it follows from the records before.
double RecordingCodec::quantum_for(std::span<const float> displacements) const {
  double farthest = 0;
  for (const float value : displacements)
    if (std::isfinite(value)) farthest = std::max(farthest, static_cast<double>(std::abs(value)));
  if (farthest == 0) return quantum_;
  return std::max(quantum_, std::min(power_of_two_up_to(farthest / 16000), largest_quantum_));
}

std::string RecordingCodec::encode(const RecordedFrame& frame) {
  const std::size_t n = parents_.size();
  quantum_ = quantum_for(frame.displacements);
  std::string payload, stream;
  put(payload, frame.number);
  put(payload, frame.step);
  put(payload, frame.time);
  put(payload, frame.load);
  put(payload, quantum_);

  std::vector<std::int32_t> steps(3 * n);
  for (std::size_t i = 0; i < 3 * n; ++i) {
    const double gap =
        (static_cast<double>(frame.displacements[i % n * 3 + i / n]) - displacements_[i]) / quantum_;
    if (std::isfinite(gap))
      steps[i] = static_cast<std::int32_t>(std::lround(std::clamp<double>(gap, -largest_step, largest_step)));
    displacements_[i] += quantum_ * steps[i];
  }
  for (std::size_t k = 0; k < 3; ++k) subtract_parents(parents_, std::span(steps).subspan(k * n, n));
  put_planes(steps, 4, stream);

  steps.resize(n);
  for (const std::vector<float>& field : frame.fields) {
    const FieldRange range = finite_range(field);
    put(payload, range);
    for (std::size_t v = 0; v < n; ++v) steps[v] = level_of(field[v], range);
    subtract_parents(parents_, steps);
    put_planes(steps, 2, stream);
  }
  for (const float number : frame.colliders) put(payload, number);
  return payload + deflated(stream);
}

RecordedFrame RecordingCodec::decode(std::string_view payload) {
  const std::string place = "recording";
  const std::size_t n = parents_.size();
  const std::size_t num_places = numbers_per_collider * num_colliders_;
  if (payload.size() < head_size + num_fields_ * sizeof(FieldRange) + num_places * sizeof(float))
    throw InputError(place, "a record of a frame", std::to_string(payload.size()) + " bytes");
  RecordedFrame frame{.number = take<std::uint32_t>(payload),
                      .step = take<std::uint32_t>(payload),
                      .time = take<double>(payload),
                      .load = take<double>(payload)};
  const auto quantum = take<double>(payload);
  std::vector<FieldRange> ranges;
  for (std::size_t f = 0; f < num_fields_; ++f) ranges.push_back(take<FieldRange>(payload));
  for (std::size_t i = 0; i < num_places; ++i) frame.colliders.push_back(take<float>(payload));
  const std::string bytes = inflated(payload, stream_size());
  if (bytes.size() != stream_size() || !(quantum >= quantum_) || !(quantum <= largest_quantum_))
    throw InputError(place, "a record of " + std::to_string(n) + " vertices", "one of something else");
  quantum_ = quantum;

  std::string_view stream = bytes;
  std::vector<std::int32_t> steps = take_planes(stream, 4, 3 * n);
  for (std::size_t k = 0; k < 3; ++k) add_parents(parents_, std::span(steps).subspan(k * n, n));
  frame.displacements.resize(3 * n);
  for (std::size_t i = 0; i < 3 * n; ++i) {
    displacements_[i] += quantum_ * steps[i];
    frame.displacements[i % n * 3 + i / n] = static_cast<float>(displacements_[i]);
  }
  for (const FieldRange& range : ranges) {
    std::vector<std::int32_t> levels = take_planes(stream, 2, n);
    add_parents(parents_, levels);
    std::vector<float>& field = frame.fields.emplace_back(n);
    for (std::size_t v = 0; v < n; ++v) field[v] = value_of(levels[v], range);
  }
  return frame;
}

}  // namespace resilin
