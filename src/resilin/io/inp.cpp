#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/inp_model.hpp"
#include "resilin/io/line_scanner.hpp"
#include "resilin/io/text_scanner.hpp"

// Meshes of Abaqus and CalculiX: nodes, elements, parts and instances, sets and surfaces. Everything else, as
// materials and steps, is passed over. Source: Dassault Systemes, "Abaqus Keywords Reference Guide"; Dhondt,
// "CalculiX CrunchiX User's Manual", chapter 7.

namespace resilin {
namespace {

constexpr std::size_t most_nested_files = 8, most_included_files = 100;

/// "*ELEMENT, TYPE=C3D4, ELSET=body": names in small letters, values as they are.
struct InpKeyword {
  std::string name;
  std::map<std::string, std::string, std::less<>> parameters;

  std::string value(std::string_view parameter) const {
    const auto found = parameters.find(parameter);
    return found == parameters.end() ? "" : found->second;
  }
  bool has(std::string_view parameter) const { return parameters.contains(parameter); }
};

/// The lines of a file and of the files that it includes, without comments.
class InpLines {
 public:
  explicit InpLines(const MeshSource& source) : source_(&source) {
    open_.push_back({nullptr, LineScanner(source.name, source.bytes)});
  }

  bool next() {
    while (true) {
      if (!open_.back().lines.next()) {
        if (open_.size() == 1) return false;
        open_.pop_back();
        continue;
      }
      const std::string_view line = trimmed(at().line());
      if (!line.empty() && !line.starts_with("**")) return true;
    }
  }

  /// Moves to the next line unless that is a keyword.
  bool next_data() {
    if (!next()) return false;
    const bool is_data = trimmed(at().line())[0] != '*';
    if (!is_data) open_.back().lines.repeat();
    return is_data;
  }

  const LineScanner& at() const { return open_.back().lines; }

  void include(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const std::string cure = "copy the included file into this one";
    if (open_.size() > most_nested_files || ++num_included_ > most_included_files)
      at().fail("at most " + std::to_string(most_nested_files) + " files inside each other and " +
                    std::to_string(most_included_files) + " in all",
                "more of them", cure);
    auto bytes = std::make_unique<std::string>(source_->file_beside(name, at().place(), cure));
    LineScanner lines(std::filesystem::path(source_->name).replace_filename(name).string(), *bytes);
    open_.push_back({std::move(bytes), std::move(lines)});
  }

 private:
  struct Open {
    std::unique_ptr<std::string> bytes;  ///< bytes of an included file
    LineScanner lines;
  };

  const MeshSource* source_;
  std::vector<Open> open_;
  std::size_t num_included_ = 0;
};

class InpReader {
 public:
  explicit InpReader(const MeshSource& source) : lines_(source) {
    model_.parts.push_back({});
    model_.instances.push_back({"", 0});
  }

  InpModel read() {
    while (lines_.next()) {
      const std::string_view line = trimmed(lines_.at().line());
      if (line[0] != '*') {
        if (!has_keyword_) lines_.at().fail("a keyword such as *NODE at the start", line);
        continue;  // data of a keyword that is passed over
      }
      has_keyword_ = true;
      read_keyword(keyword());
    }
    if (scope_ != Scope::model)
      lines_.at().fail("*END " + std::string(scope_ == Scope::part ? "PART" : "INSTANCE"),
                       "the end of the file", "the file is cut");
    return std::move(model_);
  }

 private:
  enum class Scope { model, part, instance };

  InpPart& part() { return model_.parts[part_]; }

  InpKeyword keyword() {
    std::string text(trimmed(lines_.at().line()));
    while (text.ends_with(',') && lines_.next()) text += trimmed(lines_.at().line());
    const std::vector<std::string_view> words = split(text, ',');
    InpKeyword result{lower_case(words[0].substr(1)), {}};
    for (std::size_t i = 1; i < words.size(); ++i) {
      const std::size_t equals = words[i].find('=');
      const std::string_view value =
          equals == words[i].npos ? std::string_view() : trimmed(words[i].substr(equals + 1));
      result.parameters[lower_case(trimmed(words[i].substr(0, equals)))] = unquoted(value);
    }
    return result;
  }

