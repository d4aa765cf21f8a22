#include "resilin/results/playable_page.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "resilin/results/shown_results.hpp"
#include "resilin/view/page.hpp"
#include "resilin/view/recording_codec.hpp"
#include "resilin/world/description_image.hpp"

namespace resilin {
namespace {

std::string script(std::string_view id, std::string_view type, std::string_view text) {
  return "\n<script id=\"" + std::string(id) + "\" type=\"" + std::string(type) + "\">" + std::string(text) +
         "</script>";
}

/// What the module contains besides Resilin.
constexpr std::string_view notice =
    "\n<!-- The module \"engine\" contains Eigen (MPL-2.0), JSON for Modern C++ (MIT, Niels Lohmann), "
    "libc++, libc++abi "
    "and libunwind (Apache-2.0 with LLVM exception), wasi-libc and musl (MIT, Rich Felker and others). -->";

std::string packed(std::string_view id, std::string_view bytes) {
  return script(id, "text/plain", base64(deflated(bytes)));
}

}  // namespace

std::string playable_page(std::string_view engine, const Description& scene,
                          std::span<const std::string> warnings) {
  const nlohmann::json words(std::vector<std::string>(warnings.begin(), warnings.end()));
  const std::string json =
      words.dump(-1, ' ', /*ensure_ascii=*/true, nlohmann::json::error_handler_t::replace);
  return page_with(source_script("playable") + std::string(notice) + packed("engine", engine) +
                       packed("scene", serialize(scene)) +
                       script("warnings", "application/json", escaped_for_page(json)),
                   "");
}

}  // namespace resilin
