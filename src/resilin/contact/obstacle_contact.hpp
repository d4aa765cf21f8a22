#pragma once

#include "resilin/contact/surface_contact.hpp"

namespace resilin {

/// Keeps the surfaces of bodies off an obstacle that moves by itself: neither bodies nor parts of the
/// obstacle meet each other here.
///
/// Its vertices go from where they are `Conditions::delay` behind to where they should be on straight chords,
/// on which bodies that stand must not be in the way: then it stays behind.
class ObstacleContact final : public SurfaceContact {
 public:
  /// @param surface  whose last body is the obstacle
  ObstacleContact(std::string name, const ContactSurface& surface, double activation_distance,
                  const VectorX& positions);

  std::unique_ptr<Energy> begin_stage(const Stage& stage) const override;

  double least_delay(const VectorX& x, const Conditions& c) const override;

  /// Work of the bodies' forces on the obstacle along its way, at one end or the other, or the change where
  /// bodies stand at last.
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  std::string_view name_in_reports() const override { return name(); }

  /// Besides those of the surface: those of the obstacle's motion.
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;
  const ColliderMotion* motion_of_its_own() const override { return &obstacle().motion; }

  /// Resultant force of the obstacle on the bodies.
  std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const override;

  /// Constraints normal to the obstacle at the nodes within the activation distance.
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;
  // NOLINTNEXTLINE(bugprone-unchecked-optional-access): its surface was made with one
  const ContactObstacle& obstacle() const { return *surface().obstacle; }

 private:
  /// Collision-free share of the obstacle's motion between two times, for the present bodies.
  double free_way(const VectorX& x, double from, double to) const;
};

}  // namespace resilin
