#include "resilin/mesh/cut_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "resilin/core/text.hpp"
#include "resilin/mesh/collapsed_cell.hpp"

namespace resilin {
namespace {

bool has_repeated_corner(const CellBlock& block) {
  for (Index cell = 0; cell < block.num_cells(); ++cell)
    if (std::set<Index>(block.cell(cell).begin(), block.cell(cell).end()).size() < block.cell(cell).size())
      return true;
  return false;
}

/// By the diagonal that leaves the smaller piece as large as can be.
void cut_quadrilateral(const Mesh& mesh, std::span<const Index> q, std::vector<Index>& nodes) {
  const auto X = [&](std::size_t i) -> const Vector3& {
    return mesh.vertices[static_cast<std::size_t>(q[i % 4])];
  };
  const Vector3 normal = (X(2) - X(0)).cross(X(3) - X(1));
  const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (X(b) - X(a)).cross(X(c) - X(a)).dot(normal);
  };
  const auto smaller = [&](std::size_t s) { return std::min(area(s, s + 1, s + 2), area(s, s + 2, s + 3)); };
  const std::size_t s = smaller(0) >= smaller(1) ? 0 : 1;
  nodes.insert(nodes.end(), {q[s], q[s + 1], q[s + 2], q[s], q[s + 2], q[(s + 3) % 4]});
}

/// Joins the vertex of the least number to the triangles of all sides that do not have it.
void cut_polyhedron(CellKind kind, std::span<const Index> cell, std::vector<Index>& nodes) {
  const Index apex = *std::ranges::min_element(cell.first(static_cast<std::size_t>(num_corners(kind))));
  for (std::vector<Index>& side : sides_of_different_corners(kind, cell)) {
    if (std::ranges::find(side, apex) != side.end()) continue;
    std::ranges::rotate(side, std::ranges::min_element(side));
    for (std::size_t i = 2; i < side.size(); ++i)
      nodes.insert(nodes.end(), {apex, side[0], side[i - 1], side[i]});
  }
}

/// Puts the pieces of all cells of a dimension into one block.
class Cutter {
 public:
  Cutter(Mesh& mesh, int dimension, Numbering& numbering)
      : mesh_(mesh), numbering_(numbering), dimension_(dimension) {}

