#pragma once

#include <string>
#include <vector>

/// Words of the catalogues, which shells offer for values.
namespace resilin::cli {

/// Completions of --set: "simulation.gravity=", and "body.0.element=P2" for each word that a key
/// takes.
std::vector<std::string> scene_settings();

std::vector<std::string> law_words();
std::vector<std::string> load_case_words();  ///< load case words of curves
std::vector<std::string> view_words();
std::vector<std::string> color_map_words();
std::vector<std::string> mesh_extensions();            ///< mesh extensions of all formats, such as "msh"
std::vector<std::string> scene_and_mesh_extensions();  ///< "toml" and these

}  // namespace resilin::cli
