#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace resilin::cli {

struct BenchOptions {
  int n = 0;  ///< size of the problem; 0: the benchmark's own
  std::string element = "P1";
  bool dynamic = false;  ///< motion instead of statics, where a benchmark has both
};

/// A measured quantity, such as {"seconds_per_step", 0.0045}.
using Measurement = std::pair<std::string, double>;

struct Benchmark {
  std::string name;
  std::string text;  ///< one sentence: what is measured
  std::function<std::vector<Measurement>(const BenchOptions&)> run;
};

/// All built-in benchmarks. A new one is a function and one line.
const std::vector<Benchmark>& benchmarks();

}  // namespace resilin::cli
