#include <array>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/msh_input.hpp"

// The MSH formats 1, 2.0 to 2.2, 4.0 and 4.1, ASCII and, from 2.0 on, binary. Source: Gmsh reference manual,
// "MSH file format" and "Legacy formats".

namespace resilin {
namespace {

/// "4.1 0 8", and in binary an int 1 that tells the byte order.
void read_format(MshInput& in) {
  if (in.text.peek() == "$NOD") {
    in.version = 1;
    return;
  }
  if (in.text.peek() != "$MeshFormat") {
    in.text.fail("\"$MeshFormat\" at the start of an MSH file",
                 in.text.at_end() ? "the end of the file" : in.text.peek());
  }
  in.text.word("");
  in.text.set_section("$MeshFormat");
  const std::string_view version = in.text.word("a version");
  const bool is_known = version == "4.1" || version == "4" || version == "4.0" || version == "2" ||
                        version == "2.0" || version == "2.1" || version == "2.2";
  if (!is_known) {
    in.text.fail("MSH version 2.2, 4.0 or 4.1", "version " + std::string(version), "save it as version 4.1");
  }
  parse_real(version, in.version);
  const std::int64_t file_type = in.text.integer("the file type (0: ASCII, 1: binary)");
  if (file_type != 0 && file_type != 1)
    in.text.fail("the file type 0 (ASCII) or 1 (binary)", std::to_string(file_type));
  const std::int64_t data_size = in.text.integer("the data size");
  in.is_binary = file_type == 1;
  if (data_size != 8) in.text.fail("the data size 8", std::to_string(data_size));
  if (in.is_binary) {
    in.text.skip_line_end();
    const std::int64_t one = in.integer("the byte order mark");
    in.swaps_bytes = one == 0x01000000;
    if (one != 1 && !in.swaps_bytes) in.text.fail("the int 1 as byte order mark", std::to_string(one));
  }
}

std::string version_name(double version) {
  if (version == 1) return "1";
  return version == 4 || version == 2 ? format_number(version) + ".0" : format_number(version);
}

/// Lines 'dimension tag "name"'.
void read_physical_names(MshReading& file) {
  TextScanner& text = file.in.text;
  const std::size_t count = text.count("physical names", 6);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t dim = text.integer("the dimension of a physical group");
    if (dim < 0 || dim > 3) text.fail("the dimension of a physical group (0 to 3)", std::to_string(dim));
    const std::int64_t tag = text.integer("the tag of a physical group");
    const std::string_view quoted = text.rest_of_line();
    if (quoted.size() < 3 || quoted.front() != '"' || quoted.back() != '"') {
      text.fail("the name of physical group " + std::to_string(tag) + " in quotation marks", quoted);
    }
    const std::string name(quoted.substr(1, quoted.size() - 2));
    file.names[{static_cast<int>(dim), tag}] = name;
    file.mesh.group(name);
  }
}

/// A scalar per element becomes a cell field; vectors and tensors are passed over.
void read_element_data(MshReading& file) {
  TextScanner& text = file.in.text;
  std::string name = "field";
  const std::size_t num_strings = text.count("string tags", 2);
  text.rest_of_line();
  for (std::size_t i = 0; i < num_strings; ++i) {
    const std::string_view line = text.rest_of_line();
    const bool is_quoted = line.size() >= 2 && line.front() == '"' && line.back() == '"';
    if (i == 0) name = is_quoted ? line.substr(1, line.size() - 2) : line;
  }
  const std::size_t num_reals = text.count("real tags", 2);
  for (std::size_t i = 0; i < num_reals; ++i) text.real("a real tag");
  const std::size_t num_integers = text.count("integer tags", 2);
  std::array<std::int64_t, 3> tags{};  // time step, components, number of elements
  for (std::size_t i = 0; i < num_integers; ++i) {
    const std::int64_t tag = text.integer("an integer tag");
    if (i < tags.size()) tags[i] = tag;
  }
  text.skip_line_end();
  const std::size_t num_components = text.checked_count(tags[1], "components", 2);
  const std::size_t count = text.checked_count(tags[2], "values", file.in.is_binary ? 12 : 4);
  if (num_components != 1) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t element = file.in.integer("an element tag");
    const double value = file.in.real("the value of element " + std::to_string(element));
    MeshBuilder::Cell cell{};
    if (!file.mesh.find_cell(element, cell)) {
      throw InputError(file.mesh.cell_place(element),
                       "an element of $Elements in field \"" + printable(name) + "\"",
                       std::to_string(element));
    }
    file.mesh.set_cell_value(name, cell, value);
  }
}

/// Reads one section. @return false when it is passed over
bool read_section(MshReading& file, std::string_view section) {
  const bool is_version_4 = file.in.version >= 4;
  if (section == "$PhysicalNames") {
    read_physical_names(file);
  } else if (section == "$Entities" && is_version_4) {
    read_msh4_entities(file);
  } else if (section == "$NOD" && file.in.version == 1) {
    read_msh2_nodes(file);
  } else if (section == "$ELM" && file.in.version == 1) {
    read_msh1_elements(file);
  } else if (section == "$ParametricNodes" && !is_version_4) {
    read_msh2_parametric_nodes(file);
  } else if (section == "$Nodes") {
    is_version_4 ? read_msh4_nodes(file) : read_msh2_nodes(file);
  } else if (section == "$Elements") {
    is_version_4 ? read_msh4_elements(file) : read_msh2_elements(file);
  } else if (section == "$ElementData") {
    read_element_data(file);
  } else {
    return false;
  }
  return true;
}

std::string end_of(const std::string& section) {
  const bool is_version_1 = section == "$NOD" || section == "$ELM";
  return (is_version_1 ? "$END" : "$End") + section.substr(1);
}

void finish_section(TextScanner& text, const std::string& section) {
  const std::string end = end_of(section);
  if (text.peek() == end) {
    text.word(end);
  } else if (section != "$ElementData" || !text.skip_past(end)) {  // reads on after data that we pass over
    text.fail("\"" + end + "\"", text.at_end() ? "the end of the file" : text.peek());
  }
}

}  // namespace

MeshFile read_msh(const MeshSource& source) {
  MshInput in(source.name, source.bytes);
  read_format(in);
  MshReading file{in, MeshBuilder(source.name, "MSH " + version_name(in.version))};
  TextScanner& text = file.in.text;
  if (in.version > 1) finish_section(text, "$MeshFormat");
  bool has_nodes = false;
  bool has_elements = false;
  while (!text.at_end()) {
    const std::string section(text.word("a section"));
    if (section.size() < 2 || section[0] != '$' || section.starts_with("$End")) {
      text.fail("a section such as $Nodes", section);
    }
    text.set_section(section);
    text.skip_line_end();
    const bool is_of_nodes = section == "$Nodes" || section == "$ParametricNodes" || section == "$NOD";
    const bool is_of_elements = section == "$Elements" || section == "$ELM";
    const bool is_repeated = (is_of_nodes && has_nodes) || (is_of_elements && has_elements);
    if (is_repeated) text.fail("one section " + section, "a second one");
    has_nodes |= is_of_nodes;
    has_elements |= is_of_elements;
    if (read_section(file, section)) {
      finish_section(text, section);
    } else if (!text.skip_past(end_of(section))) {
      file.mesh.warn("section " + printable(section) + " has no end; the file may be cut");
    }
    text.set_section("");
  }
  if (!has_nodes) throw InputError(source.name, "no $Nodes");
  return file.mesh.finish();
}

}  // namespace resilin
