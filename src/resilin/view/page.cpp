#include "resilin/view/page.hpp"

#include <stdexcept>

namespace resilin {
namespace {

/// Puts `text` in the place of the only `mark`.
void replace(std::string& page, std::string_view mark, std::string_view text) {
  const std::size_t at = page.find(mark);
  if (at == std::string::npos) throw std::logic_error("the built page lacks " + std::string(mark));
  page.replace(at, mark.size(), text);
}

}  // namespace

std::string source_script(std::string_view kind) {
  return R"(<script id="source" type="application/json">{"kind": ")" + std::string(kind) + R"("}</script>)";
}

std::string page_with(std::string_view source, std::string_view nonce) {
  const std::span<const unsigned char> bytes = page_bytes();
  std::string page(bytes.begin(), bytes.end());
  replace(page, source_script("live"), source);
  constexpr std::string_view program = R"(<script id="program")";
  if (!nonce.empty()) replace(page, program, std::string(program) + " nonce=\"" + std::string(nonce) + '"');
  return page;
}

}  // namespace resilin
