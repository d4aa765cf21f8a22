#include "resilin/live/held_face.hpp"

#include <algorithm>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/live/live_contents.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/selection.hpp"
#include "resilin/world/support.hpp"

namespace resilin {

int LiveScene::hold(std::size_t body, std::vector<Index> vertices) {
  Contents& c = *contents_;
  const std::size_t num_bodies = c.world.bodies.size();
  if (body >= num_bodies)
    throw InputError("hold: body", "a number from 0 to " + std::to_string(num_bodies - 1),
                     std::to_string(body));
  const Body& held_body = c.world.bodies[body];
  Where where;
  where.kind = Where::Kind::vertices;
  where.vertices = vertices;
  HeldFace face{.number = 1, .body = body, .vertices = std::move(vertices), .nodes = {}};
  if (const RigidShape* rigid = held_body.rigid.get()) {
    select_vertices(where, rigid->mesh, rigid->body, rigid->rest_positions, c.world.dimension, "hold");
    for (Index node = 0; node < held_body.num_nodes; ++node)
      face.nodes.push_back(held_body.first_node + node);
  } else {
    for (const Index v : select_vertices(where, c.description.bodies[body].mesh, held_body,
                                         c.world.rest_positions, c.world.dimension, "hold"))
      face.nodes.push_back(held_body.first_node + v);
  }
  std::vector<Support> supports = c.world.supports;
  Support& own = supports.emplace_back();
  own.place = own.name = "held face";
  own.nodes = face.nodes;
  check_support_conflicts(c.world.dimension, supports, c.world.rest_positions);
  if (!c.held_faces.empty()) face.number = c.held_faces.back().number + 1;
  c.held_faces.push_back(std::move(face));
  c.renew_fixed();
  c.wake();
  return c.held_faces.back().number;
}

void LiveScene::let_go(int number) {
  const auto is_it = [number](const HeldFace& face) { return face.number == number; };
  if (std::erase_if(contents_->held_faces, is_it) == 0) return;
  contents_->renew_fixed();
  contents_->wake();
}

const std::vector<HeldFace>& LiveScene::held_faces() const { return contents_->held_faces; }

}  // namespace resilin
