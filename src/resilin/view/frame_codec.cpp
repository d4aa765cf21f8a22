#include "resilin/view/frame_codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are written as memory holds them");

constexpr std::uint32_t frame_mark = 0x31465352;     // "RSF1"
constexpr std::uint32_t topology_mark = 0x31545352;  // "RST1"
constexpr std::size_t header_size = 64;
constexpr std::uint32_t has_normals = 1, has_field = 2, has_colliders = 4, has_arrows = 8;
constexpr float steps = 65535;        // steps of a place in its box
constexpr float arrow_steps = 32767;  // steps of the largest component of an arrow

/// The fixed part of a frame, in the order of docs/view_protocol.md.
struct Header {
  std::uint32_t mark, number;
  double time;
  std::uint32_t answers, num_vertices, parts, field_number;
  std::array<float, 3> corner, size;
  std::array<float, 2> range;
};
static_assert(sizeof(Header) == header_size);

/// The beginning of the arrows.
struct ArrowsHeader {
  std::uint32_t number;
  float greatest;
};
static_assert(sizeof(ArrowsHeader) == 8);

constexpr std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

/// Where the parts of a frame begin; those of colliders go on to its end.
struct Layout {
  std::size_t normals, field, arrows, colliders;

  Layout(std::size_t n, std::uint32_t parts)
      : normals(header_size + padded(6 * n)),
        field(normals + (parts & has_normals ? padded(2 * n) : 0)),
        arrows(field +
               (parts & has_field ? (parts & (has_arrows | has_colliders) ? padded(2 * n) : 2 * n) : 0)),
        colliders(arrows + (parts & has_arrows ? sizeof(ArrowsHeader) + padded(6 * n) : 0)) {}
};

template <class T>
T read_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

struct FloatBox {
  std::array<float, 3> corner{}, size{};
};

FloatBox box_of(std::span<const float> positions) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> low = {infinity, infinity, infinity}, high = {-infinity, -infinity, -infinity};
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const float value = positions[i + k];  // comparisons with what is not a number are false
      low[k] = value < low[k] && value > -infinity ? value : low[k];
      high[k] = value > high[k] && value < infinity ? value : high[k];
    }
  FloatBox box;
  for (std::size_t k = 0; k < 3; ++k)
    if (low[k] <= high[k]) box.corner[k] = low[k], box.size[k] = high[k] - low[k];
  return box;
}

/// Rounds to a whole number of [0, 65535]; 0 for what is not a number.
std::uint16_t rounded_step(float value) {
  const float shifted = value + 0.5F;
  const float high = shifted < steps ? shifted : steps;
  return static_cast<std::uint16_t>(shifted > 0 ? high : 0.0F);
}

void encode_positions(std::span<const float> positions, const FloatBox& box, std::uint16_t* out) {
  std::array<float, 3> scale{};
  for (std::size_t k = 0; k < 3; ++k) scale[k] = box.size[k] > 0 ? steps / box.size[k] : 0;
  for (std::size_t i = 0; i < positions.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k)
      out[i + k] = rounded_step((positions[i + k] - box.corner[k]) * scale[k]);
}

/// Components in steps of the greatest one.
void encode_arrows(const LiveFrame& frame, char* out) {
  ArrowsHeader header{frame.arrows_number, 0};
  for (const float value : frame.arrows)
    if (std::isfinite(value)) header.greatest = std::max(header.greatest, std::abs(value));
  std::memcpy(out, &header, sizeof header);
  auto* components = reinterpret_cast<std::int16_t*>(out + sizeof header);
  for (std::size_t i = 0; i < frame.arrows.size(); ++i) {
    const float share =
        header.greatest > 0 && std::isfinite(frame.arrows[i]) ? frame.arrows[i] / header.greatest : 0;
    components[i] = static_cast<std::int16_t>(std::lround(share * arrow_steps));
  }
}

