#include "resilin/sweep/scene_hash.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <span>
#include <system_error>
#include <vector>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/hash.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/core/quoted_text.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/mesh_members.hpp"
#include "resilin/scene/csv.hpp"

namespace resilin {
namespace {

constexpr std::uint64_t second_seed = 0x8f1bbcdcbfa53e0bULL;

std::string_view bytes_of(std::span<const double> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

std::uint64_t hash_of_numbers(const NumberTable& table) {
  return hash_of(bytes_of(table.values), hash_of(std::to_string(table.num_columns)));
}

/// The second file of a format that has two.
std::filesystem::path file_beside(const std::filesystem::path& path) {
  std::filesystem::path other = path;
  if (path.extension() == ".ele") return other.replace_extension(".node");
  if (path.extension() == ".node") return other.replace_extension(".ele");
  return {};
}

/// Members by key, since their order means nothing.
std::vector<const SceneMember*> sorted_members(const SceneValue::Table& table) {
  std::vector<const SceneMember*> members;
  members.reserve(table.size());
  for (const SceneMember& member : table) members.push_back(&member);
  std::ranges::sort(members, {}, [](const SceneMember* member) -> const std::string& { return member->key; });
  return members;
}

/// With its length before it, so that no text can pass for another.
void append_text(const std::string& text, std::string& out) {
  out += 's';
  out += std::to_string(text.size());
  out += ':';
  out += text;
}

void append_canonical(const SceneValue& value, FileHashes& files, std::string& out) {
  std::visit(Overloaded{[&](bool flag) { out += flag ? 't' : 'f'; },
                        [&](std::int64_t number) { out.append("i").append(std::to_string(number)); },
                        [&](double number) { out.append("d").append(format_number(number)); },
                        [&](const std::string& text) {
                          append_text(text, out);
                          if (const auto hash = files.of_file(text)) out.append("#").append(hash_text(*hash));
                        },
                        [&](const SceneValue::Array& array) {
                          out += '[';
                          for (const SceneValue& entry : array) {
                            append_canonical(entry, files, out);
                            out += ',';
                          }
                          out += ']';
                        },
                        [&](const SceneValue::Table& table) {
                          out += '{';
                          for (const SceneMember* member : sorted_members(table)) {
                            append_text(member->key, out);
                            out += '=';
                            append_canonical(member->value, files, out);
                            out += ',';
                          }
                          out += '}';
                        },
                        [&](const SceneValue::Numbers& numbers) {
                          out.append("n").append(hash_text(hash_of_numbers(*numbers)));
                        },
                        [&](const SceneValue::MeshHandle& mesh) {
                          out.append("m").append(hash_text(files.of_mesh(mesh)));
                        }},
             value.data);
}

}  // namespace

std::string hash_text(std::uint64_t hash) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash));
  return digits.data();
}

std::string SceneHash::text() const { return hash_text(high) + hash_text(low); }

std::optional<SceneHash> SceneHash::from_text(std::string_view text) {
  SceneHash hash;
  if (text.size() != 32) return std::nullopt;
  const auto read = [](std::string_view digits, std::uint64_t& number) {
    const char* end = digits.data() + digits.size();
    const auto parsed = std::from_chars(digits.data(), end, number, 16);
    return parsed.ec == std::errc{} && parsed.ptr == end;
  };
  if (!read(text.substr(0, 16), hash.high) || !read(text.substr(16), hash.low)) return std::nullopt;
  return hash;
}

SceneHash scene_hash_of(std::string_view bytes) {
  const std::uint64_t high = hash_of(bytes);
  return {high, hash_of(bytes, second_seed ^ high)};
}

std::optional<std::uint64_t> FileHashes::of_file(const std::string& name) {
  // Long texts, and those with zeros in them, are no names of files.
  if (folder_.empty() || name.empty() || name.size() > 1000 || name.find('\0') != std::string::npos)
    return {};
  const std::filesystem::path path = folder_ / name;
  std::error_code failure;
  if (std::filesystem::status(path, failure).type() != std::filesystem::file_type::regular) return {};
  Entry entry{std::filesystem::file_size(path, failure), std::filesystem::last_write_time(path, failure), 0};
  const std::filesystem::path other = file_beside(path);
  if (!other.empty() && std::filesystem::is_regular_file(other, failure)) {
    entry.size += std::filesystem::file_size(other, failure);
    entry.changed = std::max(entry.changed, std::filesystem::last_write_time(other, failure));
  }
  const std::lock_guard lock(mutex_);
  const auto known = files_.find(name);
  if (known != files_.end() && known->second.size == entry.size && known->second.changed == entry.changed)
    return known->second.hash;
  try {
    entry.hash = hash_of(read_file(path));
    if (!other.empty() && std::filesystem::is_regular_file(other, failure))
      entry.hash = hash_of(read_file(other), entry.hash);
  } catch (const FileError&) {  // the scene will say so; by these it is known again until the file is mended
    const std::array<std::int64_t, 2> stamp = {static_cast<std::int64_t>(entry.size),
                                               entry.changed.time_since_epoch().count()};
    entry.hash = hash_of({reinterpret_cast<const char*>(stamp.data()), sizeof(stamp)});
  }
  if (files_.size() >= most_entries) files_.clear();
  files_.insert_or_assign(name, entry);
  return entry.hash;
}

std::uint64_t FileHashes::of_mesh(const SceneValue::MeshHandle& mesh) {
  const std::lock_guard lock(mutex_);
  if (const auto known = meshes_.find(mesh); known != meshes_.end()) return known->second;
  ArchiveWriter writer;
  writer(mesh->mesh);
  return meshes_.emplace(mesh, hash_of(writer.take())).first->second;
}

std::string canonical_text(const SceneValue& value, FileHashes& files) {
  std::string text;
  append_canonical(value, files, text);
  return text;
}

std::string shown_value(const SceneValue& value, FileHashes& files) {
  return std::visit(
      Overloaded{[](bool flag) -> std::string { return flag ? "true" : "false"; },
                 [](std::int64_t number) { return std::to_string(number); },
                 [](double number) {
                   const std::string text = format_number(number);
                   return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
                 },
                 [&](const std::string& text) {
                   const auto hash = files.of_file(text);
                   return quoted_text(one_line(text)) + (hash ? " (hash " + hash_text(*hash) + ")" : "");
                 },
                 [&](const SceneValue::Array& array) {
                   std::string text = "[";
                   for (const SceneValue& entry : array)
                     text += (text.size() > 1 ? ", " : "") + shown_value(entry, files);
                   return text + "]";
                 },
                 [&](const SceneValue::Table& table) {
                   std::string text = "{";
                   for (const SceneMember* member : sorted_members(table))
                     text += (text.size() > 1 ? ", " : " ") + member->key + " = " +
                             shown_value(member->value, files);
                   return text + " }";
                 },
                 [](const SceneValue::Numbers& numbers) {
                   return std::to_string(numbers->values.size()) + " numbers (hash " +
                          hash_text(hash_of_numbers(*numbers)) + ")";
                 },
                 [&](const SceneValue::MeshHandle& mesh) {
                   return "mesh (hash " + hash_text(files.of_mesh(mesh)) + ")";
                 }},
      value.data);
}

}  // namespace resilin