  static std::string unquoted(std::string_view text) {
    const bool is_quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
    return std::string(is_quoted ? text.substr(1, text.size() - 2) : text);
  }

  void read_keyword(const InpKeyword& keyword) {
    const std::string& name = keyword.name;
    if (name == "include") return lines_.include(required(keyword, "input"));
    if (name == "part") return begin_part(keyword);
    if (name == "instance") return begin_instance(keyword);
    if (name == "end part") return end(Scope::part, name);
    if (name == "end instance") return end(Scope::instance, name);
    if (name == "ngen" || name == "nfill" || name == "ncopy" || name == "nmap" || name == "elgen" ||
        name == "elcopy")
      lines_.at().fail("nodes and elements one by one", "*" + printable(name),
                       "have them written out by Abaqus/CAE or by cgx of CalculiX");
    const bool is_mesh =
        name == "node" || name == "element" || name == "nset" || name == "elset" || name == "surface";
    if (!is_mesh) return;
    if (scope_ == Scope::instance) make_part_of_instance();
    if (name == "node") read_nodes(keyword);
    if (name == "element") read_elements(keyword);
    if (name == "nset") read_set(part().node_sets, keyword, "nset");
    if (name == "elset") read_set(part().element_sets, keyword, "elset");
    if (name == "surface") read_surface(keyword);
  }

  std::string required(const InpKeyword& keyword, std::string_view parameter) const {
    std::string value = keyword.value(parameter);
    if (value.empty())
      lines_.at().fail("a parameter " + std::string(parameter) + "=... of *" + printable(keyword.name),
                       "none");
    return value;
  }

  void begin_part(const InpKeyword& keyword) {
    if (scope_ != Scope::model) lines_.at().fail("the end of the part before", "*PART");
    scope_ = Scope::part;
    part_ = model_.parts.size();
    model_.parts.push_back({.name = required(keyword, "name")});
  }

  /// Lines that may follow: "x, y, z" moves the part; "ax, ay, az, bx, by, bz, angle" then turns it about the
  /// axis from a to b.
  void begin_instance(const InpKeyword& keyword) {
    if (scope_ != Scope::model) lines_.at().fail("the end of the part before", "*INSTANCE");
    const std::string of = required(keyword, "part"), name = required(keyword, "name");
    const auto is_meant = [&](const InpPart& known) { return lower_case(known.name) == lower_case(of); };
    const auto found = std::find_if(model_.parts.begin() + 1, model_.parts.end(), is_meant);
    if (found == model_.parts.end()) lines_.at().fail("the name of a *PART before it", printable(of));
    scope_ = Scope::instance;
    InpInstance instance{name, static_cast<std::size_t>(found - model_.parts.begin())};
    if (lines_.next_data()) {
      for (int i = 0; i < 3; ++i) instance.translation[i] = real_of_line(i, "a component of a translation");
      if (lines_.next_data()) turn(instance);
    }
    model_.instances.push_back(std::move(instance));
  }

  void turn(InpInstance& instance) {
    Vector3 a, b;
    for (int i = 0; i < 3; ++i) a[i] = real_of_line(i, "a coordinate of an axis");
    for (int i = 0; i < 3; ++i) b[i] = real_of_line(3 + i, "a coordinate of an axis");
    const double angle = real_of_line(6, "an angle");
    const double length = (b - a).norm();
    if (!(length > 0 && std::isfinite(length)))
      lines_.at().fail("two points of an axis that differ", trimmed(lines_.at().line()));
    instance.rotation =
        Eigen::AngleAxisd(angle * std::numbers::pi / 180, (b - a) / length).toRotationMatrix();
    instance.translation = instance.rotation * (instance.translation - a) + a;
  }

  double real_of_line(int number, const std::string& what) const {
    const std::vector<std::string_view> fields = split(lines_.at().line(), ',');
    const auto i = static_cast<std::size_t>(number);
    if (i >= fields.size() || fields[i].empty()) return 0;
    return lines_.at().real(fields[i], what);
  }

