#pragma once

#include <string>

namespace resilin {

/// The page docs/laws.md, in Markdown: every law of the catalogue with formula, constants, conversion and
/// source.
std::string law_reference();

}  // namespace resilin
