#pragma once

#include "resilin/sensitivity/parameter.hpp"

namespace resilin {

/// Names of parameters after "body.NAME.".
std::vector<std::string> keys_of_body(const World& world, std::size_t body);

/// The parameter of one of these keys.
Parameter parameter_of_body(const World& world, std::size_t body, const std::string& name,
                            const std::string& key);

}  // namespace resilin
