#include <array>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/integrator/backward_euler.hpp"
#include "resilin/integrator/bdf2.hpp"
#include "resilin/integrator/midpoint.hpp"
#include "resilin/integrator/newmark.hpp"
#include "resilin/integrator/tr_bdf2.hpp"

namespace resilin {
namespace {

struct Entry {
  std::string_view name;
  std::unique_ptr<Integrator> (*make)();
};

template <class Scheme>
std::unique_ptr<Integrator> make() {
  return std::make_unique<Scheme>();
}

constexpr std::array catalog = {
    Entry{"backward_euler", make<BackwardEuler>},
    Entry{"bdf2", make<Bdf2>},
    Entry{"tr_bdf2", make<TrBdf2>},
    Entry{"newmark", make<Newmark>},
    Entry{"midpoint", make<Midpoint>},
};

}  // namespace

std::unique_ptr<Integrator> make_integrator(std::string_view name, const std::string& place) {
  for (const Entry& entry : catalog) {
    if (entry.name == name) return entry.make();
  }
  throw InputError(place, "one of " + join(integrator_names()), "\"" + std::string(name) + "\"");
}

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const Entry& entry : catalog) names.emplace_back(entry.name);
  return names;
}

}  // namespace resilin
