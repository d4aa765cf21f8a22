#pragma once

#include <exception>
#include <new>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"

namespace resilin::viewer {

/// Message of an exception, in one line for the user.
inline std::string words_of(const std::exception& error) {
  if (dynamic_cast<const InputError*>(&error) != nullptr) return error.what();
  if (const auto* shortage = dynamic_cast<const std::bad_alloc*>(&error))
    return out_of_memory_text(*shortage);
  return std::string("internal error: ") + error.what();
}

}  // namespace resilin::viewer
