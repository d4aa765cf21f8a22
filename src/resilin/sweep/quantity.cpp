#include "resilin/sweep/quantity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "resilin/core/text.hpp"
#include "resilin/fields/extremes.hpp"
#include "resilin/scene/key.hpp"

namespace resilin {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view smallest = "min.", largest = "max.";  // smallest and largest of a field

using NumberOfFrame = std::pair<const char*, std::optional<double> (*)(const Frame&)>;

/// Numbers of a frame by name.
constexpr std::array numbers = {
    NumberOfFrame{"energy.elastic", [](const Frame& f) -> std::optional<double> { return f.elastic_energy; }},
    NumberOfFrame{"energy.kinetic", [](const Frame& f) -> std::optional<double> { return f.kinetic_energy; }},
    NumberOfFrame{"energy.external",
                  [](const Frame& f) -> std::optional<double> { return f.external_energy; }},
    NumberOfFrame{"energy.contact", [](const Frame& f) -> std::optional<double> { return f.contact_energy; }},
    NumberOfFrame{"energy.total", [](const Frame& f) -> std::optional<double> { return f.total_energy(); }},
    NumberOfFrame{"energy.dissipated",
                  [](const Frame& f) -> std::optional<double> { return f.dissipated_energy; }},
    NumberOfFrame{"energy.friction", [](const Frame& f) -> std::optional<double> { return f.friction_work; }},
    NumberOfFrame{"work",
                  [](const Frame& f) -> std::optional<double> {
                    return f.elastic_energy + f.kinetic_energy + f.contact_energy + f.dissipated_energy;
                  }},
    NumberOfFrame{"min_volume_ratio",
                  [](const Frame& f) -> std::optional<double> { return f.min_volume_ratio; }},
    NumberOfFrame{"load", [](const Frame& f) -> std::optional<double> { return f.load; }},
    NumberOfFrame{"time", [](const Frame& f) -> std::optional<double> { return f.time; }},
    NumberOfFrame{"residual", [](const Frame& f) -> std::optional<double> { return f.residual; }},
    NumberOfFrame{"unstable_modes",
                  [](const Frame& f) -> std::optional<double> {
                    return f.unstable_modes ? std::optional<double>(*f.unstable_modes) : std::nullopt;
                  }},
    NumberOfFrame{"frequency",
                  [](const Frame& f) -> std::optional<double> {
                    return f.mode ? std::optional(f.mode->frequency) : std::nullopt;
                  }},
};

/// NAME of "before" + NAME + "after".
std::optional<std::string_view> between(std::string_view text, std::string_view before,
                                        std::string_view after) {
  if (text.size() <= before.size() + after.size() || !text.starts_with(before) || !text.ends_with(after))
    return std::nullopt;
  return text.substr(before.size(), text.size() - before.size() - after.size());
}

std::optional<Vector3> vector_in(const Frame& frame, std::string_view of) {
  if (of == "momentum.linear") return frame.linear_momentum;
  if (of == "momentum.angular") return frame.angular_momentum;
  for (const Frame::ProbeValue& probe : frame.probes) {
    if (between(of, "probe.", ".displacement") == probe.name) return probe.displacement;
    if (between(of, "probe.", ".velocity") == probe.name) return probe.velocity;
  }
  for (const SectionForce& section : frame.sections) {
    if (between(of, "section.", ".force") == section.name) return section.force;
    if (between(of, "section.", ".moment") == section.name) return section.moment;
  }
  for (std::size_t i = 0; i < frame.reactions.size(); ++i) {
    if (between(of, "reaction.", "") == frame.reactions[i].first) return frame.reactions[i].second;
    if (between(of, "reaction_moment.", "") == frame.reactions[i].first) return frame.reaction_torques[i];
  }
  return std::nullopt;
}

double number_in(const Frame& frame, std::string_view of) {
  for (const auto& [name, read] : numbers)
    if (of == name) return read(frame).value_or(none);
  if (const std::optional<Vector3> whole = vector_in(frame, of)) return whole->norm();
  if (of.size() < 2 || of[of.size() - 2] != '.') return none;
  const std::size_t axis = std::string_view("xyz").find(of.back());
  const std::optional<Vector3> vector = vector_in(frame, of.substr(0, of.size() - 2));
  return vector && axis != std::string_view::npos ? (*vector)[static_cast<Eigen::Index>(axis)] : none;
}

/// The vectors that a scene can be asked for.
std::vector<std::string> vector_names(const Description& description) {
  std::vector<std::string> names = {"momentum.linear", "momentum.angular"};
  for (const ProbeDescription& probe : description.probes)
    for (const char* part : {".displacement", ".velocity"}) names.push_back("probe." + probe.name + part);
  for (const SectionDescription& section : description.sections)
    for (const char* part : {".force", ".moment"}) names.push_back("section." + section.name + part);
  const auto add_reactions = [&names](const auto& list) {
    for (const auto& entry : list)
      for (const char* part : {"reaction.", "reaction_moment."}) names.push_back(part + entry.name);
  };
  add_reactions(description.fixes);
  add_reactions(description.colliders);
  return names;
}

/// Reads a list of texts and tables, or one of them.
Quantity read_quantity(const SceneNode& node) {
  Quantity quantity;
  quantity.place = node.place();
  if (node.value->is_table()) {
    using Q = Quantity;
    const Keys<Q> keys = {
        text_key("name", &Q::name, "of, then over", "Name of the column."),
        key<Q>({"of", "text", "", "required", "Quantity."},
               [](const SceneNode& n, Q& q) { q.of = read_text(n); }),
        choice_key("over", &Q::over, "Reduction of its values over all steps."),
    };
    read_table(node, keys, quantity);
  } else {
    if (!std::holds_alternative<std::string>(node.value->data)) node.fail("a text or a table with `of`");
    quantity.of = read_text(node);
  }
  if (quantity.of.empty()) node.fail("a text that is not empty");
  if (quantity.name.empty())
    quantity.name = quantity.of + (quantity.over == OverSteps::last ? "" : "." + spelling(quantity.over));
  return quantity;
}

std::string field_of(std::string_view of) {
  if (of.starts_with(smallest) || of.starts_with(largest)) return std::string(of.substr(smallest.size()));
  return {};
}

}  // namespace

