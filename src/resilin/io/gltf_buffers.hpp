#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/io/catalog.hpp"

namespace resilin {

/// The numbers of a glTF file: its JSON, the buffers that it names, and what accessors say of them.
class GltfBuffers {
 public:
  /// @param root    the JSON of the file, which outlives this
  /// @param binary  the buffer inside a .glb file; empty where there is none
  GltfBuffers(const MeshSource& source, const nlohmann::json& root, std::string_view binary);

  /// Three numbers each, from accessor `number`. @throws InputError
  std::vector<Vector3> positions(std::size_t number);
  /// Whole numbers, from accessor `number`.
  std::vector<std::uint32_t> indices(std::size_t number);

 private:
  /// Where the values of an accessor stand.
  struct Values {
    std::string_view bytes;  ///< from the first value on
    std::size_t count = 0, stride = 0;
    std::int64_t component = 0;  ///< glTF's number of the type
    std::string place;
  };
  /// @param components  the types of numbers that are taken; `cure` is of others
  Values values(std::size_t number, const std::string& type, std::span<const std::int64_t> components,
                const std::string& cure);
  std::string_view buffer(std::size_t number);
  std::string bytes_of_uri(const std::string& uri, const std::string& place) const;

  const MeshSource* source_;
  const nlohmann::json* root_;
  std::string_view binary_;
  std::vector<std::string> loaded_;  ///< by buffer; empty until it is asked for
};

/// A member of an object that is a whole number from 0 on, or `otherwise` where there is none.
std::size_t gltf_number(const nlohmann::json& object, const char* key, const std::string& place,
                        std::size_t otherwise);
/// The same where there must be one.
std::size_t gltf_number(const nlohmann::json& object, const char* key, const std::string& place);

/// Entry `number` of the list `key` at the root. @throws InputError where there is none
const nlohmann::json& gltf_entry(const nlohmann::json& root, const char* key, std::size_t number,
                                 const std::string& file);

}  // namespace resilin
