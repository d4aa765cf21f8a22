#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "resilin/fit/description.hpp"
#include "resilin/scene/key.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {

/// Reads what is to be fitted: [[test]] and [fit] of a TOML file, the columns of its CSV files, in SI units.
/// `overrides` as in `read_scene`. Throws InputError.
FitDescription read_fit(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// The same from values, such as a Python dict; `folder` is where relative paths begin.
FitDescription read_fit_from_values(SceneValue values, const std::string& name,
                                    const std::filesystem::path& folder,
                                    const std::vector<std::string>& overrides = {});

/// The page docs/fit_keys.md: every key of such a file.
std::string fit_reference();

// test_table.cpp
MaterialTest read_material_test(const SceneNode& node);
TableDoc material_test_doc();

}  // namespace resilin
