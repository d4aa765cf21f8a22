#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resilin/simulation/frame.hpp"

namespace resilin::cli {

struct RunOptions {
  std::string scene;
  std::string out;
  std::vector<std::string> overrides;
  std::vector<std::string> formats;  ///< empty: as the scene says
  int threads = 0;
  int steps = 0;
  std::string resume;  ///< empty: from the start
  bool quiet = false;

  bool resumes() const { return !resume.empty(); }
};

inline constexpr const char* resume_anyway = "anyway";

std::filesystem::path out_folder(const RunOptions& options);
/// Those of the command line, "KEY=VALUE" each.
std::vector<std::string> overrides(const RunOptions& options);

/// "(0, 0, -1.5)".
std::string vector_text(const Vector3& vector, int dimension);

void print_probes_and_reactions(const Frame& frame, int dimension);

/// Where mpirun has started several processes: what they do together, with the exit code; none where this
/// process runs the scene by itself. A build without PETSc refuses, in one line of the first of them.
std::optional<int> run_together(const RunOptions& options);

/// Support for MPI in this build: "by PETSc 3.18.5 and MPI", or "no: built without PETSc".
std::string distribution_text();

/// The run of one scene on all processes that mpirun has started; in builds with PETSc.
int run_shared(const RunOptions& options);

}  // namespace resilin::cli
