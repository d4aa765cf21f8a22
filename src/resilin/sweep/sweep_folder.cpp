#include "resilin/sweep/sweep_folder.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <ostream>
#include <system_error>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/sweep/table.hpp"

namespace resilin {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* manifest_name = "sweep.json";

Json manifest_json(const Sweep& sweep) {
  Json columns = Json::array();
  for (const SweepParameter& parameter : sweep.parameters())
    columns.push_back({{"name", parameter.name}, {"kind", "parameter"}, {"keys", parameter.keys}});
  for (const Quantity& quantity : sweep.quantities())
    columns.push_back({{"name", quantity.name},
                       {"kind", "quantity"},
                       {"of", quantity.of},
                       {"over", spelling(quantity.over)}});
  Json identity = Json::array();
  for (const auto& [name, text] : sweep.identity()) identity.push_back({name, text});
  return {{"format", "resilin sweep 1"},
          {"version", version()},
          {"scenes", sweep.size()},
          {"columns", columns},
          {"identity", identity}};
}

Fingerprint read_identity(const std::string& text, const std::string& place) {
  const Json manifest = Json::parse(text, nullptr, false);
  Fingerprint identity;
  try {
    for (const Json& entry : manifest.at("identity"))
      identity.emplace_back(entry.at(0).get<std::string>(), entry.at(1).get<std::string>());
  } catch (const Json::exception&) {
    throw InputError(place, "what a sweep has written", "something else",
                     "choose another folder (--out), or remove the file to start anew");
  }
  return identity;
}

/// Throws with the first thing in which the folder's sweep is another one.
void refuse_other(const Fingerprint& folder, const Fingerprint& now, const std::string& place) {
  const std::optional<FingerprintDifference> difference = first_difference(folder, now);
  if (!difference) return;
  if (difference->name == "version")
    throw InputError(place, "a folder of this version of the program, " + difference->now,
                     "one of " + difference->before,
                     "choose another folder (--out), or run the same version everywhere");
  const auto words = [](const std::string& text) { return text.empty() ? "none" : one_line(text); };
  throw InputError(place, "a folder of this sweep",
                   "one of another: its " + one_line(difference->name) + " is " + words(difference->before) +
                       ", not " + words(difference->now),
                   "choose another folder (--out), or, if the sweep was changed, --update runs what is new");
}

}  // namespace

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  const bool has_slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto count = has_slash ? std::from_chars(number.ptr + 1, end, shard.count) : number;
  if (!has_slash || count.ec != std::errc{} || count.ptr != end || shard.number < 1 ||
      shard.number > shard.count)
    throw InputError("--shard", "i/n with i from 1 to n, such as 2/8", '"' + one_line(text) + '"');
  return shard;
}

SweepFolder::SweepFolder(std::filesystem::path folder, const Sweep& sweep, bool update, bool is_looked_at)
    : path_(std::move(folder)), sweep_(sweep) {
  if (std::filesystem::exists(path_ / report_name))
    throw InputError(path_.string(), "a folder of a sweep, or a new one", "the results of a run",
                     "choose another folder (--out)");
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error)
    throw FileError(path_.string(), "the folder for the results cannot be made (" + error.message() + ")");
  open(update, is_looked_at);
}

void SweepFolder::open(bool update, bool is_looked_at) {
  claims_ = std::make_unique<Claims>(path_ / "claims.lock");
  {
    const Claims::Whole whole(*claims_);  // two that start at once see one of them first
    const std::filesystem::path manifest = path_ / manifest_name;
    if (std::filesystem::exists(manifest) && !update)
      refuse_other(read_identity(read_file(manifest), manifest.string()), sweep_.identity(), path_.string());
    const std::string text = manifest_json(sweep_).dump(1) + "\n";
    if (!is_looked_at && (!std::filesystem::exists(manifest) || read_file(manifest) != text))
      write_atomically(manifest, [&text](std::ostream& stream) { stream << text; });
  }
  rows_ = std::make_unique<RowStore>(path_ / "rows");
}

std::filesystem::path kept_path(const std::filesystem::path& folder, const SceneHash& hash) {
  return folder / "kept" / hash.text();
}

std::optional<RowStore::Found> SweepFolder::find(std::uint64_t scene, const SceneHash& hash) const {
  const std::lock_guard lock(mutex_);
  const std::optional<RowStore::Found> found = rows_->find(hash);
  // One whose results are wanted now, and were not then, is run again.
  const bool is_missing = found && found->status == SceneStatus::done && sweep_.kept().has(scene, true) &&
                          !std::filesystem::exists(kept_path(path_, hash));
  return is_missing ? std::nullopt : found;
}

std::string SweepFolder::line(const SceneHash& hash) const {
  const std::lock_guard lock(mutex_);
  return rows_->line(hash);
}

SweepCount SweepFolder::count(const Shard& shard) const {
  SweepCount count{.scenes = shard.num_scenes(sweep_.size())};
  for (std::uint64_t i = shard.number - 1; i < sweep_.size(); i += shard.count) {
    const std::optional<RowStore::Found> found = find(i, sweep_.hash(i));
    if (found) ++(found->status == SceneStatus::done ? count.done : count.failed);
  }
  return count;
}

SweepFolder::Claim SweepFolder::claim(std::uint64_t scene, const SceneHash& hash, bool retries) {
  const auto is_finished = [&] {
    const std::optional<RowStore::Found> found = find(scene, hash);
    return found && !(retries && found->is_old && found->status != SceneStatus::done);
  };
  if (is_finished()) return Claim::finished;
  {
    const std::lock_guard lock(mutex_);
    if (own_claims_.contains(hash)) return Claim::own;
    if (!claims_->claim(hash)) return Claim::others;
    own_claims_.insert(hash);
    rows_->refresh();  // another may have ended it in between
  }
  if (!is_finished()) return Claim::taken;
  release(hash);
  return Claim::finished;
}

void SweepFolder::release(const SceneHash& hash) {
  const std::lock_guard lock(mutex_);
  if (own_claims_.erase(hash) > 0) claims_->release(hash);
}

void SweepFolder::append(const SceneHash& hash, const std::string& line) {
  {
    const std::lock_guard lock(mutex_);
    rows_->append(line);
  }
  release(hash);
}

void SweepFolder::refresh() {
  const std::lock_guard lock(mutex_);
  rows_->refresh();
}

bool SweepFolder::write_table() {
  const Claims::Whole whole(*claims_);  // one at a time, on whatever machine
  refresh();
  // The table of a sweep that has been changed in the meantime is its own.
  const std::filesystem::path manifest = path_ / manifest_name;
  if (first_difference(read_identity(read_file(manifest), manifest.string()), sweep_.identity()))
    return false;
  write_atomically(path_ / table_name, [this](std::ostream& stream) { write_csv(*this, stream); });
  return true;
}

}  // namespace resilin
