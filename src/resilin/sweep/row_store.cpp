#include "resilin/sweep/row_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/output_file.hpp"

namespace resilin {
namespace {

constexpr std::string_view ending = ".jsonl";
constexpr std::size_t chunk = std::size_t{1} << 20;

/// A row that is done stands against any other; else the newer one does.
bool stands(SceneStatus old_one, SceneStatus new_one) {
  return old_one == SceneStatus::done && new_one != SceneStatus::done;
}

}  // namespace

RowStore::RowStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw FileError(folder_.string(), "the folder cannot be made (" + error.message() + ")");
  refresh();
  is_opening_ = false;
}

RowStore::~RowStore() {
  if (own_ >= 0) ::close(own_);
}

void RowStore::refresh() {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder_, error), end;
  std::vector<std::string> names;
  for (; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (name.ends_with(ending)) names.push_back(std::move(name));
  }
  if (error) throw FileError(folder_.string(), "cannot be read: " + error.message());
  std::ranges::sort(names);  // the same order everywhere
  for (const std::string& name : names) {
    const auto [known, is_new] = file_numbers_.try_emplace(name, static_cast<std::uint32_t>(files_.size()));
    if (is_new) files_.push_back({name, 0});
    if (own_ < 0 || known->second != own_number_) read_file_from(known->second);
  }
}

void RowStore::read_file_from(std::uint32_t number) {
  File& file = files_[number];
  struct stat status = {};
  const std::filesystem::path path = folder_ / file.name;
  if (::stat(path.c_str(), &status) != 0 || static_cast<std::uint64_t>(status.st_size) <= file.consumed)
    return;
  std::ifstream stream(path, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(file.consumed));
  std::string rest;
  while (stream) {
    const std::size_t before = rest.size();
    rest.resize(before + chunk);
    stream.read(rest.data() + before, static_cast<std::streamsize>(chunk));
    rest.resize(before + static_cast<std::size_t>(stream.gcount()));
    std::size_t begin = 0;
    for (std::size_t end; (end = rest.find('\n', begin)) != std::string::npos; begin = end + 1) {
      Entry entry{.hash = {},
                  .offset = file.consumed + begin,
                  .file = number,
                  .status = SceneStatus::failed,
                  .is_old = is_opening_};
      if (read_row_head(std::string_view(rest).substr(begin, end - begin), entry.hash, entry.status))
        put(entry);
    }
    file.consumed += begin;
    rest.erase(0, begin);
  }
}

const RowStore::Entry* RowStore::find_entry(const SceneHash& hash) const {
  if (const auto recent = recent_.find(hash); recent != recent_.end()) return &recent->second;
  const auto found = std::ranges::lower_bound(sorted_, hash, {}, &Entry::hash);
  return found != sorted_.end() && found->hash == hash ? &*found : nullptr;
}

void RowStore::put(const Entry& entry) {
  if (const Entry* known = find_entry(entry.hash); known != nullptr && stands(known->status, entry.status))
    return;
  recent_.insert_or_assign(entry.hash, entry);
  if (recent_.size() < 4096 + sorted_.size() / 4) return;
  // Those that are there twice are newer in `recent_`.
  std::erase_if(sorted_, [this](const Entry& old) { return recent_.contains(old.hash); });
  for (const auto& [hash, recent] : recent_) sorted_.push_back(recent);
  recent_.clear();
  std::ranges::sort(sorted_, {}, &Entry::hash);
}

std::optional<RowStore::Found> RowStore::find(const SceneHash& hash) const {
  const Entry* entry = find_entry(hash);
  if (entry == nullptr) return std::nullopt;
  return Found{entry->status, entry->is_old};
}

std::string RowStore::line(const SceneHash& hash) const {
  const Entry* entry = find_entry(hash);
  std::string line;
  if (entry == nullptr) return line;
  if (!reader_.is_open() || reader_file_ != entry->file) {
    reader_.close();
    reader_.open(folder_ / files_[entry->file].name, std::ios::binary);
    reader_file_ = entry->file;
  }
  reader_.clear();
  reader_.seekg(static_cast<std::streamoff>(entry->offset));
  std::getline(reader_, line);
  return line;
}

void RowStore::open_own_file() {
  for (int attempt = 0; own_ < 0; ++attempt) {
    const std::string name = std::to_string(::getpid()) + "-" + std::to_string(attempt) + std::string(ending);
    const std::filesystem::path path = folder_ / name;
    own_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (own_ < 0 && errno != EEXIST)
      throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(errno));
    if (own_ < 0) continue;
    own_number_ = static_cast<std::uint32_t>(files_.size());
    files_.push_back({name, 0});
    file_numbers_.emplace(name, own_number_);
  }
}

void RowStore::append(const std::string& line) {
  if (own_ < 0) open_own_file();
  File& file = files_[own_number_];
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = ::write(own_, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int reason = count == 0 ? ENOSPC : errno;
      // The part that came through is taken back, so that the next line does not go on from it.
      if (written > 0 && ::ftruncate(own_, static_cast<off_t>(file.consumed)) != 0) {
        ::close(own_);
        own_ = -1;
      }
      throw FileError((folder_ / file.name).string(), "cannot be written: " + reason_of_failed_write(reason));
    }
    written += static_cast<std::size_t>(count);
  }
  Entry entry{.hash = {},
              .offset = file.consumed,
              .file = own_number_,
              .status = SceneStatus::failed,
              .is_old = false};
  if (read_row_head(std::string_view(line).substr(0, line.size() - 1), entry.hash, entry.status)) put(entry);
  file.consumed += line.size();
}

}  // namespace resilin
