#include "resilin/core/error.hpp"

namespace resilin {

InputError::InputError(const std::string& place, const std::string& expected, const std::string& got,
                       const std::string& cure)
    : std::runtime_error(place + ": expected " + expected + ", got " + got +
                         (cure.empty() ? "" : "; " + cure)) {}

InputError::InputError(const std::string& place, const std::string& problem)
    : std::runtime_error(place + ": " + problem) {}

}  // namespace resilin
