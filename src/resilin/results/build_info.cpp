#include "resilin/results/build_info.hpp"

namespace resilin {

std::string_view version() { return RESILIN_VERSION; }

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

}  // namespace resilin
