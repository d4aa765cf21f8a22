#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "resilin/fit/predicted_values.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Prior (regularisation) of fields, for u, their way from the start in what is sought (logarithms), over a
/// body of volume V in dim dimensions:
enum class PriorKind {
  smooth,    ///< L^2 mean |grad u|^2, L = V^(1/dim): neighbours are alike
  tikhonov,  ///< mean u^2: values are near to the start
  both,      ///< the sum
};
constexpr std::array<std::string_view, 3> spellings(PriorKind) { return {"smooth", "tikhonov", "both"}; }

/// Cells as far as the prior of a field of them needs it.
struct FieldCells {
  struct Pair {
    Index first, second;
    double weight;  ///< L^2 / V A / d: of the common side's area and the distance of the cells' middles
  };
  int dim = 3;
  std::vector<double> shares;  ///< shares of the volume
  double volume = 0;           ///< [m^3], in 2D [m^2]
  std::vector<Pair> pairs;     ///< pairs of cells with a common side
};
FieldCells field_cells(const CellBlock& cells, const std::vector<Vector3>& vertices, int dim);

/// The quadratic form u^T R u of all unknowns of a fit: that above for each field, nothing for the others.
class FieldPrior {
 public:
  explicit FieldPrior(Eigen::Index num_unknowns);
  ~FieldPrior();
  FieldPrior(const FieldPrior&) = delete;
  FieldPrior& operator=(const FieldPrior&) = delete;

  /// A field of the unknowns from `first` on, one for each cell.
  void add(const FieldCells& cells, Eigen::Index first, PriorKind kind);
  /// After the last field: factorises.
  void finish();

  VectorX times(const VectorX& u) const;  ///< R u
  /// Orthogonal columns of what R does not feel: unknowns that are no cells, constants of pieces that hang
  /// together.
  const DenseMatrix& unfelt() const { return unfelt_; }
  /// G X and the diagonal of G, a symmetric generalised inverse, R G R = R: one cell of each piece whose
  /// constant is not felt stays zero.
  DenseMatrix inverse_times(const DenseMatrix& X) const;
  VectorX inverse_diagonal() const;

 private:
  struct Matrices;
  std::unique_ptr<Matrices> matrices_;
  DenseMatrix unfelt_;
};

}  // namespace resilin
