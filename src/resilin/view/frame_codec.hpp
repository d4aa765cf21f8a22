#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/view/shown_surface.hpp"
#include "resilin/world/shown_colliders.hpp"

/// Topology and live frames as the page reads them (docs/view_protocol.md): little-endian, places in
/// 1/65535 of their box, normals octahedral in two bytes, a field in 65,535 steps.
namespace resilin {

/// Least and greatest finite value of a field; both zero without any.
struct FieldRange {
  float least = 0, greatest = 0;
};
FieldRange finite_range(std::span<const float> field);

/// The steps that a field is sent in: 0 for what is not a finite number, 1 at the least value, 65535 at the
/// greatest.
void encode_field(std::span<const float> field, FieldRange range, std::uint16_t* out);
float decode_field(std::uint16_t step, FieldRange range);  ///< nan for 0

/// A frame of a live scene, as it is sent to pages.
struct LiveFrame {
  std::uint32_t number = 0;
  double time = 0;                     ///< [s]
  std::uint32_t answers = 0;           ///< number of the newest drag message that it answers
  std::span<const float> positions{};  ///< 3 per vertex [m]
  std::span<const float> normals{};    ///< 3 per vertex; empty: none are sent
  std::uint32_t field_number = 0;      ///< in the header's list
  std::span<const float> field{};      ///< 1 per vertex; empty: none is sent
  std::uint32_t arrows_number = 0;     ///< field whose vectors the arrows are, in the header's list
  std::span<const float> arrows{};     ///< 3 per vertex; empty: none are sent
  std::span<const float> colliders{};  ///< where they are: see collider_places
};

/// Numbers that say where a collider is: x = A X + b as the rows of (A b).
inline constexpr std::size_t numbers_per_collider = 12;
std::vector<float> collider_places(std::span<const ShownCollider> colliders, const Conditions& c);

/// Writes the frame into `bytes`, whose memory is used again. A place that is not a number stands at the
/// lower corner of the box, a field's at 0; a component of an arrow is then 0.
void encode_frame(const LiveFrame& frame, std::string& bytes);

/// Triangles and edges of a shown surface and its colliders, in bytes.
std::string encode_topology(const ShownSurface& surface, std::span<const ShownCollider> colliders = {});

/// A frame as it comes out.
struct DecodedFrame {
  std::uint32_t number = 0;
  double time = 0;
  std::uint32_t answers = 0;
  std::uint32_t field_number = 0;
  std::array<float, 3> corner{}, size{};  ///< corner and size of the box of all vertices [m]
  FieldRange range;                       ///< range of the field
  std::vector<float> positions{}, normals{};
  std::vector<float> field{};  ///< nan where there was no number
  std::uint32_t arrows_number = 0;
  std::vector<float> arrows{};
  std::vector<float> colliders{};
};

/// @throws InputError  when `bytes` is no whole frame
DecodedFrame decode_frame(std::string_view bytes);

}  // namespace resilin
