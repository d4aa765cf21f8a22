#include <algorithm>
#include <array>
#include <utility>

#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

/// A term of points that nodes carry: E(W x), with the weights W of the points. It serves loads, which have
/// no stages of their own and no history.
class CarriedTerm final : public Energy {
 public:
  /// @param used  the points that the term depends on
  CarriedTerm(int dim, std::shared_ptr<Energy> term, CarriedPoints points, std::vector<Index> used)
      : dim_(dim), term_(std::move(term)), points_(std::move(points)), used_(std::move(used)) {
    BlockPatternBuilder builder(points_.num_points());
    term_->add_pattern(builder);
    pattern_ = std::make_shared<const BlockPattern>(builder.build());
    term_->bind(*pattern_);
  }

  std::string_view name() const override { return term_->name(); }
  EnergyProperties properties() const override { return term_->properties(); }
  double value(const VectorX& x, const Conditions& c) const override { return term_->value(points(x), c); }
  double magnitude(const VectorX& x, const Conditions& c) const override {
    return term_->magnitude(points(x), c);
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override {
    return term_->difference(points(from), points(to), c);
  }
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override {
    VectorX of_points = no_values();
    term_->add_gradient(points(x), c, of_points);
    add_to_nodes(of_points, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override {
    VectorX of_points = no_values();
    term_->add_gradient_magnitude(points(x), c, of_points);
    for (const Index point : used_)
      points_.add_magnitude_to_nodes(dim_, point, at(point, of_points), magnitude);
  }
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override {
    BlockMatrix of_points(dim_, pattern_);
    term_->add_hessian(points(x), c, projection, of_points);
    const auto size = static_cast<std::size_t>(dim_ * dim_);
    std::array<double, 9> scaled{}, turned{};
    for (Index p = 0; p < pattern_->num_nodes(); ++p) {
      const auto row = static_cast<std::size_t>(p);
      for (Offset slot = pattern_->row_begin[row]; slot < pattern_->row_begin[row + 1]; ++slot) {
        const Index q = pattern_->columns[static_cast<std::size_t>(slot)];
        const double* block = of_points.block(slot);
        if (std::all_of(block, block + size, [](double entry) { return entry == 0; })) continue;
        points_.for_each_pair_of_nodes(p, q, [&](Index a, Index b, double share) {
          for (std::size_t k = 0; k < size; ++k) scaled[k] = share * block[k];
          for (std::size_t k = 0; k < size; ++k)
            turned[k] = scaled[k % static_cast<std::size_t>(dim_) * static_cast<std::size_t>(dim_) +
                               k / static_cast<std::size_t>(dim_)];
          if (p == q) {  // each pair of nodes once
            if (a <= b) hessian.add_block(a, b, scaled.data());
            return;
          }
          // The block (p, q) and its transpose (q, p), whose parts at (a, b) and (b, a) are each other's
          // transposes.
          hessian.add_block(a, b, scaled.data());
          if (a == b) hessian.add_block(a, b, turned.data());
        });
      }
    }
  }
  void add_pattern(BlockPatternBuilder&) const override {}
  void bind(const BlockPattern&) override {}
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override {
    return term_->max_step(points(x), points(p), c);
  }
  const HistoryTerm* history_term() const override { return nullptr; }
  const CellTerm* cell_term() const override { return nullptr; }
  const CellMatrices* cell_matrices() const override { return nullptr; }
  LaggedTerm* lagged_term() override { return nullptr; }
  const FrictionSource* friction_source() const override { return nullptr; }
  bool add_second_order_forces(const VectorX& x, const VectorX& p, const Conditions& c,
                               VectorX& forces) const override {
    VectorX of_points = no_values();
    if (!term_->add_second_order_forces(points(x), points(p), c, of_points)) return false;
    add_to_nodes(of_points, forces);
    return true;
  }
  std::unique_ptr<Energy> begin_stage(const Stage&) const override { return nullptr; }
  void prepare(const VectorX&, const VectorX&, const Conditions&) override {}
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override {
    return term_->driven_work(points(from), before, points(to), after);
  }
  double least_delay(const VectorX& x, const Conditions& c) const override {
    return term_->least_delay(points(x), c);
  }
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override {
    return term_->dissipation(points(from), points(to), duration);
  }
  std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const override {
    return term_->reaction(points(x), c);
  }
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override {
    std::vector<HeldDirection> of_points;
    term_->add_held_directions(points(x), of_points);
    for (const HeldDirection& direction : of_points) {
      HeldDirection of_nodes{.nodes = {}, .direction = direction.direction};
      for (const auto& [point, weight] : direction.nodes)
        points_.for_each_node(
            point, [&](Index node, double share) { add_weight(node, weight * share, of_nodes.nodes); });
      held.push_back(std::move(of_nodes));
    }
  }
  std::vector<EnergyParameter> parameters() const override {
    std::vector<EnergyParameter> all = term_->parameters();
    std::erase_if(all, [](const EnergyParameter& parameter) {
      return parameter.name == "rest_positions" || parameter.name == "forces";
    });
    return all;
  }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override {
    term_->add_parameter_slopes(name, points(x), points(w), c, slopes);
  }
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override {
    VectorX of_points = no_values();
    term_->add_parameter_forces(name, points(x), change, c, of_points);
    add_to_nodes(of_points, gradient);
  }

 private:
  VectorX no_values() const { return VectorX::Zero(Eigen::Index{points_.num_points()} * dim_); }
  Vector3 at(Index point, const VectorX& values) const {
    Vector3 value = Vector3::Zero();
    value.head(dim_) = values.segment(Eigen::Index{point} * dim_, dim_);
    return value;
  }
  VectorX points(const VectorX& x) const {
    VectorX places = no_values();
    for (const Index point : used_)
      places.segment(Eigen::Index{point} * dim_, dim_) = points_.at(dim_, point, x).head(dim_);
    return places;
  }
  void add_to_nodes(const VectorX& of_points, VectorX& of_nodes) const {
    for (const Index point : used_) points_.add_to_nodes(dim_, point, at(point, of_points), of_nodes);
  }

  int dim_;
  std::shared_ptr<Energy> term_;
  CarriedPoints points_;
  std::vector<Index> used_;
  std::shared_ptr<const BlockPattern> pattern_;
};

}  // namespace

std::shared_ptr<Energy> carried_term(std::shared_ptr<Energy> of_vertices, const RigidShape& shape,
                                     Index first_node, const std::vector<Index>& vertices) {
  return std::make_shared<CarriedTerm>(shape.dimension(), std::move(of_vertices),
                                       shape.carried_vertices(first_node), vertices);
}

}  // namespace resilin
