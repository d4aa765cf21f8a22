#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "resilin/core/process_group.hpp"
#include "resilin/world/scene_part.hpp"

namespace resilin {

/// Messages sent by this process since the start.
struct Traffic {
  Offset sums = 0;      ///< reductions over all processes
  Offset messages = 0;  ///< to neighbours
  Offset bytes = 0;     ///< in these
};

/// Exchange between the processes of an MPI communicator.
class MpiExchange final : public Exchange {
 public:
  MpiExchange(MPI_Comm communicator, const ScenePart& part);

  int rank() const override { return rank_; }
  int num_ranks() const override { return num_ranks_; }
  void sum(std::span<double> values) const override;
  void largest(std::span<double> values) const override;
  void combine_copies(VectorX& values, Combine how) const override;
  std::span<const std::uint8_t> owned() const override { return owned_; }
  std::span<const Index> numbers() const override { return numbers_; }
  std::span<const Offset> ranked_numbers() const override { return ranked_numbers_; }
  std::string tell(int from, const std::string& bytes) const override;
  std::vector<std::string> gather(const std::string& bytes) const override;

  const Traffic& traffic() const { return traffic_; }

 private:
  struct Neighbour {
    int rank;
    std::vector<Index> nodes;  ///< nodes of both, by their numbers in the whole scene
    std::vector<double> out, in;
  };

  MPI_Comm communicator_;
  int rank_ = 0, num_ranks_ = 1;
  std::vector<std::uint8_t> owned_;
  std::vector<Index> numbers_;
  std::vector<Offset> ranked_numbers_;
  mutable std::vector<Neighbour> neighbours_;  ///< by rank; their buffers are kept
  std::vector<Index> shared_;                  ///< nodes with copies elsewhere
  mutable Traffic traffic_;
};

/// Bytes of any length from one process to another, or to all.
void send_bytes(MPI_Comm communicator, int to, const std::string& bytes);
std::string receive_bytes(MPI_Comm communicator, int from);
std::string broadcast_bytes(MPI_Comm communicator, int from, std::string bytes);

}  // namespace resilin
