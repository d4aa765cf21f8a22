#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "resilin/fit/scene_fit.hpp"

/// Output of fields of cells.
namespace resilin {

/// The fields: name, cells, least and most, intervals, resolution; the first row is the heading.
std::vector<std::vector<std::string>> field_rows(const SceneFitReport& report);

/// "prior smooth, weight 31.6 by the corner of the L-curve (...); the data determine ..."; empty without
/// fields.
std::string regularisation_text(const SceneFitReport& report);

/// The curve of misfit and roughness with the weight taken, as SVG.
std::string l_curve_plot(const RegularisationReport& regularised);

/// The cells in the colours of a field, in the plane alone, as SVG; else empty.
std::string field_plot(const SceneFitReport& report, const FittedField& field);

/// "bar_youngs_modulus", as the name of a file.
std::string field_file_stem(const std::string& body, const std::string& constant);

/// The mesh of the body with the field, the ends of its intervals and its resolution: a scene takes it as
/// mesh with { cell_field = ... }.
void write_field(const SceneFitReport& report, const FittedField& field, const std::filesystem::path& path);

}  // namespace resilin
