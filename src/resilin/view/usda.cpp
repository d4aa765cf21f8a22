#include "resilin/view/usda.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <ostream>
#include <set>
#include <system_error>

#include "resilin/core/error.hpp"
#include "resilin/core/output_file.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

/// Shortest text that reads back as the same number; what is none becomes zero, for USD readers stop at
/// "nan".
template <class Number>
void put(std::string& text, Number value) {
  if constexpr (std::is_floating_point_v<Number>) {
    if (!std::isfinite(value)) value = 0;
  }
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  text.append(buffer.data(), end);
}

void put_point(std::string& text, const float* point) {
  text += '(';
  put(text, point[0]);
  text += ", ";
  put(text, point[1]);
  text += ", ";
  put(text, point[2]);
  text += ')';
}

void put_translation(std::string& text, const Vector3& by) {
  text += "    double3 xformOp:translate = (";
  for (int k = 0; k < 3; ++k) {
    if (k > 0) text += ", ";
    put(text, by[k]);
  }
  text += ")\n    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
}

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + '"';
}

/// [low, high] corners of the points.
std::array<float, 6> extent_of(std::span<const float> points) {
  std::array<float, 6> extent{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t k = i % 3;
    if (i < 3 || points[i] < extent[k]) extent[k] = points[i];
    if (i < 3 || points[i] > extent[3 + k]) extent[3 + k] = points[i];
  }
  return extent;
}

struct SavedFrame {
  double time = 0;
  std::vector<float> points{};
};

SavedFrame read_frame(std::istream& stream, std::size_t num_floats) {
  SavedFrame frame{.points = std::vector<float>(num_floats)};
  stream.read(reinterpret_cast<char*>(&frame.time), sizeof(double));
  stream.read(reinterpret_cast<char*>(frame.points.data()),
              static_cast<std::streamsize>(num_floats * sizeof(float)));
  return frame;
}

/// Whole where rounding alone keeps it from being whole.
double time_code(double time, double codes_per_second) {
  const double code = time * codes_per_second;
  return std::abs(code - std::round(code)) < 1e-6 ? std::round(code) : code;
}

}  // namespace

std::string usd_identifier(std::string_view name) {
  std::string result;
  for (const char c : name) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    result += is_letter || (c >= '0' && c <= '9') ? c : '_';
  }
  if (result.empty() || (result[0] >= '0' && result[0] <= '9')) result.insert(result.begin(), '_');
  return result;
}

UsdaWriter::UsdaWriter(std::filesystem::path points_path, const World& world, const Vector3& up)
    : path_(std::move(points_path)),
      world_(world),
      surface_(world, ShownSurface::Inside::left_out),
      up_(up) {}

std::size_t UsdaWriter::frame_size() const {
  return sizeof(double) + surface_.rest_positions().size() * sizeof(float);
}

void UsdaWriter::keep(std::size_t count) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path_, error);
  num_frames_ = error ? 0 : std::min<std::size_t>(count, size / frame_size());
  if (error) OutputFile(path_, OutputFile::Mode::truncate).close();
  std::filesystem::resize_file(path_, num_frames_ * frame_size(), error);
  if (error) throw FileError(path_.string(), "cannot be written: " + reason_of_failed_write(error.value()));
}

void UsdaWriter::record(const VectorX& positions, double time) {
  std::vector<float> points(surface_.rest_positions().size());
  surface_.positions(positions, points);
  OutputFile file(path_, OutputFile::Mode::append);
  file.stream().write(reinterpret_cast<const char*>(&time), sizeof(double));
  file.stream().write(reinterpret_cast<const char*>(points.data()),
                      static_cast<std::streamsize>(points.size() * sizeof(float)));
  file.close();
  ++num_frames_;
}

void UsdaWriter::remove_points() const {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void UsdaWriter::write(std::ostream& stream, const std::string& title, double codes_per_second) const {
  std::ifstream points(path_, std::ios::binary);
  const std::size_t num_floats = surface_.rest_positions().size();
  std::vector<double> codes;
  for (std::size_t f = 0; f < num_frames_; ++f) {
    points.seekg(static_cast<std::streamoff>(f * frame_size()));
    double time = 0;
    points.read(reinterpret_cast<char*>(&time), sizeof(double));
    codes.push_back(time_code(time, codes_per_second));
  }
  std::string text =
      "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    doc = " + in_quotes(title) + "\n    endTimeCode = ";
  put(text, codes.empty() ? 0 : codes.back());
  text += "\n    metersPerUnit = 1\n    startTimeCode = ";
  put(text, codes.empty() ? 0 : codes.front());
  text += "\n    timeCodesPerSecond = ";
  put(text, codes_per_second);
  const bool is_y_up = std::abs(up_.y()) > std::abs(up_.z());
  text += std::string("\n    upAxis = \"") + (is_y_up ? "Y" : "Z") + "\"\n)\n\ndef Xform \"scene\"\n{\n";
  // Far from the scene's origin the single precision of points would not do.
  if (!world_.origin.isZero(0)) put_translation(text, world_.origin);
  std::set<std::string> names;
  for (const ShownSurface::Part& part : surface_.parts()) {
    if (part.kind == ShownSurface::Kind::cells && is_shown_by_skin(world_.bodies[part.body])) continue;
    std::string name = usd_identifier(part.name);
    while (!names.insert(name).second) name += '_';
    text +=
        "    def Mesh \"" + name + "\" (\n        displayName = " + in_quotes(part.name) + "\n    )\n    {\n";
    text += "        int[] faceVertexCounts = [";
    for (Index t = 0; t < part.num_triangles; ++t) text += t == 0 ? "3" : ", 3";
    text += "]\n        int[] faceVertexIndices = [";
    for (Index t = 0; t < part.num_triangles; ++t) {
      for (const std::uint32_t v : surface_.triangles()[static_cast<std::size_t>(part.first_triangle + t)]) {
        if (text.back() != '[') text += ", ";
        put(text, v - static_cast<std::uint32_t>(part.first_vertex));
      }
    }
    text +=
        "]\n        uniform token subdivisionScheme = \"none\"\n        uniform token orientation = "
        "\"rightHanded\"\n";
    const auto first = static_cast<std::size_t>(3 * part.first_vertex);
    const auto count = static_cast<std::size_t>(3 * part.num_vertices);
    std::string extents = "        float3[] extent.timeSamples = {\n";
    text += "        point3f[] points.timeSamples = {\n";
    for (std::size_t f = 0; f < num_frames_; ++f) {
      points.seekg(static_cast<std::streamoff>(f * frame_size()));
      const SavedFrame frame = read_frame(points, num_floats);
      const std::span<const float> own = std::span(frame.points).subspan(first, count);
      text += "            ";
      put(text, codes[f]);
      text += ": [";
      for (std::size_t i = 0; i < count; i += 3) {
        if (i > 0) text += ", ";
        put_point(text, own.data() + i);
      }
      text += "],\n";
      const std::array<float, 6> extent = extent_of(own);
      extents += "            ";
      put(extents, codes[f]);
      extents += ": [";
      put_point(extents, extent.data());
      extents += ", ";
      put_point(extents, extent.data() + 3);
      extents += "],\n";
      stream << text;
      text.clear();
    }
    text += "        }\n" + extents + "        }\n    }\n";
  }
  stream << text << "}\n";
}

}  // namespace resilin
