#pragma once

#include <string>
#include <vector>

/// A report as one page that needs no network, whatever was fitted.
namespace resilin {

/// Contents of a page of results.
struct ReportPage {
  std::string title, objective;       ///< texts
  std::vector<std::string> warnings;  ///< texts
  std::string content;                ///< HTML
};

/// The page fit_page.html around its content.
std::string html_page(const ReportPage& page);

/// The first row is the heading.
std::string html_table(const std::vector<std::vector<std::string>>& rows);
/// @param kind  its class: "faint", "warning"
std::string html_paragraph(const std::string& kind, const std::string& text);
std::string html_heading(const std::string& text);
/// A card of HTML.
std::string html_card(const std::string& content);
/// A block of a file, word for word.
std::string html_listing(const std::string& text);
/// Cards beside each other.
std::string html_panels(const std::vector<std::string>& pictures);

}  // namespace resilin
