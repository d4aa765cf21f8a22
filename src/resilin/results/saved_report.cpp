#include "resilin/results/saved_report.hpp"

#include <cmath>
#include <exception>
#include <fstream>

#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"

namespace resilin {
namespace {

constexpr int deepest_nesting = 64;  ///< deepest nesting of a report: 6

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& got) {
  throw InputError(path.string(), "the report of a run", got, "run the scene again, without --resume");
}

Json parse(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const auto is_kept = [&path](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest_nesting) refuse(path, "values nested more than 64 deep");
    return true;
  };
  Json report = Json::parse(text, is_kept, /*allow_exceptions=*/false);
  if (report.is_discarded()) refuse(path, "text that is not JSON");
  return report;
}

std::string quoted(std::string_view text) { return '"' + std::string(text) + '"'; }

bool has_number(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() && std::isfinite(found->get<double>());
}

}  // namespace

SavedReport read_report(const std::filesystem::path& path) {
  Json report = parse(path);
  if (!report.is_object() || !report.contains("frames") || !report["frames"].is_array())
    refuse(path, "something without a list of frames");
  SavedReport saved;
  saved.frames = std::move(report["frames"]);
  double last_step = -1;
  for (std::size_t i = 0; i < saved.frames.size(); ++i) {
    const Json& frame = saved.frames[i];
    const auto refuse_frame = [&](const std::string& what) {
      refuse(path, "frames[" + std::to_string(i) + "] " + what);
    };
    if (!frame.is_object()) refuse_frame("that is no frame");
    for (const char* key : {"step", "time", "load"})
      if (!has_number(frame, key)) refuse_frame("without a number \"" + std::string(key) + "\"");
    const double step = frame["step"].get<double>();
    if (!frame["step"].is_number_integer() || !(step > last_step) || step > 1e9)
      refuse_frame("whose \"step\" is not a whole number above the one before");
    if (frame.contains("mode") && !frame["mode"].is_object()) refuse_frame("whose \"mode\" is no table");
    last_step = step;
  }
  const auto timing = report.find("timing");
  if (timing != report.end() && timing->is_object() && has_number(*timing, "total"))
    saved.total_seconds = (*timing)["total"].get<double>();
  return saved;
}

void mark_as_failed(const std::filesystem::path& path) noexcept {
  try {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    std::string start(1000, '\0');
    file.read(start.data(), static_cast<std::streamsize>(start.size()));
    file.clear();
    const auto overwrite = [&](const std::string& before, std::string after) {
      const std::size_t at = start.find(before);
      if (at == start.npos || after.size() > before.size()) return;
      after.resize(before.size(), ' ');
      file.seekp(static_cast<std::streamoff>(at));
      file << after;
    };
    if (start.find(quoted(name(RunStatus::running))) == start.npos) return;
    overwrite(quoted(name(RunStatus::running)), quoted(name(RunStatus::failed)));
    overwrite(quoted(running_reason), quoted("an error ended the run, which printed it"));
  } catch (const std::exception&) {
    return;  // the error itself is told by who found it
  }
}

}  // namespace resilin
