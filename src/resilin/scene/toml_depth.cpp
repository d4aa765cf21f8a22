#include "resilin/scene/toml_depth.hpp"

#include <algorithm>
#include <vector>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

/// Goes over the text once, sign by sign, and knows at each how deep it is.
class DepthScanner {
 public:
  DepthScanner(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  void scan() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      switch (c) {
        case '#':
          at_ = std::min(text_.find('\n', at_), text_.size());
          continue;
        case '"':
        case '\'':
          skip_string(c);
          continue;
        case '\n':
          end_line();
          break;
        case '.':
          ++dots_;
          check();
          break;
        case '=':
          key_depth_ += dots_ + 1;
          dots_ = 0;
          check();
          break;
        case ',':
          key_depth_ = 0;
          dots_ = 0;
          break;
        case '[':
        case '{':
          open(c);
          break;
        case ']':
        case '}':
          close();
          break;
        default:
          break;
      }
      ++at_;
    }
  }

 private:
  /// Open brackets around a place: the depth outside the bracket and that of the key before it.
  struct Bracket {
    int depth = 0, key_depth = 0;
  };

  void open(char c) {
    // At the start of a line a bracket begins a header, whose key takes effect with the line's end.
    if (brackets_.empty() && key_depth_ == 0 && c == '[') {
      is_header_ = true;
      depth_ = 0;
    }
    brackets_.push_back({depth_, key_depth_});
    depth_ += key_depth_ + 1;
    key_depth_ = dots_ = 0;
    check();
  }

  void close() {
    if (is_header_) header_dots_ = std::max(header_dots_, dots_);
    dots_ = 0;
    if (brackets_.empty()) return;
    depth_ = brackets_.back().depth;
    key_depth_ = brackets_.back().key_depth;
    brackets_.pop_back();
  }

  void end_line() {
    ++line_;
    dots_ = 0;
    if (!brackets_.empty()) return;             // a list goes over several lines
    if (is_header_) depth_ = header_dots_ + 2;  // its parts, and the list of [[these]]
    is_header_ = false;
    header_dots_ = 0;
    key_depth_ = 0;
    check();
  }

  void check() const {
    // The depth of a header counts once its line is over; before, its dots do.
    if (depth_ + key_depth_ + dots_ <= deepest_nesting &&
        static_cast<int>(brackets_.size()) <= deepest_nesting)
      return;
    throw InputError(
        name_ + ":" + std::to_string(line_),
        "at most " + std::to_string(deepest_nesting) + " levels of tables, lists and parts of a dotted key",
        "more");
  }

  /// A string in one or three quotes; with double quotes a backslash takes the sign behind it along.
  void skip_string(char quote) {
    const bool is_long = text_.substr(at_).starts_with(std::string(3, quote));
    at_ += is_long ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        if (!is_long) return;  // no TOML: a parser stops here
        ++line_;
      }
      if (c == '\\' && quote == '"') {
        ++at_;
        if (at_ < text_.size() && text_[at_] == '\n') ++line_;
        continue;
      }
      if (c != quote) continue;
      if (!is_long) break;
      if (!text_.substr(at_).starts_with(std::string(3, quote))) continue;
      at_ += 2;
      while (at_ + 1 < text_.size() && text_[at_ + 1] == quote) ++at_;  // quotes just before the end
      break;
    }
    ++at_;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
  int depth_ = 0;      ///< depth of the place, without the key that is being read
  int key_depth_ = 0;  ///< key depth of the keys before "=" on this level
  int dots_ = 0;       ///< in the key or value that is being read
  bool is_header_ = false;
  int header_dots_ = 0;
  std::vector<Bracket> brackets_;
};

}  // namespace

void refuse_deep_toml(std::string_view text, const std::string& name) { DepthScanner(text, name).scan(); }

}  // namespace resilin
