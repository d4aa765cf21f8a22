#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// The files in a ZIP archive that is held in memory, stored or deflated. Neither encryption, nor ZIP64, nor
/// several volumes. Source: PKWARE, "APPNOTE.TXT", 4.3.
class ZipArchive {
 public:
  struct Entry {
    std::string name;
    std::uint32_t method, packed_size, size;
    std::size_t header;  ///< where its local header begins
  };

  /// @throws InputError when `bytes` are no archive
  ZipArchive(std::string file, std::string_view bytes);

  const std::vector<Entry>& entries() const { return entries_; }
  /// @throws InputError when the data are damaged or promise more than they can hold
  std::string content(const Entry& entry) const;

 private:
  std::uint32_t number(std::size_t at, std::size_t size) const;
  [[noreturn]] void fail(const std::string& expected, const std::string& got) const;

  std::string file_;
  std::string_view bytes_;
  std::vector<Entry> entries_;
};

}  // namespace resilin
