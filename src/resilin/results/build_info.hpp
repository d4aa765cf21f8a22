#pragma once

#include <string>
#include <string_view>

namespace resilin {

/// Version of the library, and the compiler that built it.
std::string_view version();  ///< "0.1.0"
std::string compiler();      ///< "gcc 12.2.0"

}  // namespace resilin
