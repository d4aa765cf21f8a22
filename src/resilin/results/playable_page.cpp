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

/// Notice of the other software in the module.
constexpr std::string_view notice =
    "\n<!-- The module \"engine\" contains Eigen (MPL-2.0), JSON for Modern C++ (MIT, Niels Lohmann), "
    "libc++, libc++abi "
    "and libunwind (Apache-2.0 with LLVM exception), wasi-libc and musl (MIT, Rich Felker and others). -->";

}  // namespace

std::string packed_script(std::string_view id, std::string_view bytes) {
  return script(id, "text/plain", base64(deflated(bytes)));
}

std::string json_script(std::string_view id, const nlohmann::json& value) {
  const std::string json =
      value.dump(-1, ' ', /*ensure_ascii=*/true, nlohmann::json::error_handler_t::replace);
  return script(id, "application/json", escaped_for_page(json));
}

std::string solver_scripts(std::string_view engine, const Description& scene,
                           std::span<const std::string> warnings) {
  return std::string(notice) + packed_script("engine", engine) + packed_script("scene", serialize(scene)) +
         json_script("warnings", std::vector<std::string>(warnings.begin(), warnings.end()));
}

std::string playable_page(std::string_view engine, const Description& scene,
                          std::span<const std::string> warnings) {
  return page_with(source_script("playable") + solver_scripts(engine, scene, warnings), "");
}

}  // namespace resilin
