#include "kernel_benchmark.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <random>

#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/energy/elastic.hpp"

namespace resilin::bench {
namespace {

struct Cube {
  std::vector<Index> cells;
  VectorX rest_positions, positions;
};

/// The six tetrahedra of a cell of the Kuhn partition, by corner i + 2 j + 4 k, positive volume.
constexpr std::array<std::array<int, 4>, 6> kuhn = {
    {{0, 1, 3, 7}, {0, 5, 1, 7}, {0, 4, 5, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}}};

/// The nodes of a tetrahedron of degree 2 in a grid twice as fine as its corners: sums of corners.
constexpr std::array<std::array<int, 2>, 10> quadratic_nodes = {
    {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}};

Cube make_cube(int num_cells, int degree) {
  Cube cube;
  const int n = degree * num_cells, side = n + 1;
  const auto node = [side](int i, int j, int k) { return i + side * (j + side * k); };
  cube.rest_positions.resize(3 * Eigen::Index{side} * side * side);
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) cube.rest_positions.segment<3>(3 * node(i, j, k)) = Vector3(i, j, k) / n;
  for (int k = 0; k < n; k += degree)
    for (int j = 0; j < n; j += degree)
      for (int i = 0; i < n; i += degree)
        for (const auto& corners : kuhn)
          for (std::size_t a = 0; a < (degree == 1 ? 4 : 10); ++a) {
            const int c0 = corners[static_cast<std::size_t>(quadratic_nodes[a][0])];
            const int c1 = degree == 1 ? 0 : corners[static_cast<std::size_t>(quadratic_nodes[a][1])];
            cube.cells.push_back(node(i + c0 % 2 + c1 % 2, j + c0 / 2 % 2 + c1 / 2 % 2, k + c0 / 4 + c1 / 4));
          }
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.08 / n);
  cube.positions = cube.rest_positions;
  for (double& x : cube.positions) x += normal(random);
  return cube;
}

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

KernelTiming measure(const std::string& kernel, int repetitions, double num_cells,
                     const std::function<void()>& action) {
  std::vector<double> times;
  for (int i = 0; i < repetitions; ++i) {
    const double start = thread_seconds();
    action();
    times.push_back((thread_seconds() - start) * 1e9 / num_cells);
  }
  std::sort(times.begin(), times.end());
  return {kernel, times.front(), times[times.size() / 2]};
}

/// One thread for as long as it lives.
class OneThread {
 public:
  OneThread() : before_(num_threads()) { set_num_threads(1); }
  ~OneThread() { set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

}  // namespace

std::vector<KernelTiming> benchmark_kernels(const KernelBenchmarkOptions& options) {
  const OneThread one_thread;
  const Cube cube = make_cube(options.n, require_element(options.element, 3, "element").degree);
  const LawInfo& law = require_law(options.law, "law");
  const auto constants = law.constants_from(hooke_from_young_poisson(1e6, 0.45));
  ElasticEnergy energy(3, options.element, cube.cells, cube.rest_positions, law, constants, {},
                       options.instruction_set);
  BlockPatternBuilder builder(static_cast<Index>(cube.positions.size() / 3));
  energy.add_pattern(builder);
  const auto pattern = std::make_shared<BlockPattern>(builder.build());
  energy.bind(*pattern);
  BlockMatrix hessian(3, pattern);

  const VectorX& x = cube.positions;
  VectorX gradient = VectorX::Zero(x.size());
  volatile double sink = 0;  // keeps the energy from being left out
  const auto assemble = [&](Projection projection) {
    hessian.set_zero();
    energy.add_hessian(x, {}, projection, hessian);
  };
  const std::vector<std::pair<std::string, std::function<void()>>> kernels = {
      {"energy", [&] { sink = sink + energy.value(x, {}); }},
      {"forces", [&] { energy.add_gradient(x, {}, gradient); }},
      {"hessian", [&] { energy.evaluate_hessians(x, Projection::none); }},
      {"hessian_projected", [&] { energy.evaluate_hessians(x, Projection::clamp); }},
      {"hessian_assembled", [&] { assemble(Projection::none); }},
      {"hessian_projected_assembled", [&] { assemble(Projection::clamp); }}};
  std::vector<KernelTiming> timings;
  for (const auto& [name, action] : kernels)
    timings.push_back(measure(name, options.repetitions, energy.num_cells(), action));
  return timings;
}

}  // namespace resilin::bench
