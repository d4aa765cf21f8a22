#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/cpu.hpp"
#include "resilin/element/element.hpp"
#include "resilin/energy/energy.hpp"
#include "resilin/energy/kernels/element_blocks.hpp"
#include "resilin/material/derive.hpp"
#include "resilin/material/law_kernels.hpp"

namespace resilin {

/// Rest directions of the fibres of a law that has such: of length 1, those of each family, once or for one
/// cell after another.
struct FibreDirections {
  std::vector<Vector3> directions;
  std::size_t num_families = 0;
};

/// Strain energy of a body: E(x) = sum_cells V Psi(F(x)).
class ElasticEnergy final : public Energy {
 public:
  /// @param choice          a name of element/catalog.hpp, with a quadrature rule where the default is not
  /// meant
  /// @param cells           node numbers in the world, those of one cell after another
  /// @param rest_positions  of all nodes of the world, dim each [m]
  /// @param constants       of the law's formula, in its order: once, or for one cell after another
  /// @param fibres          for a law with fibres; one family or two
  /// @throws InputError     when a cell has no positive volume, or the fibres do not suit the law
  ElasticEnergy(int dim, const ElementChoice& choice, std::span<const Index> cells,
                const VectorX& rest_positions, const LawInfo& law, std::span<const double> constants,
                const FibreDirections& fibres = {},
                InstructionSet instruction_set = preferred_instruction_set());

  std::string_view name() const override { return "elastic"; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_pattern(BlockPatternBuilder& builder) const override;
  void bind(const BlockPattern& pattern) override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;

  /// Only cells with a node for which project_node[node] != 0 are projected; the others add their exact
  /// Hessian. Returns the number of cells that were projected.
  Index add_hessian_selective(const VectorX& x, const Conditions& c, Projection projection,
                              std::span<const std::uint8_t> project_node, BlockMatrix& hessian) const;

  /// For laws that need J > 0: the largest t in (0, 1] such that no cell loses more than nine tenths of its
  /// volume along x + t p; J > 0 at x + t p is checked in the arithmetic of `value`. Cells with J <= 0 at x
  /// bound nothing.
  double max_step(const VectorX& x, const VectorX& p) const override;

  struct VolumeRatio {
    double ratio;
    Index cell;  ///< -1 for a body without cells
  };
  /// Smallest J and the cell where it is; nan, and the first such cell, when some J is not a number.
  VolumeRatio min_volume_ratio(const VectorX& x) const;

  Index num_cells() const { return blocks_.num_cells; }
  const ElementInfo& element() const { return *element_; }
  const QuadratureRule& quadrature() const { return *rule_; }
  Index num_points() const { return static_cast<Index>(rule_->points.size()); }  ///< of a cell
  const LawInfo& law() const { return *law_; }
  InstructionSet instruction_set() const { return instruction_set_; }
  double total_rest_volume() const;
  Material material(Index cell) const;

  /// By cell, in the order in which the cells were given [m^3], in 2D [m^2] on unit thickness.
  std::vector<double> rest_volumes() const;

  // By quadrature point: those of a cell at [num_points() * cell + point], in the order of `quadrature()`.
  std::vector<double> point_volumes() const;  ///< rest volume that a point stands for [m^3]
  std::vector<double> volume_ratios(const VectorX& x) const;
  std::vector<double> energy_densities(const VectorX& x) const;          ///< [J/m^3]
  std::vector<double> von_mises_stresses(const VectorX& x) const;        ///< [Pa]
  std::vector<Matrix<3>> cauchy_stresses(const VectorX& x) const;        ///< [Pa]
  std::vector<Matrix<3>> deformation_gradients(const VectorX& x) const;  ///< in 2D diag(F_2, 1)

  /// The cell whose nodes carry the largest |residual|, summed; -1 for a body without cells.
  Index worst_cell(const VectorX& residual) const;

  /// Computes all element Hessians into a buffer that is thrown away (to measure the kernels).
  void evaluate_hessians(const VectorX& x, Projection projection) const;

 private:
  struct Scratch;
  void set_directions(const FibreDirections& fibres);
  ElementTile tile(const Index* block_numbers, std::size_t count) const;
  ElementTile tile(std::size_t begin, std::size_t count) const {
    return tile(all_blocks_.data() + begin, count);
  }
  LawForm law_form() const { return {law_->kind, law_->uses_second_invariant}; }
  HessianForm form(Projection projection) const;
  void call_law(void (*kernel)(const LawBatch&), const ElementTile& tile, Scratch& scratch,
                double* results) const;
  double energy_sum(const double* displacements, const double* displacements_from) const;
  void add_forces(const VectorX& x, bool is_magnitude, VectorX& forces) const;
  void add_hessian_to(const VectorX& x, Projection projection, const std::vector<std::uint8_t>& project_lane,
                      BlockMatrix& hessian) const;
  /// The parts for the present number of threads, from `parts_` when they were made for it.
  std::shared_ptr<const std::vector<OwnerPart>> parts() const;
  /// Calls `body(cell, H, J)` for every cell, in any order and at the same time; H = grad u, in 2D with
  /// zeros.
  void for_each_cell(const VectorX& x,
                     const std::function<void(std::size_t cell, const Matrix<3>& H, double J)>& body) const;

  const ElementInfo* element_;
  const QuadratureRule* rule_;
  ElementBlocks blocks_;
  const LawInfo* law_;
  InstructionSet instruction_set_;
  const ElementKernels* kernels_;
  const LawKernels* law_kernels_;
  std::vector<double> constants_;     ///< rows of lanes: one set, or one for each block
  std::size_t constant_stride_;       ///< numbers from block to block in constants_; 0 when there is one set
  std::size_t num_families_ = 0;      ///< of fibres
  std::vector<double> directions_;    ///< of the fibres, [block][fibre_rows][lane]; empty without
  std::vector<Index> all_blocks_;     ///< 0, 1, 2, ...
  std::vector<Index> lane_of_cell_;   ///< block * block_size + lane
  std::vector<std::uint32_t> slots_;  ///< [block][pair][lane]
  std::vector<Index> pattern_nodes_;  ///< world nodes of all cells, for the pattern
  std::shared_ptr<const std::vector<OwnerPart>> parts_;
};

}  // namespace resilin
