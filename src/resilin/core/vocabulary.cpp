#include "resilin/core/vocabulary.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

std::string normalized(std::string_view word) {
  std::string result(word);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == ' ' || c == '-') c = '_';
  }
  return result;
}

}  // namespace

std::span<const ForeignWord> vocabulary() {
  static const std::vector<ForeignWord> words = {
      {{"force", "point_load", "concentrated_force", "cload"},
       {"force", "nodal_force"},
       "[[load]] of kind \"nodal_force\""},
      {{"surface_traction", "dead_load", "surface_load"}, {"traction"}, "[[load]] of kind \"traction\""},
      {{"follower_load", "follower_pressure"}, {"pressure"}, "[[load]] of kind \"pressure\""},
      {{"volume_force", "volumetric_load"}, {"body_force"}, "[[load]] of kind \"body_force\""},
      {{"plane", "ground_plane", "halfspace", "wall"}, {"half_space"}, "[[collider]] of kind \"half_space\""},
      {{"implicit_euler", "euler"}, {"backward_euler"}, "simulation.integrator"},
      {{"quasistatic", "quasi_static", "steady", "equilibrium"}, {"static"}, "simulation.kind = \"static\""},
      {{"transient", "implicit_dynamic"}, {"dynamic"}, "simulation.kind = \"dynamic\""},
      {{"modal", "eigenmodes", "vibration"}, {"modes"}, "simulation.kind = \"modes\""},
      {{"hookean", "hooke", "isotropic_linear_elastic"}, {"linear_elastic"}, "body.material.law"},
      {{"neohookean", "neo_hooke", "nh"}, {"neo_hookean"}, "body.material.law"},
      {{"mooney"}, {"mooney_rivlin"}, "body.material.law"},
      {{"hgo", "holzapfel"}, {"holzapfel_gasser_ogden"}, "body.material.law"},
      {{"stvk", "svk", "st_venant_kirchhoff", "saint_venant"},
       {"saint_venant_kirchhoff"},
       "body.material.law"},
      {{"disk", "circle"}, {"disc"}, "a mesh file"},

      {{"axisymmetric", "axisymmetry", "axi", "cax"}, {}, "", "no axisymmetry"},
      {{"plane_stress", "cps"}, {}, "", "no plane stress"},
      {{"tie", "ties", "tied", "glue", "bonded", "bond"}, {}, "", "no ties"},
      {{"periodic", "periodicity", "mpc"}, {}, "", "no periodic boundaries"},
      {{"joint", "joints", "hinge", "connector"}, {}, "", "joints"},
      {{"plasticity", "plastic", "elastoplastic", "yield_stress", "von_mises_plasticity"},
       {},
       "",
       "no plasticity"},
      {{"damage", "fracture", "crack"}, {}, "", "fracture"},
      {{"creep"}, {}, "", "creep"},
      {{"thermal", "temperature", "heat", "thermal_expansion"}, {}, "", "heat"},
      {{"viscoelastic", "viscoelasticity", "prony", "relaxation"}, {}, "", "no viscoelasticity"},
      {{"shell", "shells", "membrane", "cloth", "rod", "truss", "wire"},
       {},
       "",
       "no shells, membranes, rods"},
      {{"orthotropic", "anisotropic"}, {}, "", "no orthotropic elasticity"},
      {{"gpu", "cuda", "opencl"}, {}, "", "no gpu"},
      {{"explicit", "central_difference"}, {}, "", "no explicit integrator"},
      {{"adhesion", "cohesive"}, {}, "", "no adhesion"},
      {{"p3", "cubic"}, {}, "", "no degree 3"},
  };
  return words;
}

std::string foreign_word_cure(std::string_view word, std::span<const std::string> known) {
  const std::string meant = normalized(word);
  for (const ForeignWord& foreign : vocabulary()) {
    if (std::ranges::find(foreign.words, meant) == foreign.words.end()) continue;
    if (foreign.called.empty()) return "not available (docs/limits.md)";
    for (const std::string_view own : foreign.called)
      if (own != word && std::ranges::find(known, own) != known.end())
        return "it is called \"" + std::string(own) + "\" here";
    if (foreign.home.find('"') != foreign.home.npos) return "it is " + std::string(foreign.home) + " here";
    return "it is called " + std::string(foreign.home) + " here";
  }
  return {};
}

void refuse_own_word(const std::string& place, std::string_view word, std::span<const std::string> known) {
  throw InputError(place, "one of " + join(known), '"' + std::string(word) + '"', cure_of_word(word, known));
}

std::string cure_of_word(std::string_view word, std::span<const std::string> known) {
  const std::string cure = foreign_word_cure(word, known);
  return cure.empty() ? did_you_mean(word, known) : cure;
}

}  // namespace resilin