/// Octahedral map of directions to a square. Source: Meyer, Suessmuth, Sussner, Stamminger & Greiner 2010,
/// "On floating-point normal vectors".
void encode_normals(std::span<const float> normals, std::int8_t* out) {
  for (std::size_t i = 0; i + 2 < normals.size(); i += 3) {
    const float x = normals[i], y = normals[i + 1], z = normals[i + 2];
    const float sum = std::abs(x) + std::abs(y) + std::abs(z);
    const float scale = sum > 0 ? 127 / sum : 0;  // also 0 for what is not a number
    const float u = x * scale, v = y * scale;
    const float folded_u = std::copysign(127 - std::abs(v), u),
                folded_v = std::copysign(127 - std::abs(u), v);
    const float at_u = z < 0 ? folded_u : u, at_v = z < 0 ? folded_v : v;
    out[i / 3 * 2] = static_cast<std::int8_t>(at_u + std::copysign(0.5F, at_u));
    out[i / 3 * 2 + 1] = static_cast<std::int8_t>(at_v + std::copysign(0.5F, at_v));
  }
}

void decode_normal(float u, float v, float* out) {
  Eigen::Vector3f normal(u / 127, v / 127, 1 - std::abs(u / 127) - std::abs(v / 127));
  if (normal.z() < 0) {
    const float x = normal.x();
    normal.x() = std::copysign(1 - std::abs(normal.y()), x);
    normal.y() = std::copysign(1 - std::abs(x), normal.y());
  }
  Eigen::Map<Eigen::Vector3f>(out, 3) = normal.normalized();
}

}  // namespace

FieldRange finite_range(std::span<const float> field) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  FieldRange range{infinity, -infinity};
  for (const float value : field) {
    if (value > -infinity && value < range.least) range.least = value;
    if (value < infinity && value > range.greatest) range.greatest = value;
  }
  return range.least <= range.greatest ? range : FieldRange{};
}

void encode_field(std::span<const float> field, FieldRange range, std::uint16_t* out) {
  const float width = range.greatest - range.least;
  const float scale = width > 0 ? (steps - 1) / width : 0;
  for (std::size_t i = 0; i < field.size(); ++i)
    out[i] = std::isfinite(field[i]) ? rounded_step(1 + (field[i] - range.least) * scale) : std::uint16_t{0};
}

float decode_field(std::uint16_t step, FieldRange range) {
  if (step == 0) return std::numeric_limits<float>::quiet_NaN();
  return range.least + (range.greatest - range.least) * (static_cast<float>(step - 1) / (steps - 1));
}

void encode_frame(const LiveFrame& frame, std::string& bytes) {
  const std::size_t n = frame.positions.size() / 3;
  const std::uint32_t parts =
      (frame.normals.empty() ? 0 : has_normals) | (frame.field.empty() ? 0 : has_field) |
      (frame.arrows.empty() ? 0 : has_arrows) | (frame.colliders.empty() ? 0 : has_colliders);
  const Layout layout(n, parts);
  bytes.assign(layout.colliders + frame.colliders.size_bytes(), '\0');
  const FloatBox box = box_of(frame.positions);
  const FieldRange range = finite_range(frame.field);
  const Header header{.mark = frame_mark,
                      .number = frame.number,
                      .time = frame.time,
                      .answers = frame.answers,
                      .num_vertices = static_cast<std::uint32_t>(n),
                      .parts = parts,
                      .field_number = frame.field_number,
                      .corner = box.corner,
                      .size = box.size,
                      .range = {range.least, range.greatest}};
  std::memcpy(bytes.data(), &header, header_size);
  // The memory of a string is aligned for any number, and so is every part in it.
  encode_positions(frame.positions, box, reinterpret_cast<std::uint16_t*>(bytes.data() + header_size));
  if (parts & has_normals)
    encode_normals(frame.normals, reinterpret_cast<std::int8_t*>(bytes.data() + layout.normals));
  if (parts & has_field)
    encode_field(frame.field, range, reinterpret_cast<std::uint16_t*>(bytes.data() + layout.field));
  if (parts & has_arrows) encode_arrows(frame, bytes.data() + layout.arrows);
  if (parts & has_colliders)
    std::memcpy(bytes.data() + layout.colliders, frame.colliders.data(), frame.colliders.size_bytes());
}

std::vector<float> collider_places(std::span<const ShownCollider> colliders, const Conditions& c) {
  std::vector<float> numbers;
  numbers.reserve(numbers_per_collider * colliders.size());
  for (const ShownCollider& collider : colliders) {
    const RigidPlace place = collider.place(c);
    for (int row = 0; row < 3; ++row) {
      const Vector3 turned = place.turned_back(Vector3::Unit(row));  // row of A: its inverse is its transpose
      for (int column = 0; column < 3; ++column) numbers.push_back(static_cast<float>(turned[column]));
      numbers.push_back(static_cast<float>(place.shift[row]));
    }
  }
  return numbers;
}