std::vector<Quantity> read_quantities(const SceneNode& node) {
  expect_list(node, "quantities");
  std::vector<Quantity> quantities;
  std::set<std::string> names;
  for (std::size_t i = 0; i < node.value->array().size(); ++i) {
    quantities.push_back(read_quantity(node.element(i)));
    if (!names.insert(quantities.back().name).second)
      node.element(i).fail_with("the column \"" + quantities.back().name +
                                "\" is there already; give this one another `name`");
  }
  return quantities;
}

std::vector<Quantity> usual_quantities(const Description& description) {
  std::vector<Quantity> quantities;
  const auto add = [&quantities](const std::string& of) {
    quantities.push_back({.name = of, .of = of, .place = of});
  };
  const std::string axes = std::string("xyz").substr(0, static_cast<std::size_t>(description.dimension));
  for (const ProbeDescription& probe : description.probes)
    for (const char axis : axes) add("probe." + probe.name + ".displacement." + axis);
  const auto add_reactions = [&](const auto& list) {
    for (const auto& entry : list)
      for (const char axis : axes) add("reaction." + entry.name + "." + axis);
  };
  add_reactions(description.fixes);
  add_reactions(description.colliders);
  if (description.modes) quantities.push_back({"frequency.all", "frequency", OverSteps::all, "frequency"});
  add("energy.elastic");
  add("min_volume_ratio");
  return quantities;
}

