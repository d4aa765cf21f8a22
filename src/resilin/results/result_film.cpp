#include "resilin/results/result_film.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/results/moment.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/results/saved_run.hpp"

namespace resilin {
namespace {

constexpr std::size_t most_scouted = 40;  ///< frames looked at for the range and the framing
constexpr int swing_shots = 30;           ///< pictures of one period of a vibration
constexpr double degree = std::numbers::pi / 180;

void check(const FilmOptions& options) {
  if (options.every < 1) throw InputError("every", "a whole number from 1", std::to_string(options.every));
  if (options.frames_per_second && !(*options.frames_per_second > 0 && *options.frames_per_second <= 100))
    throw InputError("fps", "a number above 0 and up to 100", format_number(*options.frames_per_second));
  if (!(options.speed > 0) || !std::isfinite(options.speed))
    throw InputError("speed", "a number above 0", format_number(options.speed));
  if (!std::isfinite(options.turn)) throw InputError("turn", "a finite number", format_number(options.turn));
}

/// The report's frames; an empty list where there is no report.
Json frames_of_report(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / report_name;
  if (!std::filesystem::is_regular_file(file)) return Json::array();
  const Json report = Json::parse(read_file(file), nullptr, /*allow_exceptions=*/false);
  return report.is_object() && report.contains("frames") ? report["frames"] : Json::array();
}

std::vector<double> numbers_of(const Json& frames, const char* name) {
  std::vector<double> numbers;
  for (const Json& frame : frames) numbers.push_back(frame.value(name, 0.0));
  return numbers;
}

/// The frame of the asked mode, or of the first that is not rigid; none when the run shows no vibrations.
std::optional<int> frame_of_mode(const Json& frames, int asked) {
  int count = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!frames[i].contains("mode")) continue;
    ++count;
    const Json& mode = frames[i]["mode"];
    if (asked > 0 ? mode.value("number", 0) == asked : !mode.value("rigid", false))
      return static_cast<int>(i);
  }
  if (count == 0 && asked == 0) return std::nullopt;
  throw InputError("mode", count == 0 ? "a modal analysis" : "a mode from 1 to " + std::to_string(count),
                   std::to_string(asked));
}

/// Pictures a second at which time passes as it does, times `speed`; none where no time passes.
std::optional<double> rate_of_motion(const Json& frames, int every, double speed) {
  if (frames.size() < 2) return std::nullopt;
  const double span = frames.back().value("time", 0.0) - frames.front().value("time", 0.0);
  if (!(span > 0)) return std::nullopt;
  return std::clamp(speed * static_cast<double>(frames.size() - 1) / span / every, 1.0, 60.0);
}

std::string direction_text(const Vector3& v) {
  return format_number(v.x()) + "," + format_number(v.y()) + "," + format_number(v.z());
}

}  // namespace

std::array<double, 2> film_range(std::vector<std::array<double, 2>> extremes) {
  const auto ninth_tenth = [&extremes](std::size_t end, double sign) {
    std::vector<double> ends;
    for (const std::array<double, 2>& range : extremes) ends.push_back(sign * range[end]);
    std::ranges::sort(ends);
    const double usual = ends[(9 * (ends.size() - 1) + 5) / 10], most = ends.back();
    return sign * (most > 2 * usual && usual > 0 ? usual : most);
  };
  return {ninth_tenth(0, -1), ninth_tenth(1, 1)};
}

FilmPlan plan_film(const std::filesystem::path& folder, const FilmOptions& options,
                   const std::function<void(std::size_t, std::size_t)>& progress) {
  check(options);
  const std::size_t num_frames = frame_files(folder).size();
  FilmPlan plan{.shots = {}, .frames_per_second = 10, .picture = options.picture, .folder = folder};
  const Json frames = frames_of_report(folder);
  if (const std::optional<int> mode = frame_of_mode(frames, options.mode)) {
    for (int k = 0; k < swing_shots; ++k)
      plan.shots.push_back({.frame = *mode, .swing = std::cos(2 * std::numbers::pi * k / swing_shots)});
    plan.frames_per_second = swing_shots;
  } else {
    const MomentsOfFrames moments(numbers_of(frames, "time"), numbers_of(frames, "load"));
    for (std::size_t i = 0; i < num_frames; i += static_cast<std::size_t>(options.every))
      plan.shots.push_back({.frame = static_cast<int>(i), .moment = moments.words(i)});
    if (const auto rate = rate_of_motion(frames, options.every, options.speed))
      plan.frames_per_second = *rate;
  }
  if (plan.shots.empty()) draw_result(folder, -1, options.picture);  // says what is missing
  if (options.frames_per_second) plan.frames_per_second = *options.frames_per_second;
  for (std::size_t i = 0; i < plan.shots.size(); ++i)
    plan.shots[i].turned =
        options.turn * degree * static_cast<double>(i) / static_cast<double>(plan.shots.size());

  PictureOptions scout = options.picture;
  scout.width = scout.height = 64;
  scout.edges = "off";
  const std::size_t stride = std::max<std::size_t>(1, plan.shots.size() / most_scouted);
  const auto look = [&](std::size_t i) {
    scout.scale = options.picture.scale * plan.shots[i].swing;
    const Image::View seen = draw_result(folder, plan.shots[i].frame, scout).view;
    if (progress) progress(i, plan.shots.size());
    return seen;
  };
  Image::View all = look(0);
  std::vector<std::array<double, 2>> extremes = {all.extremes};
  for (std::size_t i = stride; i < plan.shots.size(); i += stride) {
    const Image::View seen = look(i);
    // The direction is that of the frame in which most has moved: the box of displaced places is largest.
    if ((seen.high - seen.low).norm() >= (all.high - all.low).norm()) all.toward = seen.toward;
    all.low = all.low.cwiseMin(seen.low);
    all.high = all.high.cwiseMax(seen.high);
    extremes.push_back(seen.extremes);
    all.up = seen.up;
  }
  plan.toward = all.toward;
  plan.picture.vertical = all.up;
  plan.picture.reach = {all.low, all.high};
  if (options.turn != 0) {  // the box sweeps this while the camera goes around it
    const Vector3 middle = 0.5 * (all.low + all.high);
    const Vector3 half = Vector3::Constant(0.5 * (all.high - all.low).norm());
    plan.picture.reach = {middle - half, middle + half};
  }
  const std::array<double, 2> range = film_range(std::move(extremes));
  if (!plan.picture.range && range[0] < range[1]) plan.picture.range = range;
  return plan;
}

Image draw_shot(const FilmPlan& plan, std::size_t shot) {
  const FilmPlan::Shot& wanted = plan.shots[shot];
  PictureOptions options = plan.picture;
  options.scale *= wanted.swing;
  const Vector3 toward = Eigen::AngleAxisd(wanted.turned, plan.picture.vertical.normalized()) * plan.toward;
  options.view = direction_text(toward);
  if (options.caption.empty()) options.caption = wanted.moment;
  return draw_result(plan.folder, wanted.frame, std::move(options));
}

}  // namespace resilin
