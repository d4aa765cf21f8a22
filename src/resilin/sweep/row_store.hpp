#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "resilin/sweep/scene_row.hpp"

namespace resilin {

/// The rows of a sweep in a folder that several processes share: each appends to a file of its own, so that a
/// process that is killed leaves at worst one line that is not whole, which counts for nothing.
///
/// Keeps in memory where each row stands (40 bytes), not the rows.
class RowStore {
 public:
  /// @param folder  is there; others may be writing into it
  explicit RowStore(std::filesystem::path folder);
  ~RowStore();
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  /// Looks at what others have added.
  void refresh();

  struct Found {
    SceneStatus status;
    bool is_old;  ///< was there when the store was opened
  };
  std::optional<Found> find(const SceneHash& hash) const;

  /// The whole line of a row that has been found.
  std::string line(const SceneHash& hash) const;

  /// Adds a line. @throws FileError when it cannot be written; the file is then as it was before
  void append(const std::string& line);

 private:
  struct Entry {
    SceneHash hash;
    std::uint64_t offset;
    std::uint32_t file;
    SceneStatus status;
    bool is_old;
  };
  struct HashOfHash {
    std::size_t operator()(const SceneHash& hash) const { return hash.high; }
  };

  void read_file_from(std::uint32_t file);
  void put(const Entry& entry);
  const Entry* find_entry(const SceneHash& hash) const;
  void open_own_file();

  std::filesystem::path folder_;
  struct File {
    std::string name;
    std::uint64_t consumed = 0;  ///< bytes of whole lines
  };
  std::vector<File> files_;
  std::unordered_map<std::string, std::uint32_t> file_numbers_;
  std::vector<Entry> sorted_;  ///< most of them, by hash
  std::unordered_map<SceneHash, Entry, HashOfHash> recent_;
  bool is_opening_ = true;
  mutable std::ifstream reader_;  ///< reader of the file that a line was read from last
  mutable std::uint32_t reader_file_ = 0;
  int own_ = -1;  ///< descriptor of the file that this process appends to
  std::uint32_t own_number_ = 0;
};

}  // namespace resilin
