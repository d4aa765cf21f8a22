#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/cpu.hpp"
#include "resilin/element/element.hpp"
#include "resilin/energy/cell_term.hpp"
#include "resilin/energy/elastic_tiles.hpp"
#include "resilin/energy/energy.hpp"
#include "resilin/material/derive.hpp"

namespace resilin {

/// Rest directions of the fibres of a law that has such: of length 1, those of each family, once or for one
/// cell after another.
struct FibreDirections {
  std::vector<Vector3> directions;
  std::size_t num_families = 0;
};

class ElasticEnergy;

/// Matrices of the cells of an elastic body, of a term that leaves it to the body to add them to the Hessian.
class CellMatrices {
 public:
  virtual ~CellMatrices() = default;
  virtual const ElasticEnergy& body() const = 0;
  /// Adds them to upper blocks [tile block][pair][dim * dim][lane] whose rows sum to zero, as theirs do.
  virtual void add_to(const ElasticTiles::Tile& tile, double* K) const = 0;
};

/// Strain energy of a body: E(x) = sum_cells V Psi(F(x)).
class ElasticEnergy final : public BasicEnergy, public CellTerm {
 public:
  /// @param choice          a name of element/catalog.hpp, with a quadrature rule where the default is not
  /// meant
  /// @param cells           node numbers in the world, those of one cell after another
  /// @param rest_positions  of all nodes of the world, dim each [m]
  /// @param constants       of the law's formula, in its order: once, or for one cell after another
  /// @param fibres          for a law with fibres; one family or two
  /// @param thickness       in 2D: that of a volume [m]
  /// @throws InputError     when a cell has no positive volume, or the fibres do not suit the law
  ElasticEnergy(int dim, const ElementChoice& choice, std::span<const Index> cells,
                const VectorX& rest_positions, const LawInfo& law, std::span<const double> constants,
                const FibreDirections& fibres = {},
                InstructionSet instruction_set = preferred_instruction_set(),
                ElasticTiles::Gradients gradients = ElasticTiles::Gradients::held, double thickness = 1);

  /// A copy whose constants are these times `factors`, one for each constant of the law.
  ElasticEnergy with_scaled_constants(std::span<const double> factors) const;

  /// A copy whose isochoric energy is softened by the largest that it has had (energy/softening.hpp).
  /// @param most       largest isochoric energy by quadrature point [J/m^3], as `energy_densities` has them
  /// @param isochoric  the same body without its volume energy
  ElasticEnergy with_softening(const Softening& softening, std::span<const double> most,
                               const ElasticEnergy& isochoric) const;

