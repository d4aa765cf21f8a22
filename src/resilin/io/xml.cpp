#include "resilin/io/xml.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool is_name(char c) { return !is_blank(c) && c != '=' && c != '>' && c != '"' && c != '\'' && c != '<'; }

std::string unescaped(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> entities = {
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string result;
  while (!text.empty()) {
    const auto found = std::find_if(entities.begin(), entities.end(),
                                    [text](const auto& entity) { return text.starts_with(entity.first); });
    result += found == entities.end() ? text[0] : found->second;
    text.remove_prefix(found == entities.end() ? 1 : found->first.size());
  }
  return result;
}

class XmlScanner {
 public:
  XmlScanner(const std::string& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  std::vector<XmlTag> tags(std::string_view last) {
    std::vector<XmlTag> result;
    while (skip_to_tag()) {
      result.push_back(tag());
      if (result.back().name == last) break;
    }
    return result;
  }

 private:
  [[noreturn]] void fail(std::string_view expected) const {
    const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    const bool is_end = at_ == bytes_.size();
    throw InputError(file_ + ": line " + std::to_string(line), std::string(expected),
                     is_end ? "the end of the file" : printable(bytes_.substr(at_, 20)));
  }

  /// Moves behind the next '<' of a tag; comments and declarations are passed over.
  bool skip_to_tag() {
    while (true) {
      at_ = std::min(bytes_.find('<', at_), bytes_.size());
      if (at_ == bytes_.size()) return false;
      const std::string_view rest = bytes_.substr(at_);
      const std::string_view end = rest.starts_with("<!--")                           ? "-->"
                                   : rest.starts_with("<?") || rest.starts_with("<!") ? ">"
                                                                                      : "";
      if (end.empty()) break;
      const std::size_t found = bytes_.find(end, at_);
      if (found == bytes_.npos) fail("the end of a comment or declaration");
      at_ = found + end.size();
    }
    ++at_;
    return true;
  }

  void skip_blanks() {
    while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
  }

  std::string name(std::string_view what) {
    const std::size_t begin = at_;
    if (at_ < bytes_.size() && bytes_[at_] == '/') ++at_;
    while (at_ < bytes_.size() && is_name(bytes_[at_]) && bytes_[at_] != '/') ++at_;
    if (at_ == begin) fail(what);
    return std::string(bytes_.substr(begin, at_ - begin));
  }

  XmlTag tag() {
    XmlTag result;
    result.name = name("the name of a tag");
    while (true) {
      skip_blanks();
      if (at_ == bytes_.size()) fail("the end of tag <" + printable(result.name) + ">");
      if (bytes_[at_] == '>') break;
      if (bytes_[at_] == '/') {
        result.is_closed = true;
        ++at_;
        continue;
      }
      const std::string key = name("an attribute");
      result.attributes[key] = value();
    }
    ++at_;
    result.text_begin = at_;
    result.text = bytes_.substr(at_, bytes_.find('<', at_) - at_);
    return result;
  }

  std::string value() {
    skip_blanks();
    if (at_ == bytes_.size() || bytes_[at_] != '=') fail("=");
    ++at_;
    skip_blanks();
    if (at_ == bytes_.size() || (bytes_[at_] != '"' && bytes_[at_] != '\'')) fail("a quotation mark");
    const std::size_t end = bytes_.find(bytes_[at_], at_ + 1);
    if (end == bytes_.npos) fail("the end of an attribute");
    const std::string result = unescaped(bytes_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return result;
  }

  const std::string& file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::string XmlTag::attribute(std::string_view key, const std::string& otherwise) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? otherwise : found->second;
}

std::vector<XmlTag> xml_tags(const std::string& file, std::string_view bytes, std::string_view last) {
  return XmlScanner(file, bytes).tags(last);
}

}  // namespace resilin