std::string encode_topology(const ShownSurface& surface, std::span<const ShownCollider> colliders) {
  std::string bytes;
  const auto add = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  const auto num_parts = static_cast<std::uint32_t>(surface.parts().size());
  add(&topology_mark, sizeof(topology_mark));
  add(&num_parts, sizeof(num_parts));
  for (const ShownSurface::Part& part : surface.parts()) {
    const auto triangles = surface.triangles().subspan(static_cast<std::size_t>(part.first_triangle),
                                                       static_cast<std::size_t>(part.num_triangles));
    const auto edges = surface.edges().subspan(static_cast<std::size_t>(part.first_edge),
                                               static_cast<std::size_t>(part.num_edges));
    add(triangles.data(), triangles.size_bytes());
    const auto tetrahedra = surface.tetrahedra().subspan(static_cast<std::size_t>(part.first_tetrahedron),
                                                         static_cast<std::size_t>(part.num_tetrahedra));
    add(edges.data(), edges.size_bytes());
    add(tetrahedra.data(), tetrahedra.size_bytes());
  }
  add(surface.rest_positions().data(), surface.rest_positions().size_bytes());
  for (const ShownCollider& collider : colliders) {
    for (const Vector3& X : collider.mesh.vertices) {
      const Eigen::Vector3f place = X.cast<float>();
      add(place.data(), 3 * sizeof(float));
    }
    add(collider.mesh.facets.data(), collider.mesh.facets.size() * sizeof(Index));
  }
  return bytes;
}

DecodedFrame decode_frame(std::string_view bytes) {
  const std::string place = "frame of a live scene";
  if (bytes.size() < header_size)
    throw InputError(place, "at least " + std::to_string(header_size) + " bytes",
                     std::to_string(bytes.size()));
  const auto header = read_at<Header>(bytes, 0);
  if (header.mark != frame_mark) throw InputError(place, "the mark RSF1", "another one");
  const std::size_t n = header.num_vertices;
  const Layout layout(n, header.parts);
  const bool is_whole = header.parts & has_colliders
                            ? bytes.size() > layout.colliders && bytes.size() % sizeof(float) == 0
                            : bytes.size() == layout.colliders;
  if (!is_whole)
    throw InputError(place,
                     std::to_string(layout.colliders) + " bytes for " + std::to_string(n) + " vertices",
                     std::to_string(bytes.size()));
  DecodedFrame frame{.number = header.number,
                     .time = header.time,
                     .answers = header.answers,
                     .field_number = header.field_number,
                     .corner = header.corner,
                     .size = header.size,
                     .range = {header.range[0], header.range[1]}};
  for (std::size_t i = 0; i < 3 * n; ++i) {
    const auto step = read_at<std::uint16_t>(bytes, header_size + 2 * i);
    frame.positions.push_back(header.corner[i % 3] + header.size[i % 3] * (static_cast<float>(step) / steps));
  }
  if (header.parts & has_normals) {
    frame.normals.resize(3 * n);
    for (std::size_t v = 0; v < n; ++v)
      decode_normal(read_at<std::int8_t>(bytes, layout.normals + 2 * v),
                    read_at<std::int8_t>(bytes, layout.normals + 2 * v + 1), frame.normals.data() + 3 * v);
  }
  if (header.parts & has_field)
    for (std::size_t v = 0; v < n; ++v)
      frame.field.push_back(decode_field(read_at<std::uint16_t>(bytes, layout.field + 2 * v), frame.range));
  if (header.parts & has_arrows) {
    const auto arrows = read_at<ArrowsHeader>(bytes, layout.arrows);
    frame.arrows_number = arrows.number;
    for (std::size_t i = 0; i < 3 * n; ++i) {
      const auto step = read_at<std::int16_t>(bytes, layout.arrows + sizeof arrows + 2 * i);
      frame.arrows.push_back(arrows.greatest * (static_cast<float>(step) / arrow_steps));
    }
  }
  for (std::size_t at = layout.colliders; at < bytes.size(); at += sizeof(float))
    frame.colliders.push_back(read_at<float>(bytes, at));
  return frame;
}

}  // namespace resilin
