#include "resilin/sweep/sweep.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "resilin/core/hash.hpp"
#include "resilin/core/text.hpp"
#include "resilin/linear/analysis_cache.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/scene/key.hpp"
#include "resilin/sweep/sampling.hpp"

namespace resilin {
namespace {

constexpr std::uint64_t most_scenes = 1000000000000;

bool draws(SweepMethod method) {
  return method == SweepMethod::latin_hypercube || method == SweepMethod::sobol;
}

/// A path, and what stands there, for each value that is no table.
void append_leaves(const std::string& path, const SceneValue& value, FileHashes& files, Fingerprint& leaves) {
  if (value.is_table()) {
    for (const SceneMember& member : value.table())
      append_leaves(path + "." + member.key, member.value, files, leaves);
    return;
  }
  const auto is_table = [](const SceneValue& entry) { return entry.is_table(); };
  if (value.is_array() && std::ranges::any_of(value.array(), is_table)) {
    for (std::size_t i = 0; i < value.array().size(); ++i) {
      const SceneValue* name = value.array()[i].find("name");
      const auto* text = name == nullptr ? nullptr : std::get_if<std::string>(&name->data);
      append_leaves(path + "." + (text == nullptr ? std::to_string(i) : *text), value.array()[i], files,
                    leaves);
    }
    return;
  }
  constexpr std::size_t longest = 200;
  std::string text = shown_value(value, files);
  if (text.size() > longest) text = "a long list (hash " + hash_text(hash_of(text)) + ")";
  leaves.emplace_back(path, std::move(text));
}

/// Values that a program has made have no place of their own.
void give_origin(SceneValue& value, const SceneValue& origin) {
  if (value.source) return;
  value.source = origin.source;
  value.line = origin.line;
}

}  // namespace

bool KeptScenes::has(std::uint64_t scene, bool is_done) const {
  if (kind == Kind::listed) return std::ranges::binary_search(numbers, static_cast<std::int64_t>(scene));
  return kind == Kind::all || (kind == Kind::failed && !is_done);
}

Sweep::Sweep(SweepDescription description)
    : description_(std::move(description)),
      files_(std::make_unique<FileHashes>(description_.folder.empty() ? "." : description_.folder)),
      meshes_(std::make_unique<MeshCache>()),
      analyses_(std::make_shared<AnalysisCache>()) {
  if (description_.parameters.empty())
    throw InputError(description_.place,
                     "there are no parameters; give keys of the scene with their values under "
                     "[parameters]");
  size_ = counted();
  check_targets();
  const std::optional<Description> readable = readable_scene();
  if (description_.quantities.empty()) {
    if (readable) description_.quantities = usual_quantities(*readable);
  } else if (readable) {
    check_quantities(description_.quantities, *readable);
  }
  check_columns();
}

std::uint64_t Sweep::counted() const {
  const std::string place = description_.place + ": method";
  const auto samples = static_cast<std::uint64_t>(description_.samples);
  if (draws(description_.method)) {
    if (samples == 0)
      throw InputError(description_.place + ": samples", "how many scenes are drawn", "nothing",
                       "give samples = 100");
    if (description_.method == SweepMethod::sobol && description_.parameters.size() > most_sobol_dimensions)
      throw InputError(place, "at most " + std::to_string(most_sobol_dimensions) + " parameters for sobol",
                       std::to_string(description_.parameters.size()), "latin_hypercube takes any number");
    return samples;
  }
  if (samples > 0)
    throw InputError(description_.place + ": samples", "a method that draws (latin_hypercube, sobol)",
                     spelling(description_.method), "leave out samples or choose another method");
  std::uint64_t count = 1;
  for (const SweepParameter& parameter : description_.parameters) {
    if (parameter.kind == SweepParameter::Kind::interval)
      throw InputError(parameter.place,
                       "a list of values, linspace, logspace or range for " + spelling(description_.method),
                       "an interval", "method = \"sobol\" draws from intervals");
    const std::uint64_t size = parameter.size();
    if (description_.method == SweepMethod::list) {
      const SweepParameter& first = description_.parameters.front();
      if (size != first.size())
        throw InputError(parameter.place,
                         std::to_string(first.size()) + " values, as many as for " + first.name,
                         std::to_string(size), "method = \"grid\" takes all combinations");
      count = size;
    } else {
      if (size > most_scenes / count)
        throw InputError(place, "at most 1e12 scenes", "more",
                         "method = \"sobol\" draws as many as you like");
      count *= size;
    }
  }
  return count;
}

std::vector<SceneValue> Sweep::values(std::uint64_t i) const {
  std::vector<SceneValue> values(description_.parameters.size());
  std::uint64_t rest = i;
  for (std::size_t p = values.size(); p-- > 0;) {
    const SweepParameter& parameter = description_.parameters[p];
    const auto seed = static_cast<std::uint64_t>(description_.seed);
    switch (description_.method) {
      case SweepMethod::grid:  // the last parameter varies fastest
        values[p] = parameter.value(rest % parameter.size());
        rest /= parameter.size();
        break;
      case SweepMethod::list:
        values[p] = parameter.value(i);
        break;
      case SweepMethod::latin_hypercube:
        values[p] = parameter.at(latin_hypercube(i, p, size_, seed));
        break;
      case SweepMethod::sobol:
        values[p] = parameter.at(shifted_sobol(i, p, seed));
        break;
    }
    give_origin(values[p], parameter.origin);
  }
  return values;
}

std::vector<std::string> Sweep::shown_values(std::uint64_t i) const {
  FileHashes no_files{""};
  std::vector<std::string> shown;
  for (const SceneValue& value : values(i)) shown.push_back(shown_value(value, no_files));
  return shown;
}

SceneValue Sweep::scene_values(std::uint64_t i) const {
  SceneValue scene = description_.base;
  std::vector<SceneValue> drawn = values(i);
  for (std::size_t p = 0; p < drawn.size(); ++p)
    for (const std::string& key : description_.parameters[p].keys)
      set_value(scene, key, drawn[p], description_.parameters[p].place);
  return scene;
}

SceneHash Sweep::hash(std::uint64_t i) const {
  std::string text = "sweep row 1\n" + std::string(version()) + '\n';
  try {
    text += canonical_text(scene_values(i), *files_);
  } catch (const UnknownKeyError&) {  // concerns this scene alone, which will be told so
    text += canonical_text(description_.base, *files_);
    for (const SceneValue& value : values(i)) text += canonical_text(value, *files_);
  }
  for (const Quantity& quantity : description_.quantities)
    text += '\n' + quantity.name + '\n' + quantity.of + ' ' + spelling(quantity.over);
  return scene_hash_of(text);
}

Scene Sweep::scene(std::uint64_t i) const {
  SceneOptions options;
  options.meshes = meshes_.get();
  return read_scene_from_values(scene_values(i), description_.base_name, description_.folder, options);
}

std::string Sweep::name_of(std::uint64_t i) const {
  const std::vector<std::string> shown = shown_values(i);
  std::vector<std::string> words;
  for (std::size_t p = 0; p < shown.size(); ++p)
    words.push_back(description_.parameters[p].name + " = " + shown[p]);
  return one_line("scene " + std::to_string(i) + " (" + join(words) + ")");
}

Fingerprint Sweep::identity() const {
  Fingerprint identity = {{"version", std::string(version())}, {"method", spelling(description_.method)}};
  if (draws(description_.method)) {
    identity.emplace_back("samples", std::to_string(description_.samples));
    identity.emplace_back("seed", std::to_string(description_.seed));
  }
  for (const SweepParameter& parameter : description_.parameters) {
    identity.emplace_back("parameter " + parameter.name, describe_values(parameter));
    if (parameter.keys != std::vector{parameter.name})
      identity.emplace_back("keys of " + parameter.name, join(parameter.keys));
  }
  for (const Quantity& quantity : description_.quantities)
    identity.emplace_back("quantity " + quantity.name, quantity.of + ", " + spelling(quantity.over));
  append_leaves("base", description_.base, *files_, identity);
  for (auto& [name, text] : identity) {  // as sweep.json holds it
    name = one_line(name);
    text = one_line(text);
  }
  return identity;
}

void Sweep::check_columns() const {
  std::set<std::string> names = {"scene",    "hash",    "status", "reason", "steps", "newton_iterations",
                                 "unknowns", "seconds", "kept"};
  const auto check = [&names](const std::string& name, const std::string& place) {
    if (!names.insert(name).second)
      throw InputError(place, "a column of its own", '"' + one_line(name) + '"',
                       "the table has such a column already; give another `name`");
  };
  for (const SweepParameter& parameter : description_.parameters) check(parameter.name, parameter.place);
  for (const Quantity& quantity : description_.quantities) check(quantity.name, quantity.place);
}

/// No two parameters may set the same value: the second would make the first idle.
void Sweep::check_targets() const {
  std::set<std::string> targets;
  for (const SweepParameter& parameter : description_.parameters)
    for (const std::string& key : parameter.keys)
      if (!targets.insert(numbered_key(description_.base, key, parameter.place)).second)
        throw InputError(parameter.place, "a key of its own", '"' + one_line(key) + '"',
                         "another parameter sets the same value");
}

/// A scene that can be read, where one of the first can; every key is known there or in another.
std::optional<Description> Sweep::readable_scene() const {
  constexpr std::uint64_t most_tries = 8;
  std::optional<Description> readable;
  std::optional<UnknownKeyError> unknown;
  bool is_unknown_everywhere = true;
  for (std::uint64_t i = 0; i < std::min(size_, most_tries) && !readable; ++i) {
    try {
      readable = scene(i * (size_ / std::min(size_, most_tries))).description;
    } catch (const UnknownKeyError& error) {
      unknown = error;
    } catch (const InputError&) {  // a value that scenes refuse: theirs to say
      is_unknown_everywhere = false;
    }
  }
  if (readable && !unknown) return readable;
  for (std::size_t p = 0; p < description_.parameters.size(); ++p) {
    std::string message;
    if (!is_known(p, message)) throw InputError(description_.parameters[p].place, message);
  }
  if (!readable && unknown && is_unknown_everywhere) throw *unknown;  // error of the base scene
  return readable;
}

/// Whether the keys of a parameter are known in the base scene, or in some scene with other values of the
/// other parameters, such as another law; `message` says of what they are unknown.
bool Sweep::is_known(std::size_t parameter, std::string& message) const {
  constexpr std::uint64_t most_tries = 64;
  const SweepParameter& looked_at = description_.parameters[parameter];
  SceneOptions options;
  options.meshes = meshes_.get();
  const auto is_known_in = [&](SceneValue scene) {
    try {
      read_scene_from_values(std::move(scene), description_.base_name, description_.folder, options);
    } catch (const UnknownKeyError& error) {
      const std::string text = error.what();
      for (const std::string& key : looked_at.keys) {
        const std::string last = key.substr(key.find_last_of('.') + 1);
        if (text.find("unknown key \"" + last + '"') == std::string::npos) continue;
        message = text.substr(std::min(text.find("unknown key"), text.size()));
        return false;
      }
    } catch (const InputError&) {
    }
    return true;
  };
  for (std::uint64_t i = 0; i < std::min(size_, most_tries); ++i) {
    try {
      if (is_known_in(scene_values(i * (size_ / std::min(size_, most_tries))))) return true;
    } catch (const UnknownKeyError& error) {
      message = error.what();
    }
  }
  return message.empty();
}

}  // namespace resilin
