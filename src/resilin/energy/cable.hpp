#pragma once

#include <optional>
#include <string>
#include <vector>

#include "resilin/energy/cable_path.hpp"

namespace resilin {

/// A cable through points, or a spring between two: an energy of the length l of the polygon,
///
///   E = k/2 (l - L + f(t) s)^2   or   E = f(t) T l.
///
/// In place of k a table may have the force at some values of the stretch l - L, which is linear between them
/// and beyond.
///
/// Hessian: E'' g g^T + E' sum (1 - n n^T) / |p_i+1 - p_i| over the pieces, g = dl/dx. The first part is
/// never negative, the second one has the sign of E'.
class Cable final : public BasicEnergy {
 public:
  struct Law {
    double stiffness = 0;               ///< k [N/m]
    std::vector<double> elongations{};  ///< l - L of a table, rising, two at least [m]; empty: by k
    std::vector<double> forces{};       ///< likewise [N]
    double rest_length = 0;             ///< L [m]
    double shortening = 0;              ///< s [m]
    std::optional<double> tension{};    ///< T [N]
    bool tension_only = false;          ///< E = 0 where it would push
    TimeFunction function{};            ///< f
  };

  Cable(std::string name, int dim, std::vector<CarriedPoint> points, Law law);

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override {
    return {.category = law_.tension ? EnergyCategory::external : EnergyCategory::elastic};
  }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  void add_pattern(BlockPatternBuilder& builder) const override;
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

  /// Its rest length is that at these positions and follows them in derivatives.
  void rest_at(const VectorX& rest_positions);
  const Law& law() const { return law_; }
  double length(const VectorX& x) const { return path_.length(x); }
  /// Negative where a spring pushes [N].
  double force(const VectorX& x, const Conditions& c) const { return slope(length(x), c); }
  const CablePath& path() const { return path_; }
  /// Direction from the first point to the second.
  Vector3 first_direction(const VectorX& x) const;

 private:
  double stretch(double length, const Conditions& c) const;
  /// Number of the piece of the table in which a stretch lies, and its slope [N/m].
  std::size_t piece_of(double stretch) const;
  double slope_of_piece(std::size_t piece) const;
  double force_at(double stretch) const;
  double energy_at(double stretch) const;  ///< zero without a stretch
  double slope(double length, const Conditions& c) const;
  double curvature(double length, const Conditions& c) const;
  /// Derivative of the force by a number of the law, or by the rest length where that follows positions.
  double force_by(std::string_view parameter, double length, const Conditions& c) const;
  /// A factor for each piece.
  std::vector<double> each(double factor) const { return std::vector<double>(path_.num_pieces(), factor); }

  std::string name_;
  CablePath path_;
  Law law_;
  std::vector<Vector3> rest_pulls_;  ///< dL/dX at each point, where the rest length follows them; else empty
  Eigen::Index num_unknowns_ = 0;    ///< likewise
};

}  // namespace resilin
