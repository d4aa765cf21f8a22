#pragma once

#include <filesystem>
#include <vector>

#include "resilin/scene/key.hpp"
#include "resilin/simulation/description.hpp"

/// The sections of a scene. Each file `*_section.cpp` holds the rows of its sections and reads them.
namespace resilin {

// simulation_section.cpp
Keys<Description> simulation_keys();
Keys<NewtonOptions> newton_keys();
Keys<SolverOptions> solver_keys();
Keys<OutputOptions> output_keys();
Keys<ProbeDescription> probe_keys();

// cut_section.cpp
Keys<SectionDescription> cut_keys();
void read_cut(const SceneNode& node, SectionDescription& section);

// body_section.cpp
Keys<BodyDescription> body_keys();
void read_body(const SceneNode& node, BodyDescription& body);

// mesh_section.cpp
/// Reads a file or makes a box, and checks what came: troubles are errors, oddities are warnings.
void read_body_mesh(const SceneNode& node, BodyDescription& body);
SectionDoc mesh_doc();

// material_section.cpp
/// `mesh` is that of the body, for values per cell.
void read_material(const SceneNode& node, const Mesh& mesh, MaterialDescription& material);
SectionDoc material_doc();

// where_section.cpp
void read_where(const SceneNode& node, Where& where);
SectionDoc where_doc();
/// { axis, center, degrees }, or in short [axis..., degrees] (in 2D: [degrees]).
void read_rotation(const SceneNode& node, std::optional<Rotation>& rotation);
SectionDoc rotation_doc();

// skin_section.cpp
void read_skin(const SceneNode& node, std::optional<SkinDescription>& skin);
SectionDoc skin_doc();

// condition_section.cpp
Keys<FixDescription> fix_keys();
Keys<LoadDescription> load_keys();
void read_fix(const SceneNode& node, FixDescription& fix);
void read_load(const SceneNode& node, LoadDescription& load);

// time_section.cpp
void read_time_function(const SceneNode& node, TimeFunction& function);
SectionDoc time_function_doc();
void read_adaptive_steps(const SceneNode& node, std::optional<AdaptiveSteps>& adaptive);
SectionDoc adaptive_doc();
void read_modes(const SceneNode& node, std::optional<ModesOptions>& modes);
SectionDoc modes_doc();
void read_damping(const SceneNode& node, DampingDescription& damping);
SectionDoc damping_doc();

/// Refuses keys that say something only while time passes where it does not.
void expect_motion(const SceneNode& table, std::initializer_list<const char*> keys);

// contact_section.cpp
Keys<ColliderDescription> collider_keys();
void read_collider(const SceneNode& node, ColliderDescription& collider);
/// Contact of bodies with each other: part of the contract, not of this version.
void refuse_contact(const SceneNode& node);

// names.cpp
/// Bodies, fixes, loads, probes and sections have names of their own; whether a name that is referred to
/// exists is for `World`.
void check_names(const Description& description);

/// All sections in the order of the reference.
std::vector<SectionDoc> scene_sections();

}  // namespace resilin
