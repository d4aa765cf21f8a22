#include "latency.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "resilin/mesh/generators.hpp"
#include "viewer/page_client.hpp"
#include "viewer/served_live_scene.hpp"
#include "viewer/served_page.hpp"

namespace resilin::bench {
namespace {

using Clock = std::chrono::steady_clock;
using viewer::PageClient;
using Measurements = std::vector<std::pair<std::string, double>>;

/// Six squares of n^2 cells around the unit cube, each of two triangles. Corners and edges are there once for
/// each square.
Mesh cube_surface(int n) {
  Mesh mesh;
  std::vector<Index>& triangles = mesh.block(CellKind::triangle).nodes;
  for (int side = 0; side < 6; ++side) {
    const int normal = side / 2, u = (normal + 1) % 3, v = (normal + 2) % 3;
    const auto first = static_cast<Index>(mesh.vertices.size());
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        Vector3& vertex = mesh.vertices.emplace_back();
        vertex[normal] = side % 2;
        vertex[u] = static_cast<double>(i) / n;
        vertex[v] = static_cast<double>(j) / n;
      }
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Index a = first + i + (n + 1) * j, b = a + 1, c = b + n + 1, d = a + n + 1;
        const bool is_upper = side % 2 == 1;
        for (const Index node : is_upper ? std::array{a, b, c, a, c, d} : std::array{a, c, b, a, d, c}) {
          triangles.push_back(node);
        }
      }
    }
  }
  return mesh;
}

/// A hand that moves on a circle, at the rate of a mouse and not in step with frames.
class Hand {
 public:
  Hand(PageClient& page, const Vector3& grabbed, int num_drags)
      : page_(&page), grabbed_(grabbed), sent_(static_cast<std::size_t>(num_drags) + 1) {}

  void move() {
    for (std::size_t number = 1; number < sent_.size(); ++number) {
      const double angle = 0.05 * static_cast<double>(number);
      const Vector3 target = grabbed_ + 0.1 * Vector3(std::cos(angle), std::sin(angle), 0.5);
      {
        const std::lock_guard lock(mutex_);
        sent_[number] = Clock::now();
        page_->drag(static_cast<std::uint32_t>(number), static_cast<float>(target.x()),
                    static_cast<float>(target.y()), static_cast<float>(target.z()));
      }
      std::this_thread::sleep_for(std::chrono::microseconds(9700));
    }
  }

  /// Milliseconds since the drag was sent.
  double age(std::size_t number) {
    const std::lock_guard lock(mutex_);
    return std::chrono::duration<double, std::milli>(Clock::now() - sent_[number]).count();
  }

  void acknowledge(std::uint32_t frame) {
    const std::lock_guard lock(mutex_);
    page_->acknowledge(frame);
  }

 private:
  std::mutex mutex_;  // one message at a time, and the times
  PageClient* page_;
  Vector3 grabbed_;
  std::vector<Clock::time_point> sent_;
};

void measure(int n, int num_drags, const std::string& name, Measurements& measurements) {
  auto scene = std::make_unique<viewer::ServedLiveScene>([n] { return Scene{cube_with_skin(n), {}}; });
  const int num_vertices = 6 * (n + 1) * (n + 1);
  const viewer::LiveServer live(std::move(scene), {});
  PageClient page(live.server().port(), live.server().token());
  page.send_text(R"({"type": "field", "name": "averaged_von_mises"})");
  // The middle of the upper side, the last of the six.
  const int vertex = num_vertices - (n + 1) * (n + 1) / 2;
  page.send_text(R"({"type": "grab", "vertex": )" + std::to_string(vertex) + R"(, "point": [0.5, 0.5, 1]})");
  for (int i = 0; i < 20; ++i) page.receive_frame();

  Hand hand(page, {0.5, 0.5, 1}, num_drags);
  const Clock::time_point begin = Clock::now();
  std::thread mover([&hand] { hand.move(); });
  std::vector<double> latencies;
  int num_frames = 0;
  std::size_t bytes = 0;
  while (static_cast<int>(latencies.size()) < num_drags) {
    const std::string frame = page.receive_frame(false);
    const std::size_t answered = viewer::answered_drag(frame);
    while (latencies.size() < answered) latencies.push_back(hand.age(latencies.size() + 1));
    hand.acknowledge(viewer::frame_number(frame));
    bytes = frame.size();
    ++num_frames;
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  mover.join();
  const auto status = nlohmann::json::parse(page.receive_text("status"));

  std::ranges::sort(latencies);
  measurements.emplace_back(name + ", vertices", num_vertices);
  measurements.emplace_back(name + ", bytes of a frame", static_cast<double>(bytes));
  measurements.emplace_back(name + ", median latency ms", latencies[latencies.size() / 2]);
  measurements.emplace_back(name + ", 95 % latency ms", latencies[latencies.size() * 95 / 100]);
  measurements.emplace_back(name + ", frames per second", num_frames / seconds);
  measurements.emplace_back(name + ", last step ms", status["step_ms"].get<double>());
  measurements.emplace_back(name + ", last surface ms", status["surface_ms"].get<double>());
}

}  // namespace

Description cube_with_skin(int n) {
  Description scene;
  scene.title = "A cube with a skin";
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.end_time = 1;
  BodyDescription body;
  body.name = "cube";
  body.element = "P1";
  body.mesh = make_box({1, 1, 1}, {8, 8, 8});
  body.material.constants = {{"youngs_modulus", 2e4}, {"poissons_ratio", 0.4}};
  body.skin.emplace();
  body.skin->surface = cube_surface(n);
  scene.bodies.push_back(std::move(body));
  FixDescription floor;
  floor.name = "floor";
  floor.where.kind = Where::Kind::plane;
  floor.where.axis = 2;
  floor.where.at = 0;
  scene.fixes.push_back(floor);
  LoadDescription weight;
  weight.kind = "body_force";
  weight.value = {0, 0, -9810};
  scene.loads.push_back(weight);
  return scene;
}

std::vector<std::pair<std::string, double>> measure_latency() {
  Measurements measurements;
  measure(40, 400, "10,000", measurements);
  measure(128, 400, "100,000", measurements);
  return measurements;
}

}  // namespace resilin::bench
