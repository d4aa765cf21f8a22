#pragma once

#include <string>

#include "resilin/core/error.hpp"
#include "resilin/io/mesh_file.hpp"

namespace resilin::testing {

/// The message with which a mesh in memory is refused; empty when it is accepted.
inline std::string refusal(const std::string& name, const std::string& text,
                           const Companion& companion = {}) {
  try {
    read_mesh_from_memory(name, text, companion);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace resilin::testing
