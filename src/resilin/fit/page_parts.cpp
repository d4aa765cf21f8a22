#include "resilin/fit/page_parts.hpp"

#include <map>
#include <span>
#include <string_view>

#include "resilin/fit/fit_page_bytes.hpp"
#include "resilin/fit/plot_frame.hpp"

namespace resilin {
namespace {

/// The template with each {{name}} replaced.
std::string filled(std::string_view page, const std::map<std::string, std::string, std::less<>>& parts) {
  std::string text;
  while (true) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    text += page.substr(0, open);
    if (open == std::string_view::npos) return text;
    text += parts.at(std::string(page.substr(open + 2, close - open - 2)));
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string html_page(const ReportPage& page) {
  std::string warnings;
  for (const std::string& warning : page.warnings) warnings += html_paragraph("warning", warning);
  const std::span<const unsigned char> bytes = fit_page_bytes();
  return filled({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                {{"title", html_text(page.title)},
                 {"objective", html_text(page.objective)},
                 {"warnings", warnings},
                 {"content", page.content}});
}

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  std::string text = "<table>";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += "<tr>";
    for (const std::string& cell : rows[i])
      text += (i == 0 ? "<th>" : "<td>") + html_text(cell) + (i == 0 ? "</th>" : "</td>");
    text += "</tr>";
  }
  return text + "</table>";
}

std::string html_paragraph(const std::string& kind, const std::string& text) {
  return "<p class=\"" + kind + "\">" + html_text(text) + "</p>";
}

std::string html_heading(const std::string& text) { return "<h2>" + html_text(text) + "</h2>"; }

std::string html_card(const std::string& content) { return "<div class=\"card\">" + content + "</div>"; }

std::string html_listing(const std::string& text) { return html_card("<pre>" + html_text(text) + "</pre>"); }

std::string html_panels(const std::vector<std::string>& pictures) {
  std::string text = "<div class=\"panels\">";
  for (const std::string& picture : pictures) text += html_card(picture);
  return text + "</div>";
}

}  // namespace resilin
