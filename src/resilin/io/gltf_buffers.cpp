#include "resilin/io/gltf_buffers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/percent_decoding.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/base64.hpp"
#include "resilin/io/binary_value.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t unsigned_byte = 5121, unsigned_short = 5123, unsigned_int = 5125, real = 5126;

std::size_t size_of_component(std::int64_t component) {
  if (component == unsigned_byte) return 1;
  return component == unsigned_short ? 2 : 4;
}

}  // namespace

std::size_t gltf_number(const Json& object, const char* key, const std::string& place,
                        std::size_t otherwise) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > (std::uint64_t{1} << 53))
    throw InputError(place + ": " + key, "a whole number from 0",
                     printable(found->dump(-1, ' ', true, Json::error_handler_t::replace)));
  return found->get<std::size_t>();
}

std::size_t gltf_number(const Json& object, const char* key, const std::string& place) {
  if (!object.is_object() || !object.contains(key))
    throw InputError(place, "\"" + std::string(key) + "\"", "none");
  return gltf_number(object, key, place, 0);
}

const Json& gltf_entry(const Json& root, const char* key, std::size_t number, const std::string& file) {
  const auto list = root.find(key);
  const std::size_t size = list != root.end() && list->is_array() ? list->size() : 0;
  if (number >= size || !(*list)[number].is_object())
    throw InputError(file + ": " + key, "an entry " + std::to_string(number),
                     size == 0 ? "none" : std::to_string(size) + " entries from 0");
  return (*list)[number];
}

GltfBuffers::GltfBuffers(const MeshSource& source, const Json& root, std::string_view binary)
    : source_(&source), root_(&root), binary_(binary) {}

std::string GltfBuffers::bytes_of_uri(const std::string& uri, const std::string& place) const {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == uri.npos) throw InputError(place, "data in base64", printable(uri));
    return decode_base64(std::string_view(uri).substr(comma + 8), std::numeric_limits<std::size_t>::max());
  }
  return source_->file_beside(percent_decoded(uri), place, "save it as .glb");
}

std::string_view GltfBuffers::buffer(std::size_t number) {
  const std::string place = source_->name + ": buffers " + std::to_string(number);
  const Json& entry = gltf_entry(*root_, "buffers", number, source_->name);
  const std::size_t length = gltf_number(entry, "byteLength", place);
  const auto uri = entry.find("uri");
  std::string_view bytes = binary_;
  if (uri != entry.end()) {
    if (!uri->is_string()) throw InputError(place, "a text as uri", "something else");
    if (loaded_.size() <= number) loaded_.resize(number + 1);
    if (loaded_[number].empty()) loaded_[number] = bytes_of_uri(uri->get_ref<const std::string&>(), place);
    bytes = loaded_[number];
  } else if (number != 0) {
    throw InputError(place, "a uri", "none");
  }
  if (bytes.size() < length)
    throw InputError(place, std::to_string(length) + " bytes", std::to_string(bytes.size()),
                     "the file may be cut");
  return bytes.substr(0, length);
}

GltfBuffers::Values GltfBuffers::values(std::size_t number, const std::string& type,
                                        std::span<const std::int64_t> components, const std::string& cure) {
  Values found;
  found.place = source_->name + ": accessors " + std::to_string(number);
  const Json& accessor = gltf_entry(*root_, "accessors", number, source_->name);
  if (accessor.contains("sparse"))
    throw InputError(found.place, "values one after another", "sparse ones", "save it without them");
  if (const auto given = accessor.find("type"); given == accessor.end() || *given != type)
    throw InputError(found.place, "type \"" + type + "\"", "another one");
  found.component = static_cast<std::int64_t>(gltf_number(accessor, "componentType", found.place));
  if (std::ranges::find(components, found.component) == components.end()) {
    std::vector<std::string> known;
    for (const std::int64_t component : components) known.push_back(std::to_string(component));
    throw InputError(found.place, "componentType " + join(known, " or "), std::to_string(found.component),
                     cure);
  }
  found.count = gltf_number(accessor, "count", found.place);
  if (found.count == 0) return found;
  const std::size_t view_number = gltf_number(accessor, "bufferView", found.place);
  const std::string view_place = source_->name + ": bufferViews " + std::to_string(view_number);
  const Json& view = gltf_entry(*root_, "bufferViews", view_number, source_->name);
  const std::string_view bytes = buffer(gltf_number(view, "buffer", view_place));
  const std::size_t begin = gltf_number(view, "byteOffset", view_place, 0);
  const std::size_t length = gltf_number(view, "byteLength", view_place);
  if (begin > bytes.size() || length > bytes.size() - begin)
    throw InputError(view_place, "a part of the " + std::to_string(bytes.size()) + " bytes of its buffer",
                     std::to_string(begin) + " to " + std::to_string(begin + length));
  const std::size_t width = size_of_component(found.component) * (type == "VEC3" ? 3 : 1);
  found.stride = gltf_number(view, "byteStride", view_place, width);
  if (found.stride == 0) found.stride = width;
  const std::size_t offset = gltf_number(accessor, "byteOffset", found.place, 0);
  const std::size_t room = offset <= length ? length - offset : 0;
  if (room < width || found.count - 1 > (room - width) / found.stride)
    throw InputError(found.place, std::to_string(found.count) + " values within its bufferView",
                     std::to_string(length) + " bytes", "the file may be cut");
  found.bytes = bytes.substr(begin + offset);
  return found;
}

std::vector<Vector3> GltfBuffers::positions(std::size_t number) {
  const Values found = values(number, "VEC3", std::array{real}, "save it without quantization");
  std::vector<Vector3> result;
  for (std::size_t i = 0; i < found.count; ++i) {
    Vector3 position;
    for (int k = 0; k < 3; ++k)
      position[k] = decoded(found.bytes.substr(i * found.stride + 4 * static_cast<std::size_t>(k), 4),
                            binary_float32, std::endian::little);
    if (!position.allFinite())
      throw InputError(found.place + ": value " + std::to_string(i), "finite coordinates", "inf or nan");
    result.push_back(position);
  }
  return result;
}

std::vector<std::uint32_t> GltfBuffers::indices(std::size_t number) {
  const Values found = values(number, "SCALAR", std::array{unsigned_byte, unsigned_short, unsigned_int}, "");
  const BinaryType type{size_of_component(found.component), false, false};
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < found.count; ++i)
    result.push_back(static_cast<std::uint32_t>(
        decoded(found.bytes.substr(i * found.stride, type.size), type, std::endian::little)));
  return result;
}

}  // namespace resilin
