#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "resilin/contact/contact_node.hpp"
#include "resilin/contact/contact_surface.hpp"
#include "resilin/world/world.hpp"

/// Contact surfaces of the bodies of a world.
namespace resilin {

/// Young's modulus of a domain's material at small strain, by the means of its constants [Pa].
double youngs_modulus(const Domain& domain);
/// Number of the domain with the least Young's modulus: contact is as stiff as this asks for.
std::size_t softest_domain(const Body& body);
/// Young's modulus of the softest domain of a body [Pa].
double youngs_modulus(const Body& body);
/// The same by other constants of its law's formula.
double youngs_modulus(const LawInfo& law, const std::vector<double>& constants);

/// Per node: whether supports hold it in all directions. Their support says where they are, and no collider
/// pushes them.
std::vector<std::uint8_t> held_nodes(const World& world);

/// The points of all bodies' surfaces with their barrier stiffness times area, body by body: nodes,
/// ascending, or vertices of skins. Held ones are left out.
/// @param stiffness  of the barrier [Pa]; none: a tenth of each body's Young's modulus at small strain.
///                   Whatever is chosen is in proportion to that modulus (sensitivity/barrier_links.hpp)
ContactPoints contact_points(const World& world, std::optional<double> stiffness = {});

/// The vertices of a body's skin, by the nodes that carry them.
CarriedPoints skin_vertices(const Body& body);

/// The surface of a body, by the nodes of the world or the vertices of its skin, likewise.
ContactBody meeting_body(const Body& body, int dim, std::optional<double> stiffness);

/// Those of all bodies.
std::vector<ContactBody> contact_bodies(const World& world, std::optional<double> stiffness);

/// "vertex 3 of "body"": a point of the surface that it meets others with.
std::string point_name(const Body& body, Index number);

/// Whether the contact surface of a body has an inside: a skin may be open.
bool has_inside(const World& world, const Body& body);

/// The largest extent of the smallest body: the longest side of the box with the same second moments, which
/// does not hang on how bodies are turned [m].
double smallest_extent(const World& world);

/// The shortest side of the box with the same second moments as a body [m].
double thinnest_extent(const World& world, const Body& body);

/// [m]: 0.005 of the largest extent of the smallest body, at most a tenth of the thickness of any, and at
/// most the mean side of a skin that meets: of a surface that is finer than that many parts would be near a
/// point. Smaller gaps look better and cost Newton iterations: a barrier is felt only so far away, and a step
/// ends where a node has lost nine tenths of its distance.
double default_activation_distance(const World& world);

/// Throws InputError at `place` for a triangle without an area, in 3D: where it is.
void require_areas(const ColliderMesh& mesh, const World& world, const std::string& place);

/// Throws InputError for a skin that cannot be a contact surface; `place` is that of the body.
void check_contact_skin(const Body& body, const World& world, const std::string& place);

}  // namespace resilin