  std::string_view name() const override { return "elastic"; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::elastic,
            .is_quadratic = law().is_quadratic && !element().has_mean_volume};
  }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  double magnitude(const VectorX& x, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_pattern(BlockPatternBuilder& builder) const override;
  void bind(const BlockPattern& pattern) override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;

  const CellTerm* cell_term() const override { return this; }
  /// Mixed elements keep a constant pressure per cell: dU/dJ of the law's volume energy [Pa]. Newton
  /// may carry them along (docs/theory/mean_volume.md); empty for other elements.
  VectorX internal_values(const VectorX& x) const override;
  Eigen::Index num_internal_values() const override;
  VectorX predicted_internal_values(const VectorX& x, const VectorX& p, double t) const override;
  void add_hessian_at(const VectorX& internal, const VectorX& x, const Conditions& c, Projection projection,
                      BlockMatrix& hessian, std::span<const CellMatrices* const> along = {}) const override;
  bool takes(const CellMatrices& matrices) const override { return &matrices.body() == this; }

  /// "constants", of the law, for one cell after another where they differ; "rest_positions" of the world.
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;
  /// slopes += dE/dp of one of `parameters`, x held: the slopes of `value` itself.
  void add_energy_slopes(std::string_view name, const VectorX& x, VectorX& slopes) const;
  /// slopes += the slopes of sum_cells by_cell V by the rest positions of the world.
  void add_volume_slopes(std::span<const double> by_cell, VectorX& slopes) const;

  /// forces += d2E/dx2 w, unprojected, without a matrix.
  void add_tangent_forces(const VectorX& x, const VectorX& w, VectorX& forces) const;

  /// For laws that need J > 0: the largest t in (0, 1] such that no cell loses more than nine tenths of its
  /// volume at a quadrature point along x + t p; J > 0 at x + t p is checked there in the arithmetic of
  /// `value`. Once `bound_inversion_everywhere` was called, J > 0 holds at x + t p in the whole of every
  /// cell, by a bound and not by samples (element/jacobian_bound.hpp). The energy itself knows the points
  /// alone: its minimum may fold a cell at the edge of a support, and is then out of reach. Cells with J <= 0
  /// at x bound nothing.
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override;
  void bound_inversion_everywhere() { bounds_everywhere_ = true; }

  struct VolumeRatio {
    double ratio;
    Index cell;  ///< -1 for a body without cells
  };
  /// Smallest J and the cell where it is; nan, and the first such cell, when some J is not a number.
  VolumeRatio min_volume_ratio(const VectorX& x) const;

  Index num_cells() const { return tiles_.blocks.num_cells; }
  double thickness() const { return thickness_; }
  const ElementInfo& element() const { return *element_; }
  const QuadratureRule& quadrature() const { return *rule_; }
  Index num_points() const {
    return static_cast<Index>(rule_->points.size());
  }  ///< number of quadrature points of a cell
  const LawInfo& law() const { return *tiles_.law; }
  InstructionSet instruction_set() const { return instruction_set_; }
  double total_rest_volume() const;
  Material material(Index cell) const;

  /// By cell, in the order in which the cells were given [m^3].
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

  // For other terms on the same cells: their loops over tiles, in parallel, each node and each block of the
  // matrix summed in an order that does not depend on the number of threads.
  const ElasticTiles& tiles() const { return tiles_; }
  /// Adds what `add` puts at the owned nodes, local numbers with the stride of the kernels.
  using AddForces = std::function<void(const ElasticTiles::Tile&, const OwnedNodes&, ElasticTiles::Scratch&,
                                       double* local)>;
  void add_by_owner(const AddForces& add, VectorX& forces) const;
  /// Adds the element matrices that `fill` writes into scratch.K. `displacements` will be read for it, by
  /// local node.
  using FillBlocks = std::function<void(const ElasticTiles::Tile&, ElasticTiles::Scratch&)>;
  void add_blocks_by_owner(const double* displacements, const FillBlocks& fill, BlockMatrix& matrix) const;

  /// Computes all element Hessians into a buffer that is thrown away (to measure the kernels).
  void evaluate_hessians(const VectorX& x, Projection projection) const;

 private:
  /// Change by the mean volume of a cell at a point: U(J_mean) - U(J), and dU/dJ [Pa] likewise.
  struct VolumeChange {
    double energy, pressure;
  };
  std::vector<VolumeChange> mean_volume_changes(const VectorX& x) const;  ///< none for elements without
  void set_constants(std::span<const double> constants);
  void set_directions(const FibreDirections& fibres);
  double energy_sum(const double* displacements, const double* displacements_from) const;
  void add_forces(const VectorX& x, bool is_magnitude, VectorX& forces) const;
  void add_hessian_to(const VectorX& x, Projection projection, const double* pressures,
                      std::span<const CellMatrices* const> along, BlockMatrix& hessian) const;
  void add_constant_slopes(const VectorX& x, const VectorX& w, VectorX& slopes) const;
  void add_constant_energies(const VectorX& x, VectorX& slopes) const;
  /// slopes += what `fill` writes of each constant of a tile, by entry, times the weights of the points.
  using FillSlopes =
      std::function<void(const ElasticTiles::Tile&, std::size_t p, ElasticTiles::Scratch&, double* by_entry)>;
  void add_weighted_slopes(const FillSlopes& fill, VectorX& slopes) const;
  template <int dim>
  void add_tangent_products(const VectorX& x, const VectorX& w, VectorX& forces) const;
  template <int dim>
  void add_shape_energies(const VectorX& x, VectorX& slopes) const;
  template <int dim>
  void add_shape_volumes(std::span<const double> by_cell, VectorX& slopes) const;
  template <int dim>
  void add_constant_forces(const VectorX& x, const VectorX& change, VectorX& gradient) const;
  template <int dim>
  void add_shape_forces(const VectorX& x, const VectorX& direction, bool is_transposed,
                        VectorX& result) const;
  template <class Place>
  void find_places(const BlockPattern& pattern, std::vector<Place>& places);
  MatrixPlaces places() const;
  bool turns_a_cell_inside_out(const VectorX& from, const VectorX& to) const;
  VectorX mean_pressures(const VectorX& x, const VectorX* p, double t) const;
  /// The parts for the present number of threads, from `parts_` when they were made for it.
  std::shared_ptr<const std::vector<OwnerPart>> parts() const;
  /// Calls `body(cell, point, H, J)` for every quadrature point, in any order and at the same time; H = grad
  /// u, in 2D with zeros.
  using PointBody = std::function<void(std::size_t cell, std::size_t point, const Matrix<3>& H, double J)>;
  void for_each_point(const VectorX& x, const PointBody& body) const;
  /// A node of a cell, in the order of `ElementBlocks::nodes`, by its number in the world.
  Index world_node(std::size_t cell, std::size_t node) const;
  std::size_t place(std::size_t cell, std::size_t point) const {
    return cell * static_cast<std::size_t>(num_points()) + point;
  }

  const ElementInfo* element_;
  const QuadratureRule* rule_;
  InstructionSet instruction_set_;
  ElasticTiles tiles_;
  Eigen::Index num_world_unknowns_;
  double thickness_;
  bool bounds_everywhere_ = false;   ///< see max_step
  std::size_t num_families_ = 0;     ///< number of families of fibres
  std::vector<Index> all_blocks_;    ///< 0, 1, 2, ...
  std::vector<Index> lane_of_cell_;  ///< block * block_size + lane
  // See MatrixPlaces; set once the pattern is known.
  std::vector<std::uint32_t> row_begin_;
  std::vector<std::uint8_t> narrow_places_;
  std::vector<std::uint32_t> wide_places_;
  std::shared_ptr<const std::vector<OwnerPart>> parts_;
};

}  // namespace resilin
