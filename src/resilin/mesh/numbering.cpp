#include "resilin/mesh/numbering.hpp"

#include <algorithm>

namespace resilin {
namespace {

constexpr std::size_t most_listed = 5;

/// "1", "1 and 3" (or "1, 3"), "1, 2, 3, 4, 5 and 40 more".
template <class Number>
std::string listing(std::span<const Index> list, const std::string& last_separator, const Number& number) {
  const std::size_t shown = std::min(list.size(), most_listed);
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0) text += i + 1 == list.size() ? last_separator : ", ";
    text += std::to_string(number(list[i]));
  }
  if (shown < list.size()) text += " and " + std::to_string(list.size() - shown) + " more";
  return text;
}

}  // namespace

std::int64_t Numbering::vertex(Index i) const {
  const auto at = static_cast<std::size_t>(i);
  return at < vertices.size() ? vertices[at] : first_vertex + i;
}

std::int64_t Numbering::cell(std::size_t block, Index i) const {
  const auto at = static_cast<std::size_t>(i);
  return block < cells.size() && at < cells[block].size() ? cells[block][at] : first_cell + i;
}

std::string Numbering::cell_list(std::size_t block, std::span<const Index> list) const {
  return cell_word + (list.size() == 1 ? " " : "s ") +
         listing(list, ", ", [&](Index i) { return cell(block, i); });
}

std::string Numbering::vertex_list(std::span<const Index> list) const {
  return (list.size() == 1 ? "vertex " : "vertices ") +
         listing(list, " and ", [&](Index i) { return vertex(i); });
}

}  // namespace resilin
