#include "resilin/picture/camera.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
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
  throw InputError("view", join(view_names()) + " or a direction such as 1,-2,1", "\"" + text + "\"",
                   did_you_mean(text, view_names()));
}

}  // namespace

std::vector<std::string> view_names() {
  std::vector<std::string> names;
  for (const View& view : views) names.emplace_back(view.name);
  return names;
}

Camera make_camera(int dimension, const std::string& view, const std::string& vertical) {
  if (vertical.size() != 1 || vertical[0] < 'x' || vertical[0] > 'z')
    throw InputError("up", "x, y or z", "\"" + vertical + "\"");
  if (dimension == 2) return {Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  const Vector3 up = Vector3::Unit(vertical[0] - 'x');
  const Vector3 right = vertical == "x" ? Vector3(Vector3::UnitY()) : Vector3(Vector3::UnitX());
  const Vector3 front = right.cross(up);
  Vector3 toward = Vector3::Zero();
  for (const View& named : views)
    if (view == named.name) toward = named.eye[0] * right + named.eye[1] * up + named.eye[2] * front;
  if (toward.isZero()) toward = parse_direction(view);
  toward.normalize();
  // Straight from above or below, the back (or the front) is up in the picture.
  const double height = toward.dot(up);
  const Vector3 hint = std::abs(height) > 0.999 ? Vector3((height > 0 ? -1 : 1) * front) : up;
  const Vector3 to_the_right = hint.cross(toward).normalized();
  return {to_the_right, toward.cross(to_the_right), toward};
}

}  // namespace resilin
