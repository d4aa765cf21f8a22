#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "resilin/fit/description.hpp"
#include "resilin/fit/relaxation_fit.hpp"
#include "resilin/fit/scene_experiment.hpp"
#include "resilin/scene/key.hpp"
#include "resilin/scene/value.hpp"

namespace resilin {

/// Contents of a fit file: laws from homogeneous tests, parameters of scenes from experiments, or the Prony
/// series of a relaxation.
using AnyFit = std::variant<FitDescription, SceneFitDescription, RelaxationDescription>;

/// Reads what is to be fitted: [[test]] or [[experiment]], and [fit] of a TOML file, or [relaxation], the
/// columns of its CSV files, in SI units. `overrides` as in `read_scene`. Throws InputError.
AnyFit read_any_fit(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// A fit of homogeneous tests, of experiments or of a relaxation alone: the others are refused.
FitDescription read_fit(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});
SceneFitDescription read_scene_fit(const std::filesystem::path& path,
                                   const std::vector<std::string>& overrides = {});

RelaxationDescription read_relaxation(const std::filesystem::path& path,
                                      const std::vector<std::string>& overrides = {});

/// The same from values, such as a Python dict; `folder` is where relative paths begin.
FitDescription read_fit_from_values(SceneValue values, const std::string& name,
                                    const std::filesystem::path& folder,
                                    const std::vector<std::string>& overrides = {});
SceneFitDescription read_scene_fit_from_values(SceneValue values, const std::string& name,
                                               const std::filesystem::path& folder,
                                               const std::vector<std::string>& overrides = {});

RelaxationDescription read_relaxation_from_values(SceneValue values, const std::string& name,
                                                  const std::filesystem::path& folder,
                                                  const std::vector<std::string>& overrides = {});

/// The page docs/fit_keys.md: every key of such a file.
std::string fit_reference();

// test_table.cpp
/// Numbers of a list, or of an array with one column.
std::vector<double> read_column(const SceneNode& node);
MaterialTest read_material_test(const SceneNode& node);
TableDoc material_test_doc();

// relaxation_table.cpp
RelaxationDescription read_relaxation_root(const SceneNode& root);
TableDoc relaxation_doc();

// experiment_table.cpp
SceneFitDescription read_scene_fit_root(const SceneNode& root);
std::vector<TableDoc> scene_fit_docs();

}  // namespace resilin
