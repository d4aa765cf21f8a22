#include "conditions.hpp"

#include <string>
#include <vector>

#include "resilin/core/text.hpp"
#include "resilin/world/resultants.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

void print_resultants(const std::string& word, const std::vector<Resultant>& list, int dim,
                      std::size_t most) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i == most && list.size() > most + 1) {
      print_line("... and " + std::to_string(list.size() - most) + " more of [[" + word + "]]");
      return;
    }
    print_line(word + " " + one_line(list[i].name) + ": " + describe(list[i], dim));
  }
}

}  // namespace

void print_conditions(const World& world, std::size_t most) {
  print_resultants("fix", fixed_selections(world), world.dimension, most);
  print_resultants("load", load_resultants(world), world.dimension, most);
}

}  // namespace resilin::cli
