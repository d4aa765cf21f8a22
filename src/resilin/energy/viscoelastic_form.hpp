#pragma once

#include <array>
#include <string_view>

namespace resilin {

/// Formulation of finite-strain viscoelasticity: the part of the second Piola-Kirchhoff stress that branches
/// follow (docs/theory/viscoelasticity.md).
enum class ViscoelasticForm {
  simo,   ///< J^(2/3) S_iso, whose deviator is taken at the present shape (Simo 1987)
  iso,    ///< S_iso (Holzapfel 2000; FEBio's "uncoupled viscoelastic")
  whole,  ///< all of S, the pressure included (FEBio's "viscoelastic")
};
constexpr std::array<std::string_view, 3> spellings(ViscoelasticForm) { return {"simo", "iso", "whole"}; }

}  // namespace resilin
