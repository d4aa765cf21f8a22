#include "resilin/contact/friction_slopes.hpp"

#include "resilin/contact/mollified_slip.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

FrictionSlopes::FrictionSlopes(int dim, std::span<const FrictionSource* const> sources, const VectorX& x,
                               const VectorX& start, const VectorX& still, double time, double eps,
                               const Conditions& c)
    : dim_(dim) {
  const MollifiedSlip mollified{eps};
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  for (std::size_t s = 0; s < sources.size(); ++s) {
    first_coefficient_.push_back(first_coefficient_.back() + sources[s]->num_coefficients());
    first_stiffness_.push_back(first_stiffness_.back() + sources[s]->num_stiffnesses());
    std::vector<FrictionContactSlopes> found;
    sources[s]->add_friction_slopes(x, start, c, found);
    for (FrictionContactSlopes& of : found) {
      const FrictionContact& contact = of.contact;
      const Vector3& n = contact.normal;
      std::vector<Vector3> ways;
      Vector3 way = -time * contact.velocity;
      for (const FrictionContactSlopes::Vertex& vertex : of.vertices) {
        ways.push_back(at(vertex.nodes, x) - at(vertex.nodes, still));
        way += vertex.weight * ways.back();
      }
      // g = L c(|u|) u with u = (1 - n n^T) way
      const Vector3 u = way - way.dot(n) * n;
      const double y = u.norm(), over_slip = mollified.slope_over_slip(y);
      Eigen::Matrix3d by_slip = contact.limit * over_slip * I;
      if (y > 0) by_slip -= contact.limit * over_slip * mollified.fall_of_slope(y) / y * u * u.transpose();
      const Eigen::Matrix3d by_way = by_slip * (I - n * n.transpose());
      const Eigen::Matrix3d by_normal = -by_slip * (n * way.transpose() + n.dot(way) * I);
      Contact made{.of = std::move(of),
                   .source = s,
                   .g = contact.limit * over_slip * u,
                   .by_still = -by_way,
                   .by_rate = Eigen::Matrix3d::Zero(),
                   .by_place = {}};
      made.by_rate = -time * made.of.share_of_rate * by_way;
      for (const FrictionContactSlopes::Place& place : made.of.places) {
        Eigen::Matrix3d of_way = -time * place.velocity;
        for (std::size_t i = 0; i < place.weights.size(); ++i)
          of_way += ways[i] * place.weights[i].transpose();
        made.by_place.emplace_back(over_slip * u * place.limit.transpose() + by_normal * place.normal +
                                   by_way * of_way);
      }
      contacts_.push_back(std::move(made));
    }
  }
}

Vector3 FrictionSlopes::at(const std::vector<WeightedNode>& nodes, const VectorX& x) const {
  Vector3 sum = Vector3::Zero();
  for (const auto& [node, weight] : nodes) sum += weight * node_position(dim_, node, x);
  return sum;
}

void FrictionSlopes::add_to_nodes(const std::vector<WeightedNode>& nodes, const Vector3& value,
                                  VectorX& x) const {
  for (const auto& [node, weight] : nodes)
    x.segment(Eigen::Index{node} * dim_, dim_) += weight * value.head(dim_);
}

void FrictionSlopes::add_forces(const Change& change, double weight, VectorX& gradient) const {
  for (const Contact& contact : contacts_) {
    const FrictionContactSlopes& of = contact.of;
    const auto source = 3 * static_cast<Eigen::Index>(contact.source);
    Vector3 dg = Vector3::Zero();
    double dlog_limit = 0;
    if (change.coefficients.size() > 0)
      dlog_limit += change.coefficients[first_coefficient_[contact.source] + of.coefficient] / of.mu;
    if (change.stiffness.size() > 0)
      for (const auto& [number, slope] : of.stiffness)
        dlog_limit += slope * change.stiffness[first_stiffness_[contact.source] + number] / of.contact.limit;
    dg += dlog_limit * contact.g;
    if (change.still.size() > 0)
      for (const FrictionContactSlopes::Vertex& vertex : of.vertices)
        dg += contact.by_still * (vertex.weight * at(vertex.nodes, change.still));
    if (change.rates.size() > 0) dg += contact.by_rate * change.rates.segment<3>(source);
    for (std::size_t j = 0; j < of.places.size(); ++j) {
      const FrictionContactSlopes::Place& place = of.places[j];
      Vector3 moved = Vector3::Zero();
      if (place.nodes.empty()) {
        if (change.shifts.size() > 0) moved = change.shifts.segment<3>(source);
      } else if (const VectorX& of_nodes = place.is_at_start ? change.start : change.lag;
                 of_nodes.size() > 0) {
        moved = at(place.nodes, of_nodes);
      }
      if (moved.isZero(0)) continue;
      dg += contact.by_place[j] * moved;
      for (std::size_t i = 0; i < place.weights.size(); ++i)
        add_to_nodes(of.vertices[i].nodes, weight * place.weights[i].dot(moved) * contact.g, gradient);
    }
    for (const FrictionContactSlopes::Vertex& vertex : of.vertices)
      add_to_nodes(vertex.nodes, weight * vertex.weight * dg, gradient);
  }
}

void FrictionSlopes::add_slopes(const VectorX& w, double weight, Change& slopes) const {
  for (const Contact& contact : contacts_) {
    const FrictionContactSlopes& of = contact.of;
    const auto source = 3 * static_cast<Eigen::Index>(contact.source);
    std::vector<Vector3> of_vertices;
    Vector3 by_g = Vector3::Zero();
    for (const FrictionContactSlopes::Vertex& vertex : of.vertices) {
      of_vertices.push_back(weight * at(vertex.nodes, w));
      by_g += vertex.weight * of_vertices.back();
    }
    const double along = by_g.dot(contact.g);
    if (slopes.coefficients.size() > 0)
      slopes.coefficients[first_coefficient_[contact.source] + of.coefficient] += along / of.mu;
    if (slopes.stiffness.size() > 0)
      for (const auto& [number, slope] : of.stiffness)
        slopes.stiffness[first_stiffness_[contact.source] + number] += slope * along / of.contact.limit;
    if (slopes.still.size() > 0)
      for (const FrictionContactSlopes::Vertex& vertex : of.vertices)
        add_to_nodes(vertex.nodes, vertex.weight * (contact.by_still.transpose() * by_g), slopes.still);
    if (slopes.rates.size() > 0) slopes.rates.segment<3>(source) += contact.by_rate.transpose() * by_g;
    for (std::size_t j = 0; j < of.places.size(); ++j) {
      const FrictionContactSlopes::Place& place = of.places[j];
      VectorX& to = place.nodes.empty() ? slopes.shifts : place.is_at_start ? slopes.start : slopes.lag;
      if (to.size() == 0) continue;
      Vector3 by_place = contact.by_place[j].transpose() * by_g;
      for (std::size_t i = 0; i < place.weights.size(); ++i)
        by_place += of_vertices[i].dot(contact.g) * place.weights[i];
      if (place.nodes.empty()) {
        to.segment<3>(source) += by_place;
      } else {
        add_to_nodes(place.nodes, by_place, to);
      }
    }
  }
}

}  // namespace resilin
