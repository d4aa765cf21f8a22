#include "resilin/live/live_scene.hpp"

#include <algorithm>
#include <utility>

#include "resilin/contact/sphere.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/live/hand_patch.hpp"
#include "resilin/live/live_contents.hpp"

namespace resilin {

LiveScene::LiveScene(const Description& description, const std::optional<State>& start)
    : contents_(std::make_unique<Contents>(description, start)) {}
LiveScene::~LiveScene() = default;
LiveScene::LiveScene(LiveScene&&) noexcept = default;
LiveScene& LiveScene::operator=(LiveScene&&) noexcept = default;

const World& LiveScene::world() const { return contents_->world; }
const State& LiveScene::state() const { return contents_->state; }
Conditions LiveScene::conditions() const { return contents_->conditions(); }
std::optional<LiveContact> LiveScene::contact() const { return contents_->contact(); }
const LiveControls& LiveScene::controls() const { return contents_->controls; }
const LiveReport& LiveScene::report() const { return contents_->report; }
void LiveScene::set_controls(const LiveControls& controls) { contents_->set_controls(controls); }
const std::vector<BodyControls>& LiveScene::materials() const { return contents_->materials; }
const ContactDescription& LiveScene::contact_choices() const { return contents_->description.contact; }

void LiveScene::set_material(std::size_t body, const BodyControls& material) {
  std::vector<BodyControls> materials = contents_->materials;
  if (body >= materials.size())
    throw InputError("body", "a number from 0 to " + std::to_string(materials.size() - 1),
                     std::to_string(body));
  if (const Body& chosen = contents_->world.bodies[body]; chosen.rigid)
    throw InputError("material", "a deformable body", "the rigid body \"" + chosen.name + '"');
  materials[body] = material;
  LiveControls controls = with_material(contents_->controls, materials.front());
  contents_->take_over(std::move(controls), std::move(materials));
}

void LiveScene::reset() { contents_->reset(); }

void LiveScene::grab(MaterialPoint place, const Vector3& target) {
  if (!target.allFinite()) throw InputError("grab", "a finite place", "inf or nan");
  contents_->held = Held{std::move(place), target};
  contents_->is_as_run = false;
  contents_->wake();
}

void LiveScene::drag(const Vector3& target) {
  std::optional<Held>& held = contents_->held;
  if (!target.allFinite()) throw InputError("drag", "a finite place", "inf or nan");
  if (!held || held->target == target) return;
  held->target = target;
  contents_->wake();
}

void LiveScene::release() {
  if (contents_->held) contents_->wake();
  contents_->held.reset();
}

bool LiveScene::is_grabbed() const { return contents_->held.has_value(); }

Vector3 LiveScene::hand_force() const { return contents_->hand_force(); }

void LiveScene::pin(Index node, const std::optional<MaterialPoint>& place) {
  std::vector<Index>& pinned = contents_->pinned;
  if (node < 0 || node >= contents_->world.num_nodes())
    throw InputError("pin", "a node from 0 to " + std::to_string(contents_->world.num_nodes() - 1),
                     std::to_string(node));
  // Points of a rigid body far apart may have the same node: the newest one is held.
  const bool is_new = std::ranges::find(pinned, node) == pinned.end();
  const bool is_of_rigid_body = contents_->world.body_of(node).rigid != nullptr;
  if (!is_new && !is_of_rigid_body) return;
  if (is_new) pinned.push_back(node);
  const int dim = contents_->world.dimension;
  if (is_of_rigid_body)
    contents_->pinned_points[node] = hand_patch(contents_->world, place.value_or(MaterialPoint{{node}, {1}}));
  else
    contents_->state.velocities.segment(Eigen::Index{node} * dim, dim).setZero();
  contents_->renew_fixed();
  contents_->wake();
}

void LiveScene::unpin(Index node) {
  if (std::erase(contents_->pinned, node) == 0) return;
  contents_->pinned_points.erase(node);
  contents_->renew_fixed();
  contents_->wake();
}

void LiveScene::unpin_all() {
  contents_->pinned.clear();
  contents_->pinned_points.clear();
  contents_->renew_fixed();
  contents_->wake();
}

const std::vector<Index>& LiveScene::pinned() const { return contents_->pinned; }

const std::vector<Drive>& LiveScene::drives() const { return contents_->drives.all(); }

void LiveScene::drive(std::size_t number, double value) {
  contents_->drives.set_goal(number, value, contents_->conditions());
  contents_->wake();
}

void LiveScene::stop_driving() {
  contents_->drives.leave(contents_->world);
  contents_->drives.follow_scene(contents_->conditions());
  contents_->renew_terms();
  contents_->wake();
}

void LiveScene::poke(const Vector3& center, double radius) {
  Contents& c = *contents_;
  if (!center.allFinite() || !(radius > 0) || !(radius <= 1e3 * c.extent))
    throw InputError("poke", "a finite place and a positive radius of at most a thousand extents",
                     "radius " + format_number(radius));
  if (!c.ball || c.ball_radius != radius) {
    Vector3 middle = Vector3::Zero();
    for (Index node = 0; node < c.world.num_nodes(); ++node)
      middle += node_position(c.world.dimension, node, c.state.positions) / c.world.num_nodes();
    const Vector3 out = center - middle;
    c.ball.emplace("ball", c.world, c.state.positions, std::make_shared<Sphere>(center, radius),
                   out.norm() > 0 ? Vector3(out.normalized()) : c.up);
    c.ball_radius = radius;
    c.is_as_run = false;
    c.renew_terms();
  }
  c.ball->set_goal(center);
  c.wake();
}

void LiveScene::stop_poking() {
  if (!contents_->ball) return;
  contents_->ball.reset();
  contents_->renew_terms();
  contents_->wake();
}

std::optional<Vector3> LiveScene::ball() const {
  const auto& ball = contents_->ball;
  if (!ball) return {};
  return ball->barrier()->place({});
}

std::optional<double> LiveScene::ground() const {
  const auto& floor = contents_->floor;
  if (!floor) return {};
  return floor->barrier()->place({}).dot(contents_->up);
}

Vector3 LiveScene::up() const { return contents_->up; }

void LiveScene::place(const VectorX& positions, const VectorX& velocities, std::optional<double> time) {
  contents_->check_places(positions, velocities, "place");
  contents_->state.positions = positions;
  contents_->state.velocities = velocities;
  if (time) contents_->state.time = *time;
  contents_->is_as_run = false;
  contents_->look_at_cells();
  contents_->wake();
}

const LiveReport& LiveScene::step(const StepBudget& budget) {
  contents_->step(budget);
  return contents_->report;
}

}  // namespace resilin
