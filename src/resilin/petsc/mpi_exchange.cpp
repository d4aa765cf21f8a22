#include "resilin/petsc/mpi_exchange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace resilin {
namespace {

constexpr std::size_t most_bytes = std::size_t{1}
                                   << 30;  ///< most bytes of one message: MPI counts with 32 bits
constexpr int tag_of_bytes = 1, tag_of_copies = 2;

/// Calls `transfer(first, count)` for pieces of `size` bytes.
template <class Transfer>
void in_pieces(std::size_t size, const Transfer& transfer) {
  for (std::size_t first = 0; first < size; first += most_bytes)
    transfer(first, static_cast<int>(std::min(most_bytes, size - first)));
}

}  // namespace

void send_bytes(MPI_Comm communicator, int to, const std::string& bytes) {
  auto size = static_cast<std::uint64_t>(bytes.size());
  MPI_Send(&size, 1, MPI_UINT64_T, to, tag_of_bytes, communicator);
  in_pieces(bytes.size(), [&](std::size_t first, int count) {
    MPI_Send(bytes.data() + first, count, MPI_BYTE, to, tag_of_bytes, communicator);
  });
}

std::string receive_bytes(MPI_Comm communicator, int from) {
  std::uint64_t size = 0;
  MPI_Recv(&size, 1, MPI_UINT64_T, from, tag_of_bytes, communicator, MPI_STATUS_IGNORE);
  std::string bytes(size, '\0');
  in_pieces(bytes.size(), [&](std::size_t first, int count) {
    MPI_Recv(bytes.data() + first, count, MPI_BYTE, from, tag_of_bytes, communicator, MPI_STATUS_IGNORE);
  });
  return bytes;
}

std::string broadcast_bytes(MPI_Comm communicator, int from, std::string bytes) {
  auto size = static_cast<std::uint64_t>(bytes.size());
  MPI_Bcast(&size, 1, MPI_UINT64_T, from, communicator);
  bytes.resize(size);
  in_pieces(bytes.size(), [&](std::size_t first, int count) {
    MPI_Bcast(bytes.data() + first, count, MPI_BYTE, from, communicator);
  });
  return bytes;
}

MpiExchange::MpiExchange(MPI_Comm communicator, const ScenePart& part)
    : communicator_(communicator), numbers_(part.numbers), ranked_numbers_(part.ranked_numbers) {
  MPI_Comm_rank(communicator, &rank_);
  MPI_Comm_size(communicator, &num_ranks_);
  std::map<int, std::vector<Index>> nodes_of;
  for (std::size_t node = 0; node < numbers_.size(); ++node) {
    owned_.push_back(part.owners[node] == rank_ ? 1 : 0);
    const auto first = static_cast<std::size_t>(part.copies_begin[node]);
    const auto last = static_cast<std::size_t>(part.copies_begin[node + 1]);
    if (last - first > 1) shared_.push_back(static_cast<Index>(node));
    for (std::size_t k = first; k < last; ++k)
      if (part.copies[k] != rank_) nodes_of[part.copies[k]].push_back(static_cast<Index>(node));
  }
  for (auto& [rank, nodes] : nodes_of)
    neighbours_.push_back({.rank = rank, .nodes = std::move(nodes), .out = {}, .in = {}});
}

void MpiExchange::sum(std::span<double> values) const {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM,
                communicator_);
  ++traffic_.sums;
}

void MpiExchange::largest(std::span<double> values) const {
  for (double& value : values)
    if (std::isnan(value)) value = -std::numeric_limits<double>::infinity();
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX,
                communicator_);
  ++traffic_.sums;
}

// All that have a node add up its copies in the order of the ranks: the same bits everywhere after one round
// of messages.
void MpiExchange::combine_copies(VectorX& values, Combine how) const {
  if (numbers_.empty()) return;
  const Eigen::Index dim = values.size() / static_cast<Eigen::Index>(numbers_.size());
  std::vector<MPI_Request> requests(2 * neighbours_.size());
  auto request = requests.begin();
  for (Neighbour& neighbour : neighbours_) {
    const std::size_t size = neighbour.nodes.size() * static_cast<std::size_t>(dim);
    neighbour.in.resize(size);
    neighbour.out.resize(size);
    MPI_Irecv(neighbour.in.data(), static_cast<int>(size), MPI_DOUBLE, neighbour.rank, tag_of_copies,
              communicator_, &*request++);
    double* to = neighbour.out.data();
    for (const Index node : neighbour.nodes)
      for (Eigen::Index k = 0; k < dim; ++k) *to++ = values[Eigen::Index{node} * dim + k];
    MPI_Isend(neighbour.out.data(), static_cast<int>(size), MPI_DOUBLE, neighbour.rank, tag_of_copies,
              communicator_, &*request++);
    ++traffic_.messages;
    traffic_.bytes += static_cast<Offset>(size * sizeof(double));
  }
  const double start = how == Combine::sum ? 0.0 : std::numeric_limits<double>::infinity();
  const auto combine = [how](double& sum, double value) {
    sum = how == Combine::sum ? sum + value : std::min(sum, value);
  };
  std::vector<double> own;
  for (const Index node : shared_)
    for (Eigen::Index k = 0; k < dim; ++k) {
      double& value = values[Eigen::Index{node} * dim + k];
      own.push_back(value);
      value = start;
    }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  const auto add = [&](const std::vector<Index>& nodes, const std::vector<double>& theirs) {
    const double* from = theirs.data();
    for (const Index node : nodes)
      for (Eigen::Index k = 0; k < dim; ++k) combine(values[Eigen::Index{node} * dim + k], *from++);
  };
  bool is_own_added = false;
  for (const Neighbour& neighbour : neighbours_) {
    if (neighbour.rank > rank_ && !std::exchange(is_own_added, true)) add(shared_, own);
    add(neighbour.nodes, neighbour.in);
  }
  if (!is_own_added) add(shared_, own);
}

std::string MpiExchange::tell(int from, const std::string& bytes) const {
  return broadcast_bytes(communicator_, from, bytes);
}

std::vector<std::string> MpiExchange::gather(const std::string& bytes) const {
  std::vector<std::string> all;
  if (rank_ != 0) {
    send_bytes(communicator_, 0, bytes);
    return all;
  }
  all.push_back(bytes);
  for (int rank = 1; rank < num_ranks_; ++rank) all.push_back(receive_bytes(communicator_, rank));
  return all;
}

}  // namespace resilin
