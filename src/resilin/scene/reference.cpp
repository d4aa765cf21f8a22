#include "resilin/scene/scene.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

constexpr std::string_view introduction = R"(# The scene file

A scene is a TOML file. Paths in it are beside the file; units are SI. A key that is not listed here is an
error that names the nearest known one. Any value can be set from the command line:

    resilin run beam.toml --set newton.tolerance=1e-6 --set body.beam.scale=2 --set fix.0.displacement=[0,0,1]

A *vector* is a list of as many numbers as `simulation.dimension`, a *matrix* a list of such rows.
This page is printed by `resilin info --scene-reference` from the table that reads the file. `resilin info --schema > scene.schema.json`
prints the same as a JSON schema: with `#:schema scene.schema.json` as its first line, editors with taplo (Even Better TOML) complete and check a scene ([how](editors.md#scenes-in-an-editor)).

```toml
title = "A beam under its own weight"

[simulation]
gravity = [0, 0, -9.81]

[[body]]
name = "beam"
mesh = { box = { size = [4, 1, 1], cells = [40, 10, 10] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }

[[fix]]
name = "wall"
where = { group = "x_min" }

[[probe]]
name = "tip"
at = [4, 0.5, 0.5]
```
)";

}  // namespace

std::string scene_reference() {
  std::string page(introduction);
  for (const TableDoc& section : scene_tables()) page += reference_text(section);
  return page;
}

std::vector<TableDoc> scene_tables() {
  return {
      document("[simulation]", "The analysis: static, dynamic or modal.", simulation_keys()),
      adaptive_doc(),
      modes_doc(),
      document("[[body]]", "A deformable body; there may be several with different materials.", body_keys()),
      element_doc(),
      mesh_doc(),
      material_doc(),
      viscoelastic_doc(),
      mullins_doc(),
      region_doc(),
      damping_doc(),
      rotation_doc(),
      skin_doc(),
      rigid_doc(),
      document("[[fix]]",
               "Dirichlet boundary condition: prescribed displacement, whole or by component; the reaction "
               "is reported.",
               fix_keys()),
      document("[[load]]",
               "Neumann boundary condition or body force. Loads are dead loads in the reference "
               "configuration, except pressure, which is a follower load.",
               load_keys()),
      document("[[tie]]",
               "Surfaces of two bodies that stay together though their meshes do not match "
               "([ties](boundary_conditions.md#ties)).",
               tie_keys()),
      document("[[constraint]]",
               "Linear constraint between displacements, which is eliminated; its force is reported "
               "([constraints](boundary_conditions.md#linear-constraints)).",
               constraint_keys()),
      document("[[joint]]",
               "Joint between two rigid bodies, or between one and the ground; its force is reported "
               "([joints](rigid.md#joints)).",
               joint_keys()),
      motor_doc(),
      document(
          "[[spring]]",
          "Spring between two points of bodies or of the ground ([springs](rigid.md#springs-and-cables)).",
          spring_keys()),
      document("[[cable]]",
               "Cable (tendon) through points of bodies, pulled at the first one "
               "([cables](rigid.md#springs-and-cables)).",
               cable_keys()),
      where_doc(),
      time_function_doc(),
      document(
          "[[collider]]",
          "A rigid obstacle with prescribed motion. Its contact force is reported ([contact](contact.md)).",
          collider_keys()),
      collider_turn_doc(),
      document("[contact]",
               "Contact between bodies (on by default), self-contact and friction ([contact](contact.md)).",
               contact_keys()),
      contact_pair_doc(),
      document("[newton]", "Newton's method: convergence criteria and limits.", newton_keys()),
      document("[solver]", "Linear solver.", solver_keys()),
      document("[[probe]]", "A vertex with its motion in the report.", probe_keys()),
      document("[[section]]",
               "A plane cut through a body; the report has the force and moment that the side beyond it "
               "exerts on the side below ([results.md](results.md#sections)).",
               section_keys()),
      step_doc(),
      document("[output]", "Output: frames, fields and file formats.", output_keys()),
  };
}

}  // namespace resilin
