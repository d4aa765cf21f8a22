#include <set>

#include "resilin/core/error.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/scene/sections.hpp"

namespace resilin {
namespace {

template <class T>
void check_unique_names(const std::vector<T>& entries) {
  std::set<std::string> names;
  for (const T& entry : entries) {
    if (entry.name.empty()) throw InputError(entry.place + ".name", "a text that is not empty", "\"\"");
    if (!names.insert(entry.name).second) {
      throw InputError(entry.place + ".name", "a name of its own", '"' + printable(entry.name) + '"',
                       "an entry above has it; give this one another `name`");
    }
  }
}

}  // namespace

void check_names(const Description& description) {
  check_unique_names(description.bodies);
  check_unique_names(description.fixes);
  check_unique_names(description.loads);
  check_unique_names(description.probes);
  check_unique_names(description.sections);
}

}  // namespace resilin