std::vector<std::string> quantity_names(const Description& description) {
  std::vector<std::string> names;
  for (const std::string& vector : vector_names(description)) {
    names.push_back(vector);
    for (const char axis : std::string_view("xyz")) names.push_back(vector + "." + axis);
  }
  for (const auto& [name, read] : numbers) names.emplace_back(name);
  for (const FieldInfo& field : fields()) {
    if (field.kind == FieldInfo::Kind::tensor) continue;  // has no smallest and no largest
    names.push_back(std::string(smallest) + field.name);
    names.push_back(std::string(largest) + field.name);
  }
  return names;
}

void check_quantities(const std::vector<Quantity>& quantities, const Description& description) {
  const std::vector<std::string> names = quantity_names(description);
  for (const Quantity& quantity : quantities) {
    if (std::ranges::find(names, quantity.of) != names.end()) continue;
    const std::string cure = did_you_mean(quantity.of, names);
    throw InputError(quantity.place, "a quantity of the scene", '"' + quantity.of + '"',
                     cure.empty() ? "docs/sweep.md lists them" : cure);
  }
}

QuantityRecorder::QuantityRecorder(const std::vector<Quantity>& quantities, const World& world)
    : quantities_(quantities), world_(world), taken_(quantities.size()) {}

void QuantityRecorder::record(const Simulation& simulation) {
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    const OverSteps over = quantities_[i].over;
    Taken& taken = taken_[i];
    const bool is_first = taken.count == 0;
    if (over == OverSteps::last || (over == OverSteps::first && !is_first)) continue;
    double value = value_of(quantities_[i], simulation);
    if (over == OverSteps::max_abs) value = std::abs(value);
    if (over == OverSteps::all) {
      if (!is_first || !std::isnan(value)) taken.values.push_back(value);  // modes begin after the start
      ++taken.count;
      continue;
    }
    if (std::isnan(value)) continue;
    const double before = taken.values.empty() ? value : taken.values.front();
    double now = value;
    if (over == OverSteps::min) now = std::min(before, value);
    if (over == OverSteps::max || over == OverSteps::max_abs) now = std::max(before, value);
    if (over == OverSteps::mean && taken.count > 0) now = before + (value - before) / (taken.count + 1);
    taken.values = {now};
    ++taken.count;
  }
}

void QuantityRecorder::finish(const Simulation& simulation) {
  for (std::size_t i = 0; i < quantities_.size(); ++i)
    if (quantities_[i].over == OverSteps::last) taken_[i].values = {value_of(quantities_[i], simulation)};
}

std::vector<std::vector<double>> QuantityRecorder::values() const {
  std::vector<std::vector<double>> values;
  for (std::size_t i = 0; i < quantities_.size(); ++i) {
    values.push_back(taken_[i].values);
    if (quantities_[i].over != OverSteps::all && values.back().empty()) values.back() = {none};
  }
  return values;
}

double QuantityRecorder::value_of(const Quantity& quantity, const Simulation& simulation) {
  if (!field_of(quantity.of).empty()) return field_extreme(quantity.of, simulation);
  return number_in(simulation.frame(), quantity.of);
}

double QuantityRecorder::field_extreme(const std::string& of, const Simulation& simulation) {
  const State& state = simulation.state();
  if (step_ != state.step || fields_.empty()) {
    fields_.clear();
    step_ = state.step;
  }
  const std::string name = field_of(of);
  auto known = std::ranges::find_if(fields_, [&name](const FieldValues& f) { return f.field->name == name; });
  if (known == fields_.end()) {
    if (!evaluator_) evaluator_ = std::make_unique<FieldEvaluator>(world_);
    const std::vector<std::string> wanted = {name};
    fields_.push_back(std::move(evaluator_->evaluate(state, wanted).front()));
    known = std::prev(fields_.end());
  }
  const std::optional<Extremes> found = extremes(world_, state, *known);
  if (!found) return none;
  return of.starts_with(smallest) ? found->min.value : found->max.value;
}

}  // namespace resilin
