#include "resilin/petsc/shared_scene.hpp"

#include <malloc.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/petsc/partition.hpp"
#include "resilin/petsc/session.hpp"
#include "resilin/results/report.hpp"
#include "resilin/world/scene_cut.hpp"
#include "resilin/world/scene_part_image.hpp"

namespace resilin {
namespace {

const MPI_Comm everyone = MPI_COMM_WORLD;

WholeScene facts_of(const World& world) {
  WholeScene facts{.bodies_json = bodies_json(world).dump(),
                   .first_nodes = {},
                   .warnings = all_warnings(world),
                   .notes = world.notes,
                   .num_nodes = world.num_nodes(),
                   .num_free_unknowns = world.num_free_unknowns()};
  for (const Body& body : world.bodies) {
    facts.first_nodes.push_back(body.first_node);
    facts.num_cells += body.num_cells();
  }
  return facts;
}

/// The whole scene and how it is cut; on the first process.
struct Cut {
  explicit Cut(Description description)
      : world(std::move(description)),
        cell_ranks(partition_cells(world, num_processes())),
        parts(world, cell_ranks, num_processes()) {}

  World world;
  std::vector<std::vector<std::int32_t>> cell_ranks;
  SceneCut parts;
};

/// Null, and why in words, where it cannot be.
std::unique_ptr<const Cut> make_cut(const std::function<Description()>& read, std::string& error) {
  try {
    return std::make_unique<const Cut>(read());
  } catch (const InputError& wrong) {
    error = wrong.what();
  } catch (const std::bad_alloc& short_of_memory) {
    error = out_of_memory_text(short_of_memory);
  }
  return nullptr;
}

}  // namespace

int num_processes() {
  int count = 1;
  start_petsc();
  MPI_Comm_size(everyone, &count);
  return count;
}

int process_rank() {
  int rank = 0;
  start_petsc();
  MPI_Comm_rank(everyone, &rank);
  return rank;
}

void end_all_processes(int exit_code) {
  MPI_Abort(everyone, exit_code);
  std::abort();
}

void on_first_process(const ProcessGroup& share, const std::function<void()>& function) {
  std::string error;
  try {
    if (share.is_first()) function();
  } catch (const InputError& wrong) {
    error = wrong.what();
  }
  error = share.exchange().tell(0, error);
  if (!error.empty()) throw AgreedError(error);
}

void on_all_processes(const std::function<void()>& function) {
  try {
    function();
  } catch (const InputError& wrong) {
    throw AgreedError(wrong.what());
  }
}

SharedScene share_scene(const std::function<Description()>& read) {
  SharedScene scene;
  std::optional<ScenePart> part;
  std::unique_ptr<const Cut> cut;
  std::string error;
  if (process_rank() == 0) cut = make_cut(read, error);
  error = broadcast_bytes(everyone, 0, error);
  if (!error.empty()) throw AgreedError(error);
  if (cut != nullptr) {
    scene.whole = facts_of(cut->world);
    for (int rank = 1; rank < num_processes(); ++rank)
      send_bytes(everyone, rank, serialize(cut->parts.part(rank)));
    part = cut->parts.part(0);
    cut.reset();
    malloc_trim(0);  // returns the memory of the whole scene, which else stays with this process
  } else {
    part = deserialize_scene_part(receive_bytes(everyone, 0));
  }
  scene.exchange = std::make_shared<const MpiExchange>(everyone, *part);
  scene.world = std::make_unique<World>(std::move(*part), ProcessGroup(scene.exchange));
  return scene;
}

VectorX gathered(const ProcessGroup& share, const VectorX& values, Index num_nodes) {
  ArchiveWriter writer;
  std::vector<Index> numbers;
  std::vector<double> own;
  const Eigen::Index dim = values.size() / share.num_nodes();
  for (Index node = 0; node < share.num_nodes(); ++node) {
    if (!share.owns(node)) continue;
    numbers.push_back(share.number_of(node));
    for (Eigen::Index k = 0; k < dim; ++k) own.push_back(values[Eigen::Index{node} * dim + k]);
  }
  writer(numbers, own);
  VectorX whole;
  for (const std::string& bytes : share.exchange().gather(writer.take())) {
    if (whole.size() == 0) whole.setZero(num_nodes * dim);
    ArchiveReader reader(bytes, "numbers of another process");
    reader(numbers, own);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      for (Eigen::Index k = 0; k < dim; ++k)
        whole[Eigen::Index{numbers[i]} * dim + k] =
            own[i * static_cast<std::size_t>(dim) + static_cast<std::size_t>(k)];
  }
  return whole;
}

VectorX scattered(const ProcessGroup& share, const VectorX& whole) {
  const std::span<const Index> own = share.exchange().numbers();
  ArchiveWriter writer;
  writer(std::vector<Index>(own.begin(), own.end()));
  const std::vector<std::string> wanted = share.exchange().gather(writer.take());
  // The number of all nodes tells how many numbers go with each.
  double num_nodes = 0;
  for (Index node = 0; node < share.num_nodes(); ++node) num_nodes += share.owns(node) ? 1 : 0;
  num_nodes = share.sum(num_nodes);
  const Eigen::Index dim = whole.size() / static_cast<Eigen::Index>(num_nodes);
  const auto picked = [&](const std::string& bytes) {
    std::vector<Index> numbers;
    ArchiveReader(bytes, "numbers of another process")(numbers);
    VectorX values(static_cast<Eigen::Index>(numbers.size()) * dim);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      values.segment(static_cast<Eigen::Index>(i) * dim, dim) =
          whole.segment(Eigen::Index{numbers[i]} * dim, dim);
    return values;
  };
  if (share.is_first()) {
    for (std::size_t rank = 1; rank < wanted.size(); ++rank) {
      ArchiveWriter values;
      values(picked(wanted[rank]));
      send_bytes(everyone, static_cast<int>(rank), values.take());
    }
    return picked(wanted.front());
  }
  VectorX values;
  ArchiveReader(receive_bytes(everyone, 0), "numbers of the first process")(values);
  return values;
}

}  // namespace resilin
