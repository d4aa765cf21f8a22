#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scenes.hpp"

namespace resilin::bench {

struct BenchOptions {
  int n = 0;  ///< size of the problem; 0: the benchmark's own
  std::string element = "P1";
  bool dynamic = false;  ///< motion instead of statics, where a benchmark has both
};

struct Benchmark {
  std::string name;
  std::string text;  ///< one sentence: what is measured
  std::function<std::vector<Measurement>(const BenchOptions&)> run;
};

/// All built-in benchmarks. A new one is a function and one line.
const std::vector<Benchmark>& benchmarks();

}  // namespace resilin::bench
