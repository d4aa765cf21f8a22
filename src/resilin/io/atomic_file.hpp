#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace resilin {

/// Writes a file so that at every moment the path holds either its old content or all of the new.
///
/// `write` fills a file beside `path`, which is flushed to the disk and renamed; when it throws, or the disk
/// is full, the old file stays as it was and nothing is left behind; what a process that was killed has left
/// is removed by the next that writes the file. A symbolic link is followed; a device (such as /dev/stdout)
/// is written directly. The stream is binary and independent of the locale.
///
/// @throws FileError naming the path
void write_atomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// The same of a text that is there.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Writes a file that is not there yet. False where there is one, whoever makes it meanwhile: it is left
/// alone.
/// @throws FileError naming the path; nothing is then left behind
bool write_new_file(const std::filesystem::path& path, std::string_view bytes);

/// The ending of the name of a file that is not whole yet; numbers may follow.
inline constexpr std::string_view partial_ending = ".partial";

/// Removes what has been left half-written in a folder, by whomever: for a folder that nobody else writes
/// into.
void remove_partial_files(const std::filesystem::path& folder);

/// The bytes of a regular file of at most 4 GiB. @throws FileError naming the path
std::string read_file(const std::filesystem::path& path);

}  // namespace resilin
