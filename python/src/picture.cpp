#include "resilin/picture/picture.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "resilin/results/result_picture.hpp"

namespace resilin::python {
namespace {

NumpyArray<std::uint8_t> pixels(const Image& image) {
  return numpy_array(channels(image),
                     {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width),
                      static_cast<std::size_t>(num_channels(image))});
}

}  // namespace

void bind_picture(nb::module_& module) {
  nb::class_<PictureOptions>(module, "PictureOptions")
      .def(nb::init<>())
      .def_rw("field", &PictureOptions::field)
      .def_rw("width", &PictureOptions::width)
      .def_rw("height", &PictureOptions::height)
      .def_rw("range", &PictureOptions::range, nb::arg().none())
      .def_rw("map", &PictureOptions::map)
      .def_rw("view", &PictureOptions::view)
      .def_rw("up", &PictureOptions::up)
      .def_rw("scale", &PictureOptions::scale)
      .def_rw("edges", &PictureOptions::edges)
      .def_rw("rest", &PictureOptions::shows_rest)
      .def_rw("colliders", &PictureOptions::shows_colliders)
      .def_rw("bar", &PictureOptions::shows_bar)
      .def_rw("caption", &PictureOptions::shows_caption)
      .def_rw("dark", &PictureOptions::is_dark)
      .def_rw("transparent", &PictureOptions::is_transparent);
  nb::class_<Image>(module, "Image")
      .def("pixels", &pixels)
      .def("png",
           [](const Image& image) {
             const std::string bytes = encode_png(image);
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def(
          "save", [](const Image& image, const std::filesystem::path& path) { write_png(path, image); },
          nb::arg("path"));
  module.def("draw_result", &draw_result, nb::arg("place"), nb::arg("frame"), nb::arg("options"),
             nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace resilin::python
