#pragma once

#include <cstdint>
#include <vector>

#include "resilin/world/description.hpp"
#include "resilin/world/fingerprint.hpp"

namespace resilin {

/// Nodes of a body that a `where` means, and the sides that they make up: numbers of the body's part.
struct SelectionPart {
  std::vector<Index> nodes;
  std::vector<Index> facets;  ///< nodes of those sides that the body's part owns
};

/// Points of a collider's barrier: nodes of the world's part, each on its owner alone.
struct ContactPart {
  std::vector<Index> nodes;
  std::vector<double> stiffness;  ///< times area [N/m]
};

/// The cells of a body on one MPI process.
struct BodyPart {
  std::vector<Index> cells;   ///< their numbers in the whole body
  double mass = 0;            ///< mass of the whole body [kg]
  bool has_own_cells = true;  ///< some cells of the whole body belong to no region
};

/// Part of a distributed scene for one process: its cells with all their nodes, and what has been
/// read off the whole scene. Plain data, to be sent.
struct ScenePart {
  Description description;  ///< in the world's coordinates; its bodies are the parts, with all nodes
  Vector3 origin = Vector3::Zero();
  Fingerprint fingerprint;  ///< fingerprint of the whole scene
  std::vector<BodyPart> bodies;
  std::vector<SelectionPart> fixes;  ///< by [[fix]]
  std::vector<SelectionPart> loads;  ///< by [[load]]; of forces on nodes, those that the part owns
  std::vector<ContactPart> colliders;
  std::vector<Index> probes;  ///< nodes of the world's part; -1: of another's

  // By node of the world's part:
  std::vector<Index> numbers;          ///< in the whole scene
  std::vector<Offset> ranked_numbers;  ///< in an order in which those of each owner stand in a row
  std::vector<std::int32_t> owners;    ///< ranks
  std::vector<Offset> copies_begin;    ///< one more than nodes
  std::vector<std::int32_t> copies;    ///< the ranks that have the node, its own included, rising
  Offset num_ranked = 0;               ///< nodes of the whole scene
};

}  // namespace resilin
