#include <set>

#include "resilin/core/error.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

/// The entries of all lists together.
template <class... T>
void check_unique_names(const std::vector<T>&... lists) {
  std::set<std::string> names;
  const auto check = [&names](const auto& entries) {
    for (const auto& entry : entries) {
      if (entry.name.empty()) throw InputError(entry.place + ".name", "a text that is not empty", "\"\"");
      if (!names.insert(entry.name).second) {
        throw InputError(entry.place + ".name", "a name of its own", '"' + printable(entry.name) + '"',
                         "another entry has it; give this one another `name`");
      }
    }
  };
  (check(lists), ...);
}

}  // namespace

void check_names(const Description& description) {
  check_unique_names(description.bodies);
  // The report lists them all as reactions.
  check_unique_names(description.fixes, description.ties, description.constraints, description.colliders);
  check_unique_names(description.joints);
  check_unique_names(description.springs, description.cables);
  check_unique_names(description.loads);
  check_unique_names(description.probes);
  check_unique_names(description.sections);
}

}  // namespace resilin
