#include <algorithm>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/scene/key.hpp"
#include "resilin/sweep/sweep.hpp"

namespace resilin {
namespace {

void read_base(const SceneNode& node, SweepDescription& d) {
  if (node.value->is_table()) {
    d.base = *node.value;
    d.base_name = d.place;
    d.folder = node.context->folder;
    return;
  }
  if (!std::holds_alternative<std::string>(node.value->data)) node.fail("the name of a scene file");
  const std::filesystem::path path = read_path(node);
  d.base = parse_toml(read_file(path), path.string());
  d.base_name = path.string();
  d.folder = path.parent_path();
}

void read_keep(const SceneNode& node, KeptScenes& keep) {
  using Kind = KeptScenes::Kind;
  if (!node.value->is_array()) {
    const std::string word =
        std::holds_alternative<std::string>(node.value->data) ? read_text(node) : std::string();
    if (word != "none" && word != "all" && word != "failed")
      node.fail("\"none\", \"all\", \"failed\" or a list of numbers of scenes",
                did_you_mean(word, std::vector<std::string>{"none", "all", "failed"}));
    keep.kind = word == "none" ? Kind::none : word == "all" ? Kind::all : Kind::failed;
    return;
  }
  keep.kind = Kind::listed;
  for (std::size_t i = 0; i < node.value->array().size(); ++i)
    keep.numbers.push_back(read_integer(node.element(i), not_negative));
  std::ranges::sort(keep.numbers);
}

SweepDescription read_root(const SceneNode& root, const std::string& name) {
  refuse_unknown_keys(root, {"base", "parameters", "parameter", "method", "samples", "seed", "quantities",
                             "quantity", "keep"});
  SweepDescription d;
  d.place = name;
  if (!root.has("base"))
    root.fail_with("the key \"base\" is missing; give the scene that is varied, base = \"scene.toml\"");
  read_base(root.child("base"), d);
  if (root.has("parameters")) read_parameters(root.child("parameters"), d.parameters);
  if (root.has("parameter")) {
    const SceneNode list = root.child("parameter");
    if (!list.value->is_array()) list.fail("a list of tables, each headed [[parameter]]");
    for (std::size_t i = 0; i < list.value->array().size(); ++i)
      d.parameters.push_back(read_parameter(list.element(i)));
  }
  if (root.has("method")) d.method = read_choice<SweepMethod>(root.child("method"));
  if (root.has("samples")) d.samples = read_integer(root.child("samples"), at_least_one);
  if (root.has("seed")) d.seed = read_integer(root.child("seed"), not_negative);
  if (root.has("quantities") && root.has("quantity"))
    root.child("quantity").fail_with("stands beside `quantities`; put both into one list");
  for (const char* key : {"quantities", "quantity"})
    if (root.has(key)) d.quantities = read_quantities(root.child(key));
  if (root.has("keep")) read_keep(root.child("keep"), d.keep);
  return d;
}

}  // namespace

Sweep read_sweep_from_values(SceneValue values, const std::string& name,
                             const std::filesystem::path& folder) {
  values.source = std::make_shared<const std::string>(name);
  values.line = 0;
  SceneContext context;
  context.folder = folder;
  return Sweep(read_root({&values, "", &context}, name));
}

Sweep read_sweep(const std::filesystem::path& path) {
  return read_sweep_from_values(parse_toml(read_file(path), path.string()), path.string(),
                                path.parent_path());
}

}  // namespace resilin
