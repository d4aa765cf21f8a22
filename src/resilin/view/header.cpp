#include "resilin/view/header.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "resilin/view/shown_connectors.hpp"
#include "resilin/view/shown_marks.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json part(const ShownSurface::Part& part) {
  return {{"name", part.name},
          {"body", part.name},
          {"kind", part.kind == ShownSurface::Kind::skin ? "skin" : "cells"},
          {"first_vertex", part.first_vertex},
          {"num_vertices", part.num_vertices},
          {"num_triangles", part.num_triangles},
          {"num_edges", part.num_edges},
          {"num_tetrahedra", part.num_tetrahedra}};
}

Json collider_json(const ShownCollider& collider, int dimension) {
  const auto num_facets = collider.mesh.facets.size() / static_cast<std::size_t>(dimension);
  return {{"name", collider.name},
          {"num_vertices", collider.mesh.vertices.size()},
          {"num_facets", num_facets},
          {"closed", collider.is_closed},
          {"endless", collider.is_endless}};
}

Json mark_json(const ShownMark& mark) {
  using enum ShownMark::Kind;
  Json json = {{"kind", mark.kind == support ? "support"
                        : mark.kind == load  ? "load"
                                             : "probe"},
               {"name", mark.name},
               {"vertices", mark.vertices}};
  if (mark.kind != load) return json;
  json["greatest"] = mark.greatest;
  if (!mark.course.at.empty())
    json["course"] = {{"over", mark.course.is_over_load ? "load" : "time"},
                      {"at", mark.course.at},
                      {"factors", mark.course.factors}};
  json["directions"] = Json::array();
  for (const Vector3& direction : mark.directions) json["directions"].push_back(numbers(direction));
  return json;
}

Json connector_json(const ShownConnector& connector) {
  Json points = Json::array();
  for (const ShownConnector::Point& point : connector.points)
    points.push_back(point.vertices.empty() ? Json{{"at", numbers(point.place)}}
                                            : Json{{"vertices", point.vertices}, {"weights", point.weights}});
  return {{"kind", connector.kind},
          {"name", connector.name},
          {"points", std::move(points)},
          {"lines", connector.lines},
          {"dots", connector.dots}};
}

Json field_json(const ScalarField& field, const World& world) {
  return {{"name", field.name},
          {"label", field.label},
          {"unit", field.field->unit},
          {"group", field.group},
          {"scale", field_scale(*field.field, world)}};
}

Json fields_json(std::span<const ScalarField> fields, const World& world) {
  Json list = Json::array();
  for (const ScalarField& field : fields) list.push_back(field_json(field, world));
  return list;
}

}  // namespace

double field_scale(const FieldInfo& field, const World& world) {
  double stiffest = 0, fastest = 0;  // waves
  for (const Body& body : world.bodies) {
    for (const Domain& domain : body.domains) {
      if (domain.is_rigid) continue;
      const double modulus = body.rigid ? body.rigid->contact_modulus : youngs_modulus(domain);
      stiffest = std::max(stiffest, modulus);
      if (domain.density > 0) fastest = std::max(fastest, std::sqrt(modulus / domain.density));
    }
  }
  if (field.unit == "m") return world.largest_extent();
  if (field.unit == "m/s") return fastest;
  return field.unit.empty() ? 1 : stiffest;  // Pa, J/m^3
}

std::string encode_fields(std::span<const ScalarField> fields, const World& world) {
  return fields_json(fields, world).dump();
}

std::string encode_field_info(const ScalarField& field, const World& world) {
  return field_json(field, world).dump();
}

std::string encode_header(const ViewHeader& header, const World& world, const ShownSurface& surface) {
  Json json = {{"title", header.title},
               {"version", header.version},
               {"dimension", world.dimension},
               {"extent", world.largest_extent()},
               {"up", numbers(world.dimension == 2 ? Vector3::UnitY() : header.up)},
               {"gravity", numbers(header.gravity)},
               {"parts", Json::array()}};
  for (const ShownSurface::Part& shown : surface.parts()) json["parts"].push_back(part(shown));
  json["colliders"] = Json::array();
  for (const ShownCollider& collider : header.colliders)
    json["colliders"].push_back(collider_json(collider, world.dimension));
  json["marks"] = Json::array();
  for (const ShownMark& mark : shown_marks(world, surface)) json["marks"].push_back(mark_json(mark));
  const std::vector<ShownConnector> connectors = shown_connectors(world, surface);
  for (const ShownConnector& connector : connectors) json["connectors"].push_back(connector_json(connector));
  if (header.ground) json["ground"] = *header.ground;
  if (world.dimension == 2) json["forces_per_metre"] = !is_axisymmetric(world) && world.thickness == 1;
  if (is_axisymmetric(world)) json["axisymmetric"] = true;
  json["fields"] = fields_json(header.fields, world);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace resilin
