#pragma once

#include <functional>
#include <map>
#include <string>

namespace resilin::testing {

/// One mutated file, with the unchanged files that stand beside it.
struct FuzzInput {
  std::string name;                                  ///< name of the file that was mutated
  std::string bytes;                                 ///< mutated
  const std::map<std::string, std::string>& corpus;  ///< all files by name
};

/// Works on one input; whatever it throws, and any crash, is a failure.
using FuzzTarget = std::function<void(const FuzzInput&)>;

/// The main function of a fuzzer: mutates the files of the corpus folders given on the command line, the same
/// way for the same seed, and gives them to the target.
///
/// Each input may take 10 s and 1 GiB. A failing input is saved as fuzz_failure_SEED_NUMBER in the working
/// folder;
/// `--only NUMBER` runs one again. @return 0 when all inputs passed
int fuzz_main(int argc, char** argv, const FuzzTarget& target);

}  // namespace resilin::testing
