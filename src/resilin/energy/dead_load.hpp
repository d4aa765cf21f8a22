#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "resilin/core/shared_indices.hpp"
#include "resilin/element/element.hpp"
#include "resilin/energy/energy.hpp"
#include "resilin/energy/time_function.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

/// When a load acts, from < t <= until [s], and how strongly.
struct ActiveTime {
  double from = -std::numeric_limits<double>::infinity();
  double until = std::numeric_limits<double>::infinity();
  TimeFunction function{};

  /// Times are met to a small part of a step, so that a window that ends at a step's end includes that step.
  bool contains(double time) const;
  /// Factor of the load: the function's value or the load factor, zero outside its time.
  double factor(const Conditions& c) const { return contains(c.time) ? function.factor(c.time, c.load) : 0; }
  bool is_always() const {
    return function.is_constant() && from == -until && until > 0 && std::isinf(until);
  }
};

/// The largest of the works at the two ends of a way that a change of conditions may do on a term: its energy
/// after the change less that before.
double larger_work(const Energy& term, const VectorX& from, const Conditions& before, const VectorX& to,
                   const Conditions& after);

/// The sums of forces times w over the nodes, one for each axis.
Vector3 power_by_axis(const VectorX& forces, const VectorX& w, int dim);

/// Distribution of a dead load: nodal forces [N] on the rest shape X, linear in a vector, the value.
class LoadedRegion {
 public:
  virtual ~LoadedRegion() = default;
  virtual void add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const = 0;
  /// Adds what a change of X does to them to first order.
  virtual void add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                                VectorX& forces) const = 0;
  /// Adds the slopes of w . forces by X.
  virtual void add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                               VectorX& slopes) const = 0;
  /// How many numbers the value has: its first components, or the third alone where it is one number.
  virtual int value_size(int dim) const { return dim; }
  /// Slopes of w . forces by the components of the value. By default each nodal force is a number of its node
  /// times the value.
  virtual Vector3 value_slopes(int dim, const VectorX& X, const VectorX& w) const;
};

/// A force per rest volume [N/m^3] on cells: f_a = value integral N_a dV.
class LoadedCells final : public LoadedRegion {
 public:
  /// @param cells  nodes in the world, those of one cell after another
  LoadedCells(const ElementInfo& element, SharedIndices cells)
      : element_(element), cells_(std::move(cells)) {}
  void add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const override;
  void add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                        VectorX& forces) const override;
  void add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                       VectorX& slopes) const override;

  const SharedIndices& cells() const { return cells_; }

 private:
  const ElementInfo& element_;
  SharedIndices cells_;
};

/// A traction [N/m^2] (2D: on unit thickness) on facets: f_a = value integral N_a dA.
class LoadedFacets final : public LoadedRegion {
 public:
  LoadedFacets(int dim, CellBlock facets) : dim_(dim), facets_(std::move(facets)) {}
  void add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const override;
  void add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                        VectorX& forces) const override;
  void add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                       VectorX& slopes) const override;

  const CellBlock& facets() const { return facets_; }  ///< in the world's node numbers

 private:
  int dim_;
  CellBlock facets_;
};

/// A force [N] on each of some nodes.
class LoadedNodes final : public LoadedRegion {
 public:
  LoadedNodes(int dim, std::vector<Index> nodes) : dim_(dim), nodes_(std::move(nodes)) {}
  const std::vector<Index>& nodes() const { return nodes_; }
  void add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const override;
  void add_force_change(const Vector3&, const VectorX&, const VectorX&, VectorX&) const override {}
  void add_rest_slopes(const Vector3&, const VectorX&, const VectorX&, VectorX&) const override {}

 private:
  int dim_;
  std::vector<Index> nodes_;
};

/// Forces that keep their size and direction while the body deforms: E = -t f.(x - X), t the load factor or
/// the function of time.
class DeadLoad final : public BasicEnergy {
 public:
  DeadLoad(std::string name, VectorX nodal_forces, VectorX rest_positions, ActiveTime active = {})
      : name_(std::move(name)),
        forces_(std::move(nodal_forces)),
        rest_positions_(std::move(rest_positions)),
        active_(std::move(active)) {}
  /// A load from a region and a value.
  DeadLoad(std::string name, int dim, std::shared_ptr<const LoadedRegion> region, const Vector3& value,
           VectorX rest_positions, ActiveTime active = {});

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.is_quadratic = true}; }
  /// "forces", those of the nodes; of a region instead "value" and "rest_positions".
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix&) const override {}
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  /// The region on which it acts; null where nodal forces alone are known.
  const LoadedRegion* region() const { return region_.get(); }
  /// The value at factor 1.
  const Vector3& full_value() const { return value_; }
  /// Force per rest volume or area of the region under these conditions [N/m^3 or N/m^2].
  Vector3 density(const Conditions& c) const { return factor(c) * value_; }

 private:
  double factor(const Conditions& c) const { return active_.factor(c); }

  std::string name_;
  VectorX forces_;  ///< [N]
  VectorX rest_positions_;
  ActiveTime active_;
  std::shared_ptr<const LoadedRegion> region_{};  ///< null: forces alone are known
  Vector3 value_ = Vector3::Zero();
  int dim_ = 0;
};

/// d(area vector)/d(position of node b) at a point of a facet: `area_vector` of mesh/facet.hpp.
std::array<Eigen::Matrix3d, max_facet_nodes> area_vector_slopes(int dim, const FacetPoint& point,
                                                                std::span<const Index> nodes,
                                                                const VectorX& x);

/// Adds a force per rest volume [N/m^3] on cells to nodal forces [N]: f_a += force integral N_a dV.
/// @param cells  nodes in the world, those of one cell after another
void add_body_force(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                    const Vector3& force, VectorX& nodal_forces);

// How these change with the rest positions: what a change does to first order, and the slopes of w . forces.
void add_body_force_change(const ElementInfo& element, std::span<const Index> cells,
                           const VectorX& rest_positions, const VectorX& change, const Vector3& force,
                           VectorX& nodal_forces);
void add_body_force_slopes(const ElementInfo& element, std::span<const Index> cells,
                           const VectorX& rest_positions, const Vector3& force, const VectorX& w,
                           VectorX& slopes);

}  // namespace resilin