  /// Makes a part of the lines inside *INSTANCE.
  void make_part_of_instance() {
    InpInstance& instance = model_.instances.back();
    if (part_ == 0) {
      InpPart copy = model_.parts[instance.part];
      instance.part = part_ = model_.parts.size();
      model_.parts.push_back(std::move(copy));
    }
  }

  void end(Scope scope, const std::string& keyword) {
    if (scope_ != scope) lines_.at().fail("*" + keyword.substr(4) + " before its end", "*" + keyword);
    scope_ = Scope::model;
    part_ = 0;
  }

  std::int64_t number(std::string_view field, std::string_view what) const {
    const std::int64_t value = lines_.at().integer(field, what);
    if (value < 1 || value > max_file_number)
      lines_.at().fail(std::string(what) + " from 1 to " + std::to_string(max_file_number), field);
    return value;
  }

  /// The set to which what the keyword gives belongs; null where it names none.
  InpSet* set_of(InpSets& sets, const InpKeyword& keyword, std::string_view parameter) const {
    return keyword.has(parameter) ? &sets.named(required(keyword, parameter), lines_.at().place()) : nullptr;
  }

  void read_nodes(const InpKeyword& keyword) {
    const std::string system = lower_case(keyword.value("system"));
    if (system == "c" || system == "s")
      lines_.at().fail("Cartesian coordinates", "SYSTEM=" + system,
                       "have them written out by Abaqus/CAE or by cgx of CalculiX");
    InpSet* set = set_of(part().node_sets, keyword, "nset");
    while (lines_.next_data()) {
      const std::vector<std::string_view> fields = split(lines_.at().line(), ',');
      const std::int64_t node = number(fields[0], "a node number");
      Vector3 position = Vector3::Zero();
      const std::string what = "a coordinate of node " + std::to_string(node);
      if (fields.size() < 3)
        lines_.at().fail("two or three coordinates of node " + std::to_string(node),
                         std::to_string(fields.size() - 1));
      for (std::size_t i = 0; i < std::min<std::size_t>(3, fields.size() - 1); ++i)
        if (!fields[i + 1].empty()) position[static_cast<int>(i)] = lines_.at().real(fields[i + 1], what);
      part().node_numbers.push_back(node);
      part().positions.push_back(position);
      if (set != nullptr) set->entries.push_back({.first = node, .last = node});
    }
  }

