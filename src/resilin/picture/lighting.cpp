#include "resilin/picture/lighting.hpp"

#include <algorithm>

namespace resilin {

double light(const Vector3& normal) {
  static const Vector3 lamp = Vector3(-0.35, 0.55, 0.75).normalized();
  const Vector3 seen = normal.z() < 0 ? Vector3(-normal) : normal;
  return std::clamp(0.45 + 0.6 * seen.dot(lamp), 0.0, 1.0);
}

Color shaded(Color color, double brightness) { return mix({0, 0, 0}, color, 0.35 + 0.65 * brightness); }

Color shaded_field(Color color, double brightness) {
  return mix({0, 0, 0}, color, 0.78 + 0.22 * std::min(1.2 * brightness, 1.0));
}

}  // namespace resilin
