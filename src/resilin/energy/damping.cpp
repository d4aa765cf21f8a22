#include "resilin/energy/damping.hpp"

namespace resilin {
namespace {

/// sum_a x_a (x) g_a in the first dim rows and columns; in 2D the rest is zero.
Matrix<3> gradient_of(int dim, std::span<const Index> nodes, const double* g, const VectorX& x) {
  Matrix<3> sum = Matrix<3>::Zero();
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const Eigen::Map<const VectorX> slope(g + a * static_cast<std::size_t>(dim), dim);
    sum.topLeftCorner(dim, dim) += x.segment(Eigen::Index{nodes[a]} * dim, dim) * slope.transpose();
  }
  return sum;
}

/// Edot = sym(F^T Fdot).
Matrix<3> strain_rate(const Matrix<3>& F, const Matrix<3>& F_rate) {
  const Matrix<3> product = F.transpose() * F_rate;
  return 0.5 * (product + product.transpose());
}

Matrix<3> viscous_stress(const Viscosity& viscosity, const Matrix<3>& rate) {
  return 2 * viscosity.eta * rate + viscosity.zeta * rate.trace() * Matrix<3>::Identity();
}

}  // namespace

ViscousBody::ViscousBody(int dim, const ElementInfo& element, const QuadratureRule& rule,
                         std::span<const Index> cells, const VectorX& rest_positions,
                         std::vector<Viscosity> viscosities)
    : dim_(dim),
      nodes_per_cell_(static_cast<std::size_t>(element.num_nodes)),
      points_per_cell_(rule.points.size()),
      cells_(cells.begin(), cells.end()),
      viscosities_(std::move(viscosities)) {
  std::vector<double> positions(nodes_per_cell_ * static_cast<std::size_t>(dim));
  for (std::size_t begin = 0; begin < cells_.size(); begin += nodes_per_cell_) {
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const Index node = cells_[begin + k / static_cast<std::size_t>(dim)];
      positions[k] = rest_positions[Eigen::Index{node} * dim + static_cast<Eigen::Index>(k) % dim];
    }
    for (const QuadraturePoint& point : rule.points) {
      const PointGeometry geometry = point_geometry(element, point, positions);
      weights_.push_back(geometry.weight);
      gradients_.insert(gradients_.end(), geometry.gradients.begin(), geometry.gradients.end());
    }
  }
}

template <class Visit>
void ViscousBody::for_each_point(const VectorX& at, const Visit& visit) const {
  const std::size_t stride = nodes_per_cell_ * static_cast<std::size_t>(dim_);
  for (std::size_t point = 0; point < weights_.size(); ++point) {
    const std::size_t cell = point / points_per_cell_;
    const auto nodes = std::span(cells_).subspan(cell * nodes_per_cell_, nodes_per_cell_);
    const double* g = gradients_.data() + point * stride;
    visit(nodes, g, gradient_of(dim_, nodes, g, at), weights_[point],
          viscosities_[viscosities_.size() == 1 ? 0 : cell]);
  }
}

double ViscousBody::power(const VectorX& at, const VectorX& u, const VectorX& w) const {
  double sum = 0;
  for_each_point(
      at, [&](auto nodes, const double* g, const Matrix<3>& F, double weight, const Viscosity& viscosity) {
        const Matrix<3> stress = viscous_stress(viscosity, strain_rate(F, gradient_of(dim_, nodes, g, u)));
        sum += weight * stress.cwiseProduct(strain_rate(F, gradient_of(dim_, nodes, g, w))).sum();
      });
  return sum;
}

// f_a = V F S g_a
void ViscousBody::add_forces(const VectorX& at, const VectorX& v, bool is_magnitude, VectorX& forces) const {
  for_each_point(at, [&](auto nodes, const double* g, const Matrix<3>& F, double weight,
                         const Viscosity& viscosity) {
    const Matrix<3> FS = F * viscous_stress(viscosity, strain_rate(F, gradient_of(dim_, nodes, g, v)));
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const Eigen::Map<const VectorX> slope(g + a * static_cast<std::size_t>(dim_), dim_);
      const VectorX force = weight * FS.topLeftCorner(dim_, dim_) * slope;
      forces.segment(Eigen::Index{nodes[a]} * dim_, dim_) += is_magnitude ? VectorX(force.cwiseAbs()) : force;
    }
  });
}

// K_ab = V (eta ((g_a.g_b) F F^T + (F g_b) (F g_a)^T) + zeta (F g_a) (F g_b)^T)
void ViscousBody::add_matrix(const VectorX& at, double factor, BlockMatrix& matrix) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  for_each_point(
      at, [&](auto nodes, const double* g, const Matrix<3>& F3, double weight, const Viscosity& viscosity) {
        const RowMajor F = F3.topLeftCorner(dim_, dim_);
        const RowMajor B = F * F.transpose();
        const auto slope = [&](std::size_t a) {
          return Eigen::Map<const VectorX>(g + a * static_cast<std::size_t>(dim_), dim_);
        };
        for (std::size_t a = 0; a < nodes.size(); ++a) {
          const VectorX Fa = F * slope(a);
          for (std::size_t b = a; b < nodes.size(); ++b) {
            const VectorX Fb = F * slope(b);
            const RowMajor block = factor * weight *
                                   (viscosity.eta * (slope(a).dot(slope(b)) * B + Fb * Fa.transpose()) +
                                    viscosity.zeta * Fa * Fb.transpose());
            matrix.add_block(nodes[a], nodes[b], block.data());
          }
        }
      });
}

namespace {

class StageDamping final : public Energy {
 public:
  StageDamping(const ViscousBody& body, const Stage& stage)
      : body_(body), at_(stage.shape), base_positions_(stage.base_positions), duration_(stage.duration) {}

  std::string_view name() const override { return "viscous damping"; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::damping, .is_quadratic = true};
  }
  double value(const VectorX& x, const Conditions&) const override {
    const VectorX u = x - base_positions_;
    return 0.5 / duration_ * body_.power(at_, u, u);
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override {
    return 0.5 / duration_ * body_.power(at_, to - from, (to - base_positions_) + (from - base_positions_));
  }
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override {
    body_.add_forces(at_, (x - base_positions_) / duration_, false, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override {
    body_.add_forces(at_, (x - base_positions_) / duration_, true, magnitude);
  }
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix& hessian) const override {
    body_.add_matrix(at_, 1 / duration_, hessian);
  }

 private:
  const ViscousBody& body_;
  VectorX at_, base_positions_;
  double duration_;
};

}  // namespace

std::unique_ptr<Energy> ViscousDamping::in_motion(const Stage& stage) const {
  return std::make_unique<StageDamping>(body_, stage);
}

}  // namespace resilin