  std::string cut() {
    std::vector<CellBlock> blocks;
    new_block_.assign(mesh_.blocks.size(), 0);
    first_piece_.resize(mesh_.blocks.size());
    std::size_t pieces_block = mesh_.blocks.size();
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b) {
      if (is_cut(b) && pieces_block < mesh_.blocks.size()) {
        new_block_[b] = pieces_block;
        continue;
      }
      new_block_[b] = blocks.size();
      if (is_cut(b)) pieces_block = blocks.size();
      blocks.push_back(is_cut(b) ? CellBlock{simplex(), {}} : mesh_.blocks[b]);
    }
    std::vector<std::string> words;
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b)
      if (is_cut(b)) cut_block(b, blocks[pieces_block], words);
    const Index num_pieces = blocks[pieces_block].num_cells();
    carry_groups();
    carry_fields(pieces_block, num_pieces);
    carry_numbers(blocks.size(), pieces_block);
    mesh_.blocks = std::move(blocks);
    return join(words, " and ") + " are cut into " + std::to_string(num_pieces) + " " +
           std::string(name(simplex()));
  }

 private:
  CellKind simplex() const { return dimension_ == 3 ? CellKind::tetrahedron : CellKind::triangle; }
  bool is_cut(std::size_t b) const { return dimension(mesh_.blocks[b].kind) == dimension_; }

  void cut_block(std::size_t b, CellBlock& pieces, std::vector<std::string>& words) {
    const CellBlock& block = mesh_.blocks[b];
    const bool is_simplex = first_order(block.kind) == simplex();
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      first_piece_[b].push_back(pieces.num_cells());
      const auto corners = block.cell(cell).first(static_cast<std::size_t>(num_corners(block.kind)));
      if (is_simplex)
        pieces.nodes.insert(pieces.nodes.end(), corners.begin(), corners.end());
      else if (dimension_ == 2)
        cut_quadrilateral(mesh_, corners, pieces.nodes);
      else
        cut_polyhedron(block.kind, corners, pieces.nodes);
      for (Index piece = first_piece_[b].back(); piece < pieces.num_cells(); ++piece)
        numbers_.push_back(numbering_.cell(b, cell));
    }
    first_piece_[b].push_back(pieces.num_cells());
    if (block.num_cells() > 0 && (!is_simplex || is_second_order(block.kind)))
      words.push_back(std::to_string(block.num_cells()) + " " + std::string(name(block.kind)));
  }

  /// The pieces of a cell, from the first to the one before `second`.
  std::pair<Index, Index> pieces_of(std::size_t b, Index cell) const {
    const auto i = static_cast<std::size_t>(cell);
    return {first_piece_[b][i], first_piece_[b][i + 1]};
  }

  void carry_groups() const {
    for (Group& group : mesh_.groups) {
      std::vector<std::vector<Index>> cells;
      for (std::size_t b = 0; b < group.cells.size(); ++b) {
        if (cells.size() <= new_block_[b]) cells.resize(new_block_[b] + 1);
        std::vector<Index>& target = cells[new_block_[b]];
        for (const Index cell : group.cells[b]) {
          const auto [first, end] = is_cut(b) ? pieces_of(b, cell) : std::pair{cell, cell + 1};
          for (Index piece = first; piece < end; ++piece) target.push_back(piece);
        }
        std::ranges::sort(target);
      }
      group.cells = std::move(cells);
    }
  }

  /// Fields that some of the cut cells do not have are left out.
  void carry_fields(std::size_t pieces_block, Index num_pieces) const {
    std::vector<CellField> fields;
    for (const CellField& field : mesh_.cell_fields) {
      if (!is_cut(field.block)) {
        fields.push_back({field.name, new_block_[field.block], field.values});
        continue;
      }
      auto target = std::ranges::find_if(fields, [&](const CellField& known) {
        return known.name == field.name && known.block == pieces_block;
      });
      if (target == fields.end()) {
        const double none = std::numeric_limits<double>::quiet_NaN();
        fields.push_back(
            {field.name, pieces_block, std::vector<double>(static_cast<std::size_t>(num_pieces), none)});
        target = fields.end() - 1;
      }
      for (std::size_t cell = 0; cell < field.values.size(); ++cell) {
        const auto [first, end] = pieces_of(field.block, static_cast<Index>(cell));
        for (Index piece = first; piece < end; ++piece)
          target->values[static_cast<std::size_t>(piece)] = field.values[cell];
      }
    }
    std::erase_if(fields, [](const CellField& field) {
      return std::ranges::any_of(field.values, [](double value) { return std::isnan(value); });
    });
    mesh_.cell_fields = std::move(fields);
  }

  void carry_numbers(std::size_t num_blocks, std::size_t pieces_block) {
    std::vector<std::vector<std::int64_t>> numbers(num_blocks);
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b)
      if (!is_cut(b) && b < numbering_.cells.size()) numbers[new_block_[b]] = numbering_.cells[b];
    numbers[pieces_block] = std::move(numbers_);
    numbering_.cells = std::move(numbers);
  }

  Mesh& mesh_;
  Numbering& numbering_;
  int dimension_;
  std::vector<std::size_t> new_block_;           ///< new block of each old block
  std::vector<std::vector<Index>> first_piece_;  ///< first piece of each cut cell of a block, and the end
  std::vector<std::int64_t> numbers_;            ///< in the file, of the cell of each piece
};

}  // namespace

bool needs_cuts(const Mesh& mesh, int dimension) {
  bool has_simplices = false, has_others = false;
  for (const CellBlock& block : mesh.blocks) {
    if (block.num_cells() == 0 || resilin::dimension(block.kind) != dimension) continue;
    const CellKind kind = first_order(block.kind);
    if (kind == CellKind::prism || kind == CellKind::pyramid) return true;
    if (kind == CellKind::hexahedron && has_repeated_corner(block)) return true;
    const bool is_simplex = kind == CellKind::tetrahedron || kind == CellKind::triangle;
    (is_simplex ? has_simplices : has_others) = true;
  }
  return has_simplices && has_others;
}

std::string cut_into_simplices(Mesh& mesh, int dimension, Numbering& numbering) {
  return needs_cuts(mesh, dimension) ? Cutter(mesh, dimension, numbering).cut() : std::string();
}

std::string cut_into_triangles(Mesh& mesh, Numbering& numbering) {
  const CellBlock* block = mesh.find_block(CellKind::quadrilateral);
  return block != nullptr && block->num_cells() > 0 ? Cutter(mesh, 2, numbering).cut() : std::string();
}

}  // namespace resilin
