#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "resilin/petsc/mpi_exchange.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Number of MPI processes and rank of this one; 1 and 0 without mpirun.
int num_processes();
int process_rank();
/// Ends all of them, at once.
[[noreturn]] void end_all_processes(int exit_code);

/// An error that all processes know of: each ends by itself, and the first one says it.
class AgreedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Calls a function on the first process; an InputError there becomes an AgreedError on all.
void on_first_process(const ProcessGroup& share, const std::function<void()>& function);
/// Calls a function on all processes, where an InputError of one is that of all.
void on_all_processes(const std::function<void()>& function);

/// Facts of a whole scene that its first process keeps; elsewhere empty.
struct WholeScene {
  std::string bodies_json;            ///< "bodies" of the report
  std::vector<Index> first_nodes;     ///< first nodes of each body
  std::vector<std::string> warnings;  ///< one line each
  std::vector<std::string> notes;
  Index num_nodes = 0, num_free_unknowns = 0, num_cells = 0;
};

/// One process's world, of a scene that all share.
struct SharedScene {
  std::unique_ptr<World> world;
  std::shared_ptr<const MpiExchange> exchange;
  WholeScene whole;
};

/// Makes the whole world on the first process, cuts it and sends every process its part. Until then the first
/// process has the whole scene in memory, set up as for a run of its own; then it keeps its part.
/// @param read  called by the first process alone
/// @throws AgreedError  where `read` threw InputError, or the scene cannot be shared
SharedScene share_scene(const std::function<Description()>& read);

/// Numbers by node, from all processes in the order of the whole scene, on the first; elsewhere empty.
VectorX gathered(const ProcessGroup& share, const VectorX& values, Index num_nodes);
/// Back: `whole` matters on the first process alone.
VectorX scattered(const ProcessGroup& share, const VectorX& whole);

}  // namespace resilin
