#include "scene_value.hpp"

#include <nanobind/stl/string.h>

#include <cstdint>
#include <memory>
#include <string>

#include "resilin/io/mesh_file.hpp"
#include "resilin/scene/csv.hpp"

namespace resilin::python {
namespace {

SceneValue::Table table_of(const nb::dict& dict) {
  SceneValue::Table table;
  for (const auto [key, value] : dict) table.push_back({nb::cast<std::string>(key), scene_value(value)});
  return table;
}

SceneValue::Array array_of(const nb::list& list) {
  SceneValue::Array array;
  array.reserve(list.size());
  for (const nb::handle entry : list) array.push_back(scene_value(entry));
  return array;
}

SceneValue::Numbers numbers_of(nb::handle object) {
  const auto array = nb::cast<Array2d<double>>(object);
  return std::make_shared<const NumberTable>(
      NumberTable{.num_columns = array.shape(1),
                  .values = std::vector<double>(array.data(), array.data() + array.size())});
}

}  // namespace

SceneValue scene_value(nb::handle object) {
  SceneValue value;
  if (nb::isinstance<nb::dict>(object)) {
    value.data = table_of(nb::borrow<nb::dict>(object));
  } else if (nb::isinstance<nb::list>(object)) {
    value.data = array_of(nb::borrow<nb::list>(object));
  } else if (nb::isinstance<nb::str>(object)) {
    value.data = nb::cast<std::string>(object);
  } else if (nb::isinstance<nb::bool_>(object)) {  // before int, of which bool is a kind
    value.data = nb::cast<bool>(object);
  } else if (nb::isinstance<nb::int_>(object)) {
    value.data = nb::cast<std::int64_t>(object);
  } else if (nb::isinstance<nb::float_>(object)) {
    value.data = nb::cast<double>(object);
  } else if (nb::isinstance<MeshFile>(object)) {
    value.data = std::make_shared<const MeshFile>(nb::cast<const MeshFile&>(object));
  } else {
    value.data = numbers_of(object);
  }
  return value;
}

}  // namespace resilin::python
