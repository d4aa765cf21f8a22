#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "resilin/io/mesh_file.hpp"
#include "resilin/scene/key.hpp"
#include "resilin/world/description.hpp"

/// The tables of a scene file. Each file `*_table.cpp` holds the keys of its tables and reads them.
namespace resilin {

// simulation_table.cpp
/// Whether `simulation.dimension` stands for plane stress.
bool is_plane_stress_dimension(const SceneNode& node);
bool is_axisymmetric_dimension(const SceneNode& node);
Keys<Description> simulation_keys();
Keys<NewtonOptions> newton_keys();
Keys<SolverOptions> solver_keys();
Keys<OutputOptions> output_keys();
Keys<ProbeDescription> probe_keys();

// section_table.cpp
Keys<SectionDescription> section_keys();
void read_section(const SceneNode& node, SectionDescription& section);

// body_table.cpp
Keys<BodyDescription> body_keys();
TableDoc element_doc();
/// true, or a table; nothing where it is false.
void read_rigid(const SceneNode& node, std::optional<RigidDescription>& rigid);
TableDoc rigid_doc();
void read_body(const SceneNode& node, BodyDescription& body);

// mesh_table.cpp
/// Reads a file or makes a box, and checks what came: troubles are errors, oddities are warnings.
void read_body_mesh(const SceneNode& node, BodyDescription& body);
TableDoc mesh_doc();

// surface_mesh.cpp
/// How a surface gets its cells.
struct SurfaceCells {
  int cells = 4000;             ///< about how many
  double size = 0;              ///< in place of `cells`: length of their edges in the file; 0: not given
  double min_size = 0;          ///< likewise the least of them where the surface asks for it; 0: not given
  std::string mesher = "auto";  ///< a name of surface_meshers()
};
std::vector<std::string> surface_meshers();
/// Makes the body tetrahedra that fill the surface and carry it as their skin.
void fill_surface(const SceneNode& node, const MeshFile& file, const SurfaceCells& wanted,
                  BodyDescription& body);
/// Warns where the surface of `body`, the table that is read, is of a size that tells of another unit.
void remark_on_unit(const SceneNode& body_node, const BodyDescription& body);

// material_table.cpp
/// `mesh` is that of the body, for values per cell.
void read_material(const SceneNode& node, const Mesh& mesh, MaterialDescription& material);
TableDoc material_doc();
TableDoc viscoelastic_doc();
TableDoc mullins_doc();

// region_table.cpp
/// `mesh` is that of the body.
void read_regions(const SceneNode& node, const Mesh& mesh, std::vector<RegionDescription>& regions);
TableDoc region_doc();

// where_table.cpp
void read_where(const SceneNode& node, Where& where);
TableDoc where_doc();
/// { axis, center, degrees }, or in short [axis..., degrees] (in 2D: [degrees]).
void read_rotation(const SceneNode& node, std::optional<Rotation>& rotation);
TableDoc rotation_doc();

// skin_table.cpp
void read_skin(const SceneNode& node, std::optional<SkinDescription>& skin);
TableDoc skin_doc();

// condition_table.cpp
Keys<FixDescription> fix_keys();
Keys<LoadDescription> load_keys();
/// Letters of "xyz", each once, at least one.
void read_components(const SceneNode& node, std::array<bool, 3>& components);
void read_fix(const SceneNode& node, FixDescription& fix);
void read_load(const SceneNode& node, LoadDescription& load);

// tie_table.cpp
Keys<TieDescription> tie_keys();
void read_tie(const SceneNode& node, TieDescription& tie);
Keys<ConstraintDescription> constraint_keys();
void read_constraint(const SceneNode& node, ConstraintDescription& constraint);

// joint_table.cpp
Keys<JointDescription> joint_keys();
TableDoc motor_doc();
Keys<CableDescription> spring_keys();
Keys<CableDescription> cable_keys();
void read_joint(const SceneNode& node, JointDescription& joint);
void read_spring(const SceneNode& node, CableDescription& spring);
void read_cable(const SceneNode& node, CableDescription& cable);

// time_table.cpp
/// Rows of two numbers of a list, an array or a CSV file: "points [t, f]", each a "point in time".
NumberTable read_pairs(const SceneNode& node, const std::string& of_what, const std::string& of_one);
void read_time_function(const SceneNode& node, TimeFunction& function);
TableDoc time_function_doc();
void read_adaptive_steps(const SceneNode& node, std::optional<AdaptiveSteps>& adaptive);
TableDoc adaptive_doc();
void read_modes(const SceneNode& node, std::optional<ModesOptions>& modes);
TableDoc modes_doc();
void read_damping(const SceneNode& node, DampingDescription& damping);
TableDoc damping_doc();

// step_table.cpp
/// Turns [[step]] into time functions of what it names; the rest of the scene has been read.
void read_steps(const SceneNode& root, Description& description);
TableDoc step_doc();

// contact_table.cpp
Keys<ColliderDescription> collider_keys();
TableDoc collider_turn_doc();
void read_collider(const SceneNode& node, ColliderDescription& collider);
Keys<ContactDescription> contact_keys();
TableDoc contact_pair_doc();
void read_contact(const SceneNode& node, ContactDescription& contact);

// names.cpp
/// Bodies, fixes, loads, probes and sections have names of their own; whether a name that is referred to
/// exists is for `World`.
void check_names(const Description& description);

/// All tables in the order of the reference.
std::vector<TableDoc> scene_tables();

}  // namespace resilin
