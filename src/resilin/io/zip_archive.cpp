#include "resilin/io/zip_archive.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <zlib.h>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/io/binary_value.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

constexpr std::string_view end_mark = "PK\5\6", directory_mark = "PK\1\2", local_mark = "PK\3\4";
constexpr std::size_t end_size = 22, directory_size = 46, local_size = 30;
constexpr std::uint64_t most_inflation = 1100;  // deflate makes at most about 1032 bytes of one

/// Undoes a deflate stream without a header; false when it does not become `size` bytes.
bool inflate_raw(std::string_view packed, std::string& result) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return false;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int status = inflate(&stream, Z_FINISH);
  const bool is_whole = status == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return is_whole;
}

}  // namespace

ZipArchive::ZipArchive(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {
  const std::size_t end = bytes_.rfind(end_mark);
  if (end == bytes_.npos || bytes_.size() - end < end_size)
    fail("the directory of a ZIP archive at the end", "none");
  const std::uint32_t count = number(end + 10, 2);
  std::size_t at = number(end + 16, 4);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (at > bytes_.size() || bytes_.size() - at < directory_size || bytes_.substr(at, 4) != directory_mark)
      fail("entry " + std::to_string(i) + " of the directory of a ZIP archive", "other bytes");
    const std::size_t name_size = number(at + 28, 2), extra = number(at + 30, 2),
                      comment = number(at + 32, 2);
    if ((number(at + 8, 2) & 1U) != 0) fail("an archive without a password", "one with a password");
    if (bytes_.size() - at - directory_size < name_size)
      fail("a name in the directory", "the end of the file");
    entries_.push_back({std::string(bytes_.substr(at + directory_size, name_size)), number(at + 10, 2),
                        number(at + 20, 4), number(at + 24, 4), number(at + 42, 4)});
    at += directory_size + name_size + extra + comment;
  }
}

std::uint32_t ZipArchive::number(std::size_t at, std::size_t size) const {
  return static_cast<std::uint32_t>(
      decoded(bytes_.substr(at, size), {size, false, false}, std::endian::little));
}

std::string ZipArchive::content(const Entry& entry) const {
  const std::string what = "the data of " + printable(entry.name);
  if (entry.header > bytes_.size() || bytes_.size() - entry.header < local_size ||
      bytes_.substr(entry.header, 4) != local_mark)
    fail(what, "other bytes");
  const std::size_t begin =
      entry.header + local_size + number(entry.header + 26, 2) + number(entry.header + 28, 2);
  if (begin > bytes_.size() || bytes_.size() - begin < entry.packed_size) fail(what, "the end of the file");
  const std::string_view packed = bytes_.substr(begin, entry.packed_size);
  constexpr std::uint32_t stored = 0, deflated = 8;
  if (entry.method == stored && entry.packed_size == entry.size) return std::string(packed);
  if (entry.method != deflated) fail(what + ", stored or deflated", "method " + std::to_string(entry.method));
  if (entry.size / most_inflation > packed.size() + 1) fail(what, "a promise of more than deflate can hold");
  if (!fits(entry.size))
    foresee_memory(entry.size, "unpacking " + file_, "take a coarser mesh, or raise the limit");
  std::string result(entry.size, '\0');
  if (!inflate_raw(packed, result)) fail(what, "damaged ones");
  return result;
}

void ZipArchive::fail(const std::string& expected, const std::string& got) const {
  throw InputError(file_, expected, got, "the file may be cut, or it is of another kind");
}

}  // namespace resilin
