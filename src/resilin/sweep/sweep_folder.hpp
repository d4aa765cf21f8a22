#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "resilin/sweep/claims.hpp"
#include "resilin/sweep/row_store.hpp"
#include "resilin/sweep/sweep.hpp"

namespace resilin {

/// One part of a sweep: scenes number - 1, number - 1 + count, ...
struct Shard {
  std::uint64_t number = 1, count = 1;
  std::uint64_t num_scenes(std::uint64_t of) const { return number > of ? 0 : (of - number) / count + 1; }
};
/// The shard of "2/8". @throws InputError
Shard parse_shard(const std::string& text);

/// Progress of a sweep, or of a shard of it.
struct SweepCount {
  std::uint64_t scenes = 0, done = 0, failed = 0;
  std::uint64_t left() const { return scenes - done - failed; }
};

/// The folder of a sweep, which any number of processes on any number of machines work in at once:
///
///   sweep.json         which sweep it is
///   rows/*.jsonl       a line for each scene that has been run, a file for each process
///   kept/HASH/         results of chosen scenes, as `resilin run` leaves them
///   results.csv        the table
///   claims.lock        which scenes are being run
class SweepFolder {
 public:
  /// Makes or opens it. @throws InputError when it is of another sweep or version, unless `update` says that
  /// the sweep has been changed: what has become of scenes that are the same is then kept
  /// @param is_looked_at  a folder that is there; nothing is written into it
  SweepFolder(std::filesystem::path folder, const Sweep& sweep, bool update = false,
              bool is_looked_at = false);

  const std::filesystem::path& path() const { return path_; }
  const Sweep& sweep() const { return sweep_; }

  /// Status of a scene; nothing before it has run.
  std::optional<RowStore::Found> find(std::uint64_t scene, const SceneHash& hash) const;
  std::string line(const SceneHash& hash) const;
  SweepCount count(const Shard& shard) const;

  /// Claims a scene that nobody has run or is running; `retries` also one that had failed when the folder was
  /// opened.
  enum class Claim {
    taken,
    finished,
    own,    ///< this process is running it, or one with the same values
    others  ///< another process is running it
  };
  Claim claim(std::uint64_t scene, const SceneHash& hash, bool retries);
  void release(const SceneHash& hash);
  void append(const SceneHash& hash, const std::string& line);  ///< a row; releases the claim

  /// Writes results.csv with all rows that are there, in the order of the scenes; false when the folder's
  /// sweep has been changed by another process, whose table it is then.
  bool write_table();

  void refresh();  ///< looks at what others have added

 private:
  void open(bool update, bool is_looked_at);

  std::filesystem::path path_;
  const Sweep& sweep_;
  mutable std::mutex mutex_;
  std::unique_ptr<Claims> claims_;
  std::unique_ptr<RowStore> rows_;
  std::set<SceneHash> own_claims_;
};

/// Folder of the kept results of a scene.
std::filesystem::path kept_path(const std::filesystem::path& folder, const SceneHash& hash);

/// Name of the table in the folder of a sweep.
inline constexpr const char* table_name = "results.csv";

}  // namespace resilin