  void read_elements(const InpKeyword& keyword) {
    std::string type = required(keyword, "type");
    std::transform(type.begin(), type.end(), type.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    InpSet* set = set_of(part().element_sets, keyword, "elset");
    const auto known = inp_type(type);
    if (!known) {
      part().has_other_elements = true;
      while (lines_.next_data()) ++model_.passed_over[type];
      return;
    }
    while (lines_.next_data()) {
      const std::int64_t element = read_element(*known, type);
      if (set != nullptr) set->entries.push_back({.first = element, .last = element});
    }
  }

  /// "number, node, node, ...", over several lines where the nodes are many.
  std::int64_t read_element(const InpType& type, const std::string& type_name) {
    std::vector<std::string_view> fields = split(lines_.at().line(), ',');
    const std::int64_t element = number(fields[0], "an element number");
    const std::size_t first = part().element_nodes.size();
    const std::string what = "a node number of element " + std::to_string(element);
    const auto num_found = [&] { return part().element_nodes.size() - first; };
    fields.erase(fields.begin());
    while (true) {
      for (const std::string_view field : fields)
        if (!field.empty()) part().element_nodes.push_back(number(field, what));
      if (num_found() >= type.num_nodes || !lines_.next_data()) break;
      fields = split(lines_.at().line(), ',');
    }
    if (num_found() != type.num_nodes)
      lines_.at().fail(std::to_string(type.num_nodes) + " nodes of element " + std::to_string(element) +
                           " of type " + printable(type_name),
                       std::to_string(num_found()), "the type is wrong or the file is cut");
    part().elements.push_back({element, type.kind, first, type.num_nodes});
    return element;
  }

  void read_set(InpSets& sets, const InpKeyword& keyword, std::string_view parameter) {
    InpSet& set = sets.named(required(keyword, parameter), lines_.at().place());
    set.is_internal = keyword.has("internal");
    const std::string instance = lower_case(keyword.value("instance"));
    if (parameter == "nset" && keyword.has("elset"))
      set.entries.push_back(
          {.set = lower_case(keyword.value("elset")), .instance = instance, .names_elements = true});
    while (lines_.next_data()) {
      const std::vector<std::string_view> fields = split(lines_.at().line(), ',');
      if (keyword.has("generate")) {
        set.entries.push_back(range(fields, instance));
        continue;
      }
      for (const std::string_view field : fields)
        if (!field.empty()) set.entries.push_back(entry(field, instance));
    }
  }

  InpEntry range(const std::vector<std::string_view>& fields, const std::string& instance) const {
    if (fields.size() < 2) lines_.at().fail("\"first, last, step\"", trimmed(lines_.at().line()));
    InpEntry result{.first = number(fields[0], "a first number"),
                    .last = number(fields[1], "a last number"),
                    .instance = instance};
    if (fields.size() > 2 && !fields[2].empty()) result.step = number(fields[2], "a step");
    return result;
  }

  /// "5", "INSTANCE.5", "SET" or "INSTANCE.SET".
  InpEntry entry(std::string_view field, const std::string& instance) const {
    InpEntry result{.instance = instance};
    std::int64_t value = 0;
    if (!parse_integer(field, value)) {
      const std::string text = lower_case(unquoted(field));
      const std::size_t point = text.find('.');
      const bool has_instance = point != text.npos && instance.empty() && is_instance(text.substr(0, point));
      if (has_instance) result.instance = text.substr(0, point);
      const std::string name = has_instance ? text.substr(point + 1) : text;
      if (!parse_integer(name, value)) {
        result.set = name;
        return result;
      }
    }
    if (value < 1 || value > max_file_number)
      lines_.at().fail("a number from 1 to " + std::to_string(max_file_number) + ", or the name of a set",
                       field);
    result.first = result.last = value;
    return result;
  }

  bool is_instance(const std::string& name) const {
    return std::ranges::any_of(model_.instances, [&](const InpInstance& known) {
      return !known.name.empty() && lower_case(known.name) == name;
    });
  }

  /// Lines "element or set of elements, side", of nodes "node or set of nodes".
  void read_surface(const InpKeyword& keyword) {
    InpSet& surface = part().surfaces.named(required(keyword, "name"), lines_.at().place());
    const std::string type = lower_case(keyword.value("type"));
    surface.has_nodes = type == "node";
    surface.is_internal = keyword.has("internal");
    if (!surface.has_nodes && !type.empty() && type != "element") return;  // analytical surfaces
    while (lines_.next_data()) {
      const std::vector<std::string_view> fields = split(lines_.at().line(), ',');
      if (fields[0].empty()) continue;
      InpEntry found = entry(fields[0], "");
      const std::string side = fields.size() > 1 ? lower_case(fields[1]) : "";
      const bool is_counted =
          side.size() == 2 && (side[0] == 's' || side[0] == 'e') && side[1] >= '1' && side[1] <= '6';
      if (is_counted && !surface.has_nodes) found.side = side[1] - '0';
      surface.entries.push_back(std::move(found));
    }
  }

  InpLines lines_;
  InpModel model_;
  Scope scope_ = Scope::model;
  std::size_t part_ = 0;
  bool has_keyword_ = false;
};

}  // namespace

MeshFile read_inp(const MeshSource& source) {
  const InpModel model = InpReader(source).read();
  MeshBuilder mesh(source.name, "Abaqus");
  build_inp_mesh(model, mesh);
  for (const auto& [type, count] : model.passed_over)
    mesh.warn(std::to_string(count) + " lines of elements " + printable(type) + " are skipped");
  return mesh.finish();
}

}  // namespace resilin
