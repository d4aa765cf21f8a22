#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/world/scene_part.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// A scene cut into parts for several processes: every cell belongs to one of them, and comes with all its
/// nodes. Node by node one of the processes that have it is the owner (docs/theory/distribution.md).
class SceneCut {
 public:
  /// @param world      the whole scene; kept by reference
  /// @param cell_ranks of each body, by cell: the process that gets it
  /// @throws InputError for what one process alone can do, in words
  SceneCut(const World& world, std::span<const std::vector<std::int32_t>> cell_ranks, int num_ranks);

  ScenePart part(int rank) const;

 private:
  struct LoadSites {
    std::vector<Index> nodes;   ///< in the world's numbering, rising
    std::vector<Index> facets;  ///< nodes of one side after another, likewise
    std::vector<std::int32_t> facet_ranks;
    std::size_t nodes_per_facet = 0;
    bool is_on_each_node = false;
  };
  void find_owners();
  void find_load_sites();
  bool has_copy(Index node, int rank) const;
  BodyDescription body_part(std::size_t body, int rank, std::span<const Index> nodes,
                            std::span<const Index> local_of, std::vector<Index>& cells) const;
  void select(int rank, std::span<const Index> local_of, std::span<const Index> first_of_body,
              ScenePart& part) const;

  const World& world_;
  std::span<const std::vector<std::int32_t>> cell_ranks_;
  int num_ranks_;
  Description rest_;  ///< in the world's coordinates, without meshes
  std::vector<Offset> copies_begin_;
  std::vector<std::int32_t> copies_;
  std::vector<std::int32_t> owners_;
  std::vector<Offset> ranked_numbers_;
  std::vector<LoadSites> loads_;
};

/// Throws InputError naming what of a scene one process alone can do.
void require_distributable(const World& world);

}  // namespace resilin
