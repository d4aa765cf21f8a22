#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

int read_axis(const SceneNode& node) {
  const std::string letters = std::string("xyz").substr(0, static_cast<std::size_t>(node.context->dimension));
  const std::string text = read_text(node);
  if (text.size() != 1 || letters.find(text) == std::string::npos) {
    node.fail("\"x\", \"y\"" + std::string(node.context->dimension == 3 ? " or \"z\"" : " (2D)"));
  }
  return text[0] - 'x';
}

Keys<Where> plane_keys() {
  return {
      key<Where>({"axis", "\"x\", \"y\" or \"z\"", "", "required", "Normal of the plane."},
                 [](const SceneNode& node, Where& w) { w.axis = read_axis(node); }),
      key<Where>({"at", "number", "m", "required", "Coordinate of the plane."},
                 [](const SceneNode& node, Where& w) { w.at = read_number(node); }),
      key<Where>({"tolerance", "number >= 0", "m", "1e-6 of the body's extent", "Half thickness."},
                 [](const SceneNode& node, Where& w) { w.tolerance = read_number(node, not_negative); }),
  };
}

Keys<Where> sphere_keys() {
  return {
      key<Where>({"center", "vector", "m", "required", "Its centre."},
                 [](const SceneNode& node, Where& w) { w.center = read_vector(node); }),
      key<Where>({"radius", "number >= 0", "m", "required", "Its radius, boundary included."},
                 [](const SceneNode& node, Where& w) { w.radius = read_number(node, not_negative); }),
  };
}

void read_corners(const SceneNode& node, Where& where) {
  where.kind = Where::Kind::box;
  expect_list(node, "corners [min, max]", 2);
  where.min = read_vector(node.element(0));
  where.max = read_vector(node.element(1));
  for (int i = 0; i < node.context->dimension; ++i) {
    if (where.min[i] > where.max[i]) {
      node.fail_with("expected [min, max] with min <= max, got min > max in " +
                     std::string(1, static_cast<char>('x' + i)));
    }
  }
}

void read_vertices(const SceneNode& node, Where& where) {
  where.kind = Where::Kind::vertices;
  expect_list(node, "vertex numbers from 0");
  for (std::size_t i = 0; i < node.value->array().size(); ++i) {
    where.vertices.push_back(read_integer(node.element(i), not_negative));
  }
}

Keys<Where> where_keys() {
  return {
      key<Where>({"all", "true", "", "", "Every vertex; `where = \"all\"` is the same."},
                 [](const SceneNode& node, Where& w) {
                   w.kind = Where::Kind::all;
                   if (!read_flag(node)) node.fail("true");
                 }),
      key<Where>({"group", "text", "", "", "A physical group of the mesh; boxes have `x_min`, `x_max`, ..."},
                 [](const SceneNode& node, Where& w) {
                   w.kind = Where::Kind::group;
                   w.group = read_text(node);
                 }),
      key<Where>({"box", "[min, max]", "m", "", "Between two corners, boundary included."}, read_corners),
      key<Where>({"plane", "{ axis, at, tolerance }", "m", "", "Within `tolerance` of axis = at."},
                 [](const SceneNode& node, Where& w) {
                   w.kind = Where::Kind::plane;
                   read_table(node, plane_keys(), w);
                 }),
      key<Where>({"sphere", "{ center, radius }", "m", "", "In a ball."},
                 [](const SceneNode& node, Where& w) {
                   w.kind = Where::Kind::sphere;
                   read_table(node, sphere_keys(), w);
                 }),
      key<Where>({"vertices", "list of whole numbers", "", "", "Vertex numbers of the mesh, from 0."},
                 read_vertices),
      key<Where>({"face_at", "vector", "m", "",
                  "The face of the surface at this point: all that is reached without a sharp edge."},
                 [](const SceneNode& node, Where& w) {
                   w.kind = Where::Kind::face;
                   w.face_at = read_vector(node);
                 }),
      key<Where>({"normal", "vector", "", "",
                  "Facets with this outward normal alone; alone or beside one of the others."},
                 [](const SceneNode& node, Where& w) {
                   w.normal = read_vector(node);
                   if (w.normal->norm() == 0) node.fail("a direction", "it has no length");
                 }),
      key<Where>(
          {"angle", "number from 0 to 180", "degrees", "35",
           "With face_at: the sharp edge at which the face ends. With normal: how far others may differ."},
          [](const SceneNode& node, Where& w) { w.angle = read_number(node, not_negative); }),
  };
}

