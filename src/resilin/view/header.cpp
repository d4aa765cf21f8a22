#include "resilin/view/header.hpp"

#include <nlohmann/json.hpp>

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
          {"num_edges", part.num_edges}};
}

Json collider_json(const ShownCollider& collider, int dimension) {
  const auto num_facets = collider.mesh.facets.size() / static_cast<std::size_t>(dimension);
  return {{"name", collider.name},
          {"num_vertices", collider.mesh.vertices.size()},
          {"num_facets", num_facets},
          {"closed", collider.is_closed},
          {"endless", collider.is_endless}};
}

Json field_json(const ScalarField& field) {
  return {{"name", field.name}, {"label", field.label}, {"unit", field.field->unit}, {"group", field.group}};
}

Json fields_json(std::span<const ScalarField> fields) {
  Json list = Json::array();
  for (const ScalarField& field : fields) list.push_back(field_json(field));
  return list;
}

}  // namespace

std::string encode_fields(std::span<const ScalarField> fields) { return fields_json(fields).dump(); }

std::string encode_field_info(const ScalarField& field) { return field_json(field).dump(); }

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
  if (header.ground) json["ground"] = *header.ground;
  json["fields"] = fields_json(header.fields);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace resilin
