#include "fuzz_driver.hpp"

#include <sys/resource.h>
#include <sys/time.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

#include "mutation.hpp"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
// The sanitizer reserves address space by the terabyte, so it has to watch the memory itself.
extern "C" const char* __asan_default_options() {
  return "max_allocation_size_mb=512:hard_rss_limit_mb=4096";
}
extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1:abort_on_error=1"; }
#endif

namespace resilin::testing {
namespace {

constexpr long seconds_per_input =
    10;  // seconds per input of processor time, which a busy machine does not shorten
constexpr rlim_t memory_limit = rlim_t{1} << 30;

struct Options {
  std::uint64_t iterations = 20000;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> only = {};
  std::vector<std::filesystem::path> folders = {};
};

/// Data for a handler when the process dies.
volatile std::uint64_t current_number = 0;
volatile std::uint64_t current_seed = 0;

void say_where() {
  std::fprintf(stderr, "fuzz: died at --seed %llu --only %llu\n",
               static_cast<unsigned long long>(current_seed),
               static_cast<unsigned long long>(current_number));
}

void die(int signal_number) {
  say_where();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

void watch() {
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_set_death_callback(say_where);
#else
  const rlimit limit{memory_limit, memory_limit};
  setrlimit(RLIMIT_AS, &limit);
  for (const int number : {SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(number, die);
#endif
  std::signal(SIGABRT, die);
  std::signal(SIGPROF, die);  // a hang
}

Options options_of(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto number = [&] { return i + 1 < argc ? std::strtoull(argv[++i], nullptr, 10) : 0; };
    if (word == "--iterations") {
      options.iterations = number();
    } else if (word == "--seed") {
      options.seed = number();
    } else if (word == "--only") {
      options.only = number();
    } else {
      options.folders.emplace_back(word);
    }
  }
  return options;
}

std::map<std::string, std::string> read_corpus(const std::vector<std::filesystem::path>& folders) {
  std::map<std::string, std::string> corpus;
  for (const auto& folder : folders) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (!entry.is_regular_file() || entry.path().extension() == ".json") continue;
      std::ifstream stream(entry.path(), std::ios::binary);
      corpus[entry.path().filename().string()] = std::string(std::istreambuf_iterator<char>(stream), {});
    }
  }
  return corpus;
}

void save(const FuzzInput& input) {
  const std::string name = "fuzz_failure_" + std::to_string(current_seed) + "_" +
                           std::to_string(current_number) +
                           std::filesystem::path(input.name).extension().string();
  std::ofstream(name, std::ios::binary) << input.bytes;
  std::fprintf(stderr, "fuzz: saved %s\n", name.c_str());
}

/// From now on; 0 takes the limit back.
void limit_seconds(long seconds) {
  itimerval limit{};
  limit.it_value.tv_sec = seconds;
  setitimer(ITIMER_PROF, &limit, nullptr);
}

bool passes(const FuzzTarget& target, const FuzzInput& input) {
  limit_seconds(seconds_per_input);
  bool is_passed = false;
  try {
    target(input);
    is_passed = true;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz: %s: %s\n", input.name.c_str(), error.what());
  } catch (...) {
    std::fprintf(stderr, "fuzz: %s: something thrown that is no exception\n", input.name.c_str());
  }
  limit_seconds(0);
  if (!is_passed) {
    say_where();
    save(input);
  }
  return is_passed;
}

}  // namespace

int fuzz_main(int argc, char** argv, const FuzzTarget& target) {
  const Options options = options_of(argc, argv);
  const auto corpus = read_corpus(options.folders);
  if (corpus.empty()) {
    std::fprintf(stderr, "usage: %s [--iterations N] [--seed S] [--only I] CORPUS_FOLDER...\n", argv[0]);
    return 2;
  }
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> same_format;  // by extension
  for (const auto& [name, bytes] : corpus) {
    names.push_back(name);
    same_format[std::filesystem::path(name).extension().string()].push_back(bytes);
  }
  watch();
  current_seed = options.seed;
  int num_failures = 0;
  const std::uint64_t first = options.only.value_or(0);
  const std::uint64_t last = options.only ? first + 1 : options.iterations;
  for (std::uint64_t i = first; i < last && num_failures < 10; ++i) {
    current_number = i;
    Dice dice(options.seed * 0x9e3779b97f4a7c15u + i);
    const std::string& name = names[dice.below(names.size())];
    const auto& others = same_format[std::filesystem::path(name).extension().string()];
    const FuzzInput input{name, mutated(corpus.at(name), others, dice), corpus};
    if (!passes(target, input)) ++num_failures;
  }
  std::printf("fuzz: %llu inputs from %zu files, %d failed\n", static_cast<unsigned long long>(last - first),
              names.size(), num_failures);
  return num_failures == 0 ? 0 : 1;
}

}  // namespace resilin::testing
