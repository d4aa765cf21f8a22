#include "resilin/scene/material_library.hpp"

#include <algorithm>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr std::string_view library_lines =
#include "resilin/scene/material_library.inc"
    ;

std::string trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == text.npos ? "" : std::string(text.substr(begin, text.find_last_not_of(' ') - begin + 1));
}

std::vector<std::string> parts_of_line(std::string_view line, char between) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(between, begin), line.size());
    parts.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

/// "name = value" by name.
std::map<std::string, std::string> entries_of(const std::string& text) {
  std::map<std::string, std::string> entries;
  if (text.empty()) return entries;
  for (const std::string& entry : parts_of_line(text, ',')) {
    const std::vector<std::string> sides = parts_of_line(entry, '=');
    entries[sides.at(0)] = sides.at(1);
  }
  return entries;
}

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& number : parts_of_line(text, ' ')) numbers.push_back(std::stod(number));
  return numbers;
}

LibraryMaterial material_of_line(std::string_view line) {
  const std::vector<std::string> parts = parts_of_line(line, '|');
  if (parts.size() != 9) throw std::logic_error("material_library.inc: " + std::string(line));
  LibraryMaterial material{.name = parts[0],
                           .law = parts[1],
                           .constants = {},
                           .g = {},
                           .tau = {},
                           .range = parts[6],
                           .about = parts[7],
                           .source = parts[8]};
  for (const auto& [name, value] : entries_of(parts[2])) material.constants[name] = std::stod(value);
  material.density = std::stod(parts[3]);
  material.youngs_modulus = std::stod(parts[4]);
  const std::map<std::string, std::string> prony = entries_of(parts[5]);
  if (prony.empty()) return material;
  material.g = numbers_of(prony.at("g"));
  material.tau = numbers_of(prony.at("tau"));
  return material;
}

}  // namespace

const std::vector<LibraryMaterial>& material_library() {
  static const std::vector<LibraryMaterial> all = [] {
    std::vector<LibraryMaterial> materials;
    for (const std::string& line : parts_of_line(library_lines, '\n'))
      if (!line.empty() && line[0] != '#') materials.push_back(material_of_line(line));
    return materials;
  }();
  return all;
}

const LibraryMaterial& find_library_material(const std::string& name, const std::string& place) {
  std::vector<std::string> names;
  for (const LibraryMaterial& material : material_library()) {
    if (material.name == name) return material;
    names.push_back(material.name);
  }
  refuse_word(place, name, names);
}

void take_from_library(const LibraryMaterial& from, MaterialDescription& material) {
  material.law = from.law;
  material.constants = from.constants;
  material.density = from.density;
  material.viscoelastic.reset();
  if (from.g.empty()) return;
  ViscoelasticDescription& viscoelastic = material.viscoelastic.emplace();
  viscoelastic.g = from.g;
  viscoelastic.tau = from.tau;
}

}  // namespace resilin
