#include "run_together.hpp"

#include <cstdlib>
#include <initializer_list>

#include "command.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "terminal.hpp"
#ifdef RESILIN_HAS_PETSC
#include "resilin/petsc/gamg_solver.hpp"
#endif

namespace resilin::cli {
namespace {

/// A number that mpirun leaves in the environment of the processes that it starts (Open MPI, MPICH).
std::optional<int> number_of_launch(std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const char* text = std::getenv(name)) return std::atoi(text);
  return std::nullopt;
}

int num_launched() { return number_of_launch({"OMPI_COMM_WORLD_SIZE", "MPI_LOCALNRANKS"}).value_or(1); }

}  // namespace

std::filesystem::path out_folder(const RunOptions& options) {
  if (!options.out.empty()) return options.out;
  return std::filesystem::path("out") / std::filesystem::path(options.scene).stem();
}

std::vector<std::string> overrides(const RunOptions& options) {
  std::vector<std::string> all = options.overrides;
  if (options.formats.empty()) return all;
  std::string list;
  for (const std::string& format : options.formats) list += (list.empty() ? "\"" : ", \"") + format + '"';
  all.push_back("output.formats=[" + list + "]");
  return all;
}

std::string vector_text(const Vector3& vector, int dimension) {
  std::string text;
  for (int i = 0; i < dimension; ++i) text += (i == 0 ? "" : ", ") + format_short(vector[i]);
  return "(" + text + ")";
}

void print_probes_and_reactions(const Frame& frame, int dimension) {
  for (const Frame::ProbeValue& probe : frame.probes)
    print_line("probe " + one_line(probe.name) + ": displacement " +
               vector_text(probe.displacement, dimension) + " m");
  for (const auto& [name, force] : frame.reactions)
    print_line("reaction " + one_line(name) + ": " + vector_text(force, dimension) + " N");
}

std::string distribution_text() {
#ifdef RESILIN_HAS_PETSC
  return "by " + petsc_version();
#else
  return "no: built without PETSc";
#endif
}

std::optional<int> run_together(const RunOptions& options) {
  if (num_launched() <= 1) return std::nullopt;
#ifdef RESILIN_HAS_PETSC
  return run_shared(options);
#else
  const int rank = number_of_launch({"OMPI_COMM_WORLD_RANK", "PMI_RANK"}).value_or(0);
  if (rank == 0)
    print_error(InputError(options.scene, "one process, for this program is built without PETSc",
                           std::to_string(num_launched()) + " that mpirun has started",
                           "build it by cmake --preset petsc, or run it without mpirun")
                    .what());
  return wrong_input;
#endif
}

}  // namespace resilin::cli