Keys<Rotation> rotation_keys() {
  using R = Rotation;
  return {
      key<R>({"axis", "vector", "", "z", "Rotation axis; only in 3D."},
             [](const SceneNode& node, R& r) {
               if (node.context->dimension == 2) node.fail_with("a rotation in 2D has no axis; leave it out");
               r.axis = read_vector(node);
               if (r.axis.norm() == 0) node.fail("a direction", "it has no length");
             }),
      vector_key("center", &R::center, "m", "A fixed point of the rotation."),
      key<R>(
          {"degrees", "number", "degrees", "required", "Angle, counter-clockwise if the axis points at you."},
          [](const SceneNode& node, R& r) { r.degrees = read_number(node); }),
  };
}

}  // namespace

void read_where(const SceneNode& node, Where& where) {
  if (const auto* word = std::get_if<std::string>(&node.value->data); word != nullptr && *word == "all") {
    where.kind = Where::Kind::all;
    return;
  }
  const auto fail = [&] {
    node.fail(
        "\"all\" or a table with one of all, group, box, plane, sphere, vertices, face_at, and maybe normal",
        "such as where = { plane = { axis = \"x\", at = 0 } }");
  };
  if (!node.value->is_table()) fail();
  const std::size_t num_beside = (node.has("normal") ? 1 : 0) + (node.has("angle") ? 1 : 0);
  const std::size_t num_kinds = node.value->table().size() - num_beside;
  if (num_kinds > 1 || (num_kinds == 0 && !node.has("normal"))) fail();
  read_table(node, where_keys(), where);
  if (node.has("angle") && !where.means_facets())
    node.child("angle").fail_with("belongs to face_at or normal");
  if (where.angle > 180) node.child("angle").fail("a number from 0 to 180");
}

TableDoc where_doc() {
  TableDoc doc = document("where",
                          "Selection of vertices of a body in its reference configuration, after scale, "
                          "rotate and translate: one of",
                          where_keys());
  for (const Key<Where>& key : plane_keys()) {
    doc.keys.push_back(key.doc);
    doc.keys.back().name = "plane." + key.doc.name;
  }
  for (const Key<Where>& key : sphere_keys()) {
    doc.keys.push_back(key.doc);
    doc.keys.back().name = "sphere." + key.doc.name;
  }
  return doc;
}

void read_rotation(const SceneNode& node, std::optional<Rotation>& rotation) {
  rotation.emplace();
  if (!node.value->is_array()) return read_table(node, rotation_keys(), *rotation);
  const bool is_3d = node.context->dimension == 3;
  expect_list(node, is_3d ? "numbers [axis_x, axis_y, axis_z, degrees]" : "number [degrees] in 2D",
              is_3d ? 4 : 1);
  if (is_3d) {
    for (int i = 0; i < 3; ++i) rotation->axis[i] = read_number(node.element(static_cast<std::size_t>(i)));
    if (rotation->axis.norm() == 0)
      node.fail_with("expected a direction and an angle, got a direction without length");
  }
  rotation->degrees = read_number(node.element(is_3d ? 3 : 0));
}

TableDoc rotation_doc() {
  return document("rotate",
                  "A rotation: a table, or in short `[axis_x, axis_y, axis_z, degrees]` (in 2D `[degrees]`).",
                  rotation_keys());
}

}  // namespace resilin
