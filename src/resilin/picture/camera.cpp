#include "resilin/picture/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// How far to the right, up and towards the viewer of the front the eye stands.
struct View {
  const char* name;
  std::array<double, 3> eye;
};
constexpr View views[] = {{"iso", {0.45, 0.5, 1}}, {"front", {0, 0, 1}}, {"back", {0, 0, -1}},
                          {"right", {1, 0, 0}},    {"left", {-1, 0, 0}}, {"top", {0, 1, 0}},
                          {"bottom", {0, -1, 0}}};

Vector3 parse_direction(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  Vector3 direction;
  char comma = ',', rest = 0;
  bool is_good = static_cast<bool>(stream >> direction[0]);
  for (int i = 1; i < 3; ++i) is_good = is_good && stream >> comma >> direction[i] && comma == ',';
  if (is_good && !(stream >> rest) && direction.allFinite() && direction.norm() > 0) return direction;
  throw InputError("view", "auto, " + join(view_names()) + " or a direction such as 1,-2,1",
                   "\"" + text + "\"", did_you_mean(text, view_names()));
}

struct GroundAxes {
  Vector3 up, right, front;  ///< up, right and front of length 1, at right angles
};

GroundAxes ground_axes(const Vector3& vertical) {
  const Vector3 up = vertical.normalized();
  Vector3 right = std::abs(up.x()) > 0.9 ? Vector3(Vector3::UnitY()) : Vector3(Vector3::UnitX());
  right = (right - right.dot(up) * up).normalized();
  return {up, right, right.cross(up)};
}

Camera camera_from(const Vector3& direction, const Vector3& up, const Vector3& front) {
  const Vector3 toward = direction.normalized();
  // Straight from above or below, the back (or the front) is up in the picture.
  const double height = toward.dot(up);
  const Vector3 hint = std::abs(height) > 0.999 ? Vector3((height > 0 ? -1 : 1) * front) : up;
  const Vector3 to_the_right = hint.cross(toward).normalized();
  return {to_the_right, toward.cross(to_the_right), toward};
}

}  // namespace

std::vector<std::string> view_names() {
  std::vector<std::string> names;
  for (const View& view : views) names.emplace_back(view.name);
  return names;
}

Vector3 axis_of(const std::string& letter) {
  if (letter.size() != 1 || letter[0] < 'x' || letter[0] > 'z')
    throw InputError("up", "auto, x, y or z", "\"" + letter + "\"");
  return Vector3::Unit(letter[0] - 'x');
}

Camera make_camera(int dimension, const std::string& view, const Vector3& vertical) {
  if (dimension == 2) return {Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  const auto [up, right, front] = ground_axes(vertical);
  Vector3 toward = Vector3::Zero();
  for (const View& named : views)
    if (view == named.name) toward = named.eye[0] * right + named.eye[1] * up + named.eye[2] * front;
  if (toward.isZero()) toward = parse_direction(view);
  return camera_from(toward, up, front);
}

Camera make_camera(const Vector3& toward, const Vector3& vertical) {
  const auto [up, right, front] = ground_axes(vertical);
  return camera_from(toward, up, front);
}

Vector3 page_direction(const Vector3& vertical, double turn, double elevation) {
  const auto [up, right, front] = ground_axes(vertical);
  // Most animals of graphics face -z where y is up.
  const Vector3 north = std::abs(up.y()) > 0.9 ? Vector3(-front) : front;
  const Vector3 east = up.cross(north);
  constexpr double first = 0.55;
  return std::cos(elevation) * (std::cos(first + turn) * north + std::sin(first + turn) * east) +
         std::sin(elevation) * up;
}

Vector3 telling_direction(const std::vector<Vector3>& triangles, const std::vector<Vector3>& moved,
                          const Vector3& up) {
  constexpr int num_turns = 8;
  struct Candidate {
    Vector3 toward;
    double preference, area, motion;
  };
  std::vector<Candidate> candidates;
  for (const double elevation : {0.28, 0.85})
    for (int k = 0; k < num_turns; ++k) {
      const bool is_first = k == 0 && elevation < 0.5, is_beside = k == 1 || k == num_turns - 1;
      candidates.push_back({page_direction(up, 2 * std::numbers::pi * k / num_turns, elevation),
                            is_first    ? 1
                            : is_beside ? 0.9
                                        : 0.85,
                            0, 0});
    }
  for (Candidate& candidate : candidates) {
    for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
      const Vector3 area = 0.5 * (triangles[i + 1] - triangles[i]).cross(triangles[i + 2] - triangles[i]);
      candidate.area += std::abs(area.dot(candidate.toward));
      if (moved.empty()) continue;
      const Vector3 u = (moved[i] + moved[i + 1] + moved[i + 2]) / 3;
      candidate.motion += area.norm() * (u - u.dot(candidate.toward) * candidate.toward).squaredNorm();
    }
  }
  const auto best_of = [&](double Candidate::* measure) {
    const double most = std::ranges::max(candidates, {}, measure).*measure;
    return most > 0 ? most : 1;
  };
  const double most_area = best_of(&Candidate::area), most_motion = best_of(&Candidate::motion);
  const auto score = [&](const Candidate& c) {
    return c.preference * (0.6 * c.area / most_area + 0.4 * std::sqrt(c.motion / most_motion));
  };
  return std::ranges::max(candidates, {}, score).toward;
}

}  // namespace resilin
