#include "resilin/contact/surface_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "resilin/contact/pressing_forces.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double activation_distance = 0.02;

/// Bodies of one mesh or another as contact sees them.
struct Surfaces {
  int dim;
  std::vector<ContactBody> bodies;
  VectorX positions;
  std::vector<Index> first_nodes;

  void add(const Mesh& mesh, double stiffness, const std::function<Vector3(const Vector3&)>& place) {
    const auto first = static_cast<Index>(positions.size() / dim);
    first_nodes.push_back(first);
    CellBlock facets = boundary(*mesh.find_solid(dim)).facets;
    for (Index& node : facets.nodes) node += first;
    bodies.push_back({std::move(facets), stiffness});
    const Eigen::Index old_size = positions.size();
    positions.conservativeResize(old_size + static_cast<Eigen::Index>(mesh.vertices.size()) * dim);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      positions.segment(old_size + static_cast<Eigen::Index>(i) * dim, dim) =
          place(mesh.vertices[i]).head(dim);
  }
  SurfaceContact contact(bool with_themselves = false) const {
    return {"contact", make_contact_surface(dim, bodies, positions),
            BodyMeetings(static_cast<Index>(bodies.size()), with_themselves), activation_distance, positions};
  }
};

/// A box on a box, turned and shifted upon each other at random, with noise, nearer than the activation
/// distance.
Surfaces boxes(int dim, int seed) {
  std::mt19937 generator(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(-1, 1);
  Surfaces surfaces{.dim = dim, .bodies = {}, .positions = {}, .first_nodes = {}};
  const int up = dim - 1;
  const auto noise = [&] {
    return Vector3(0.002 * unit(generator), 0.002 * unit(generator), 0.002 * unit(generator));
  };
  const Eigen::AngleAxisd turn(dim == 3 ? 0.5 * unit(generator) : 0, Vector3::UnitZ());
  const Vector3 shift = 0.2 * Vector3(unit(generator), dim == 3 ? unit(generator) : 0, 0);
  const double clearance = activation_distance * (0.5 + 0.2 * unit(generator));
  const auto mesh = [&](int n) {
    return dim == 3 ? make_box({1, 1, 0.5}, {n, n, 1}) : make_rectangle({1, 0.5}, {n, 1});
  };
  surfaces.add(mesh(3), 1e4, [&](const Vector3& X) { return Vector3(X + noise()); });
  surfaces.add(mesh(2), 3e5, [&](const Vector3& X) {
    return Vector3(turn * X + shift + (0.5 + clearance) * Vector3::Unit(up) + noise());
  });
  return surfaces;
}

/// The same as one body that meets itself.
Surfaces one_body(Surfaces surfaces) {
  CellBlock& facets = surfaces.bodies[0].facets;
  const CellBlock& others = surfaces.bodies[1].facets;
  facets.nodes.insert(facets.nodes.end(), others.nodes.begin(), others.nodes.end());
  surfaces.bodies.resize(1);
  return surfaces;
}

struct Case {
  std::string name;
  Surfaces surfaces;
  bool with_itself;
};

Case case_of(int seed) {
  const Surfaces two = boxes(2 + seed % 2, seed);
  if (seed % 3 == 2) return {"a body that meets itself", one_body(two), true};
  return {"two bodies", two, false};
}

VectorX random_vector(Eigen::Index size, std::mt19937& generator) {
  std::normal_distribution<double> normal;
  return VectorX::NullaryExpr(size, [&] { return normal(generator); });
}

VectorX gradient_of(const SurfaceContact& contact, const VectorX& x) {
  VectorX gradient = VectorX::Zero(x.size());
  contact.add_gradient(x, {}, gradient);
  return gradient;
}

struct SurfaceContactCases : ::testing::TestWithParam<int> {
  Case which = case_of(GetParam());
  const VectorX& x = which.surfaces.positions;
  SurfaceContact contact = which.surfaces.contact(which.with_itself);
  std::mt19937 generator{static_cast<unsigned>(GetParam() + 1000)};
};
INSTANTIATE_TEST_SUITE_P(Seeds, SurfaceContactCases, ::testing::Range(0, 24));

TEST_P(SurfaceContactCases, HasTheGradientOfItsEnergy) {
  const VectorX gradient = gradient_of(contact, x);
  ASSERT_GT(gradient.norm(), 0) << which.name;
  for (int i = 0; i < 5; ++i) {
    const VectorX way = random_vector(x.size(), generator);
    const double h = 1e-7;
    const double rate = contact.difference(x - h * way, x + h * way, {}) / (2 * h);
    EXPECT_NEAR(rate, gradient.dot(way), 1e-6 * gradient.cwiseAbs().dot(way.cwiseAbs())) << which.name;
  }
}

TEST_P(SurfaceContactCases, HasTheHessianOfItsEnergy) {
  const auto pattern = std::make_shared<const BlockPattern>(
      BlockPatternBuilder(static_cast<Index>(x.size() / which.surfaces.dim)).build());
  BlockMatrix hessian(which.surfaces.dim, pattern);
  contact.add_hessian(x, {}, Projection::none, hessian);
  for (int i = 0; i < 3; ++i) {
    const VectorX way = random_vector(x.size(), generator);
    const double h = 1e-7;
    const VectorX rate = (gradient_of(contact, x + h * way) - gradient_of(contact, x - h * way)) / (2 * h);
    VectorX product;
    multiply(hessian, way, product);
    EXPECT_LT((rate - product).norm(), 1e-4 * product.norm()) << which.name;
  }
}

TEST_P(SurfaceContactCases, ProjectsToAMatrixWithoutNegativeCurvature) {
  const auto pattern = std::make_shared<const BlockPattern>(
      BlockPatternBuilder(static_cast<Index>(x.size() / which.surfaces.dim)).build());
  BlockMatrix hessian(which.surfaces.dim, pattern);
  contact.add_hessian(x, {}, Projection::clamp, hessian);
  for (int i = 0; i < 20; ++i) {
    const VectorX way = random_vector(x.size(), generator);
    VectorX product;
    multiply(hessian, way, product);
    EXPECT_GE(way.dot(product), -1e-10 * way.norm() * product.norm()) << which.name;
  }
}

TEST_P(SurfaceContactCases, ActsAndReacts) {
  const int dim = which.surfaces.dim;
  const VectorX gradient = gradient_of(contact, x);
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  double size = 0;
  for (Index node = 0; node < x.size() / dim; ++node) {
    Vector3 f = Vector3::Zero(), place = Vector3::Zero();
    f.head(dim) = gradient.segment(Eigen::Index{node} * dim, dim);
    place.head(dim) = x.segment(Eigen::Index{node} * dim, dim);
    force += f;
    torque += place.cross(f);
    size += f.norm();
  }
  EXPECT_LT(force.norm(), 1e-12 * size) << which.name;
  EXPECT_LT(torque.norm(), 1e-11 * size) << which.name;
}

/// With a coefficient of one the limits of friction are the normal forces, which make up the gradient but for
/// what fading edges do besides.
TEST_P(SurfaceContactCases, RubsWhereItPushes) {
  const int dim = which.surfaces.dim;
  const auto num_bodies = static_cast<std::size_t>(contact.meetings().num_bodies());
  FrictionContacts contacts;
  contact.add_friction_contacts(x, x, {}, contacts);
  EXPECT_EQ(contacts.size(), 0U);
  contact.set_friction(std::vector<double>(num_bodies * num_bodies, 1));
  contact.add_friction_contacts(x, x, {}, contacts);
  const std::vector<PartForce> forces = pressing_forces(contact.part_forces(x));
  ASSERT_EQ(contacts.size(), forces.size());
  VectorX pushes = VectorX::Zero(x.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FrictionContacts::Entry entry = contacts[i];
    EXPECT_NEAR(entry.contact.normal.norm(), 1, 1e-12);
    EXPECT_GT(entry.contact.normal.dot(forces[i].normal), 0);
    double sum = 0;
    for (const auto& [node, weight] : entry.nodes) {
      pushes.segment(Eigen::Index{node} * dim, dim) -=
          entry.contact.limit * weight * forces[i].normal.head(dim);
      sum += weight;
    }
    EXPECT_NEAR(sum, 0, 1e-12);  // a rigid motion of both is no slip
  }
  const VectorX gradient = gradient_of(contact, x);
  EXPECT_LT((pushes - gradient).norm(), (dim == 2 ? 1e-11 : 0.05) * gradient.norm()) << which.name;
}

TEST_P(SurfaceContactCases, DifferencesAreThoseOfTheEnergies) {
  for (const double h : {1e-3, 1e-5, 1e-8}) {
    const VectorX to = x + h * random_vector(x.size(), generator);
    const double before = contact.value(x, {}), after = contact.value(to, {});
    if (!std::isfinite(after)) continue;
    EXPECT_NEAR(contact.difference(x, to, {}), after - before, 1e-11 * (before + after)) << which.name << h;
  }
}

TEST_P(SurfaceContactCases, StagesSeeTheSame) {
  const std::unique_ptr<Energy> own = contact.begin_stage(Stage{.base_positions = x});
  const VectorX p = 0.01 * random_vector(x.size(), generator);
  own->prepare(x, p, {});
  EXPECT_EQ(own->max_step(x, p, {}), contact.max_step(x, p, {}));
  for (const double t : {0.0, 0.3 * own->max_step(x, p, {})}) {
    const VectorX y = x + t * p;
    EXPECT_EQ(own->value(y, {}), contact.value(y, {})) << t;
    EXPECT_EQ(own->difference(x, y, {}), contact.difference(x, y, {})) << t;
  }
}

/// Whatever the way, each step leaves a gap, and steps on and on never lead to the other side.
TEST_P(SurfaceContactCases, StepsLeaveAGap) {
  VectorX y = x;
  const VectorX p = 0.3 * random_vector(x.size(), generator);
  for (int step = 0; step < 10; ++step) {
    const double before = contact.smallest_gap(y).distance;
    y += contact.max_step(y, p, {}) * p;
    const double after = contact.smallest_gap(y).distance;
    EXPECT_GT(after, 0);
    EXPECT_TRUE(std::isfinite(contact.value(y, {}))) << before;
  }
}

/// Two blocks whose faces do not match press each other with the pressure of two flat faces, their rims
/// included: each point counts once for what of it faces the other, whatever parts it is near to.
TEST(SurfaceContact, OfFlatFacesIsAPressure) {
  for (const int dim : {2, 3}) {
    const double clearance = 0.4 * activation_distance, kappa = 1e5;
    Surfaces surfaces{.dim = dim, .bodies = {}, .positions = {}, .first_nodes = {}};
    const auto mesh = [&](int n) {
      return dim == 3 ? make_box({1, 1, 0.5}, {n, n, n}) : make_rectangle({1, 0.5}, {n, n});
    };
    surfaces.add(mesh(7), kappa, [](const Vector3& X) { return X; });
    surfaces.add(mesh(5), kappa,
                 [&](const Vector3& X) { return Vector3(X + (0.5 + clearance) * Vector3::Unit(dim - 1)); });
    const SurfaceContact contact = surfaces.contact();
    const VectorX gradient = gradient_of(contact, surfaces.positions);
    double force = 0;
    for (Index node = 0; node < surfaces.first_nodes[1]; ++node)
      force += gradient[Eigen::Index{node} * dim + dim - 1];
    const double pressure = -kappa * ClampedLogBarrier{activation_distance}.slope(clearance);
    double area = 0;
    const VectorX places = contact.surface().places(surfaces.positions);
    for (std::size_t v = 0; v < contact.surface().parts.num_vertices(); ++v) {
      const double height = places[static_cast<Eigen::Index>(v) * dim + dim - 1];
      if (std::abs(height - 0.5) < 2 * clearance) area += 0.5 * contact.surface().point_areas[v];
    }
    // In 3D the ridges that cross at the corners bear a little besides.
    EXPECT_NEAR(force / (pressure * area), 1, dim == 2 ? 1e-9 : 0.01) << dim;
    EXPECT_NEAR(area, 1, dim == 2 ? 1e-12 : 0.011);  // corners have the larger share of two faces cut in two
  }
}

/// A body with bumps and valleys and a point that goes over it.
class Valleys {
 public:
  explicit Valleys(int dim, int seed) : generator_(static_cast<unsigned>(seed)) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const int up = dim - 1;
    const auto bump = [&] { return Vector3(0.004 * unit(generator_) * Vector3::Unit(up)); };
    const Mesh ground = dim == 3 ? make_box({0.4, 0.4, 0.2}, {8, 8, 2}) : make_rectangle({0.4, 0.2}, {8, 2});
    const Mesh small =
        dim == 3 ? make_box({0.02, 0.02, 0.02}, {1, 1, 1}) : make_rectangle({0.02, 0.02}, {1, 1});
    surfaces_.dim = dim;
    surfaces_.add(ground, 1e4, [&](const Vector3& X) { return Vector3(X + bump()); });
    surfaces_.add(small, 1e4, [&](const Vector3& X) {
      Vector3 place = X + 0.1 * (Vector3::Ones() + 0.3 * Vector3(unit(generator_), unit(generator_), 0));
      if (dim == 2) place.z() = 0;
      place[up] = X[up] + 0.2 + 0.012;
      return place;
    });
    way_ = VectorX::Zero(surfaces_.positions.size());
    for (Eigen::Index i = Eigen::Index{surfaces_.first_nodes[1]} * dim; i < way_.size(); i += dim)
      way_[i] = 0.15;
  }
  /// Contact forces when the point has gone so far.
  std::vector<PartForce> forces(const SurfaceContact& contact, double t) const {
    return contact.part_forces(surfaces_.positions + t * way_);
  }
  SurfaceContact contact() const { return surfaces_.contact(); }

 private:
  std::mt19937 generator_;
  Surfaces surfaces_;
  VectorX way_;
};

double sum_of(const std::vector<PartForce>& forces) {
  double sum = 0;
  for (const PartForce& force : forces) sum += force.force;
  return sum;
}

/// Forces and directions for friction.
Eigen::Matrix3d directions_of(const std::vector<PartForce>& forces) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PartForce& force : forces) sum += force.force * force.normal * force.normal.transpose();
  return sum;
}

class ForcesThatPress : public ::testing::TestWithParam<int> {};

TEST_P(ForcesThatPress, SumUpToAllForces) {
  const Valleys valleys(2 + GetParam() % 2, GetParam());
  const SurfaceContact contact = valleys.contact();
  for (int k = 0; k <= 100; ++k) {
    const std::vector<PartForce> all = valleys.forces(contact, 0.01 * k), pressing = pressing_forces(all);
    EXPECT_NEAR(sum_of(pressing), sum_of(all), 1e-12 * std::abs(sum_of(all)));
    for (const PartForce& force : pressing) EXPECT_GT(force.force, 0);
  }
}

// Over an edge in a valley a second side presses from one moment to the next: what it bears must begin at
// nothing, or friction would jump. Only where many parts of a corner vanish at once may some of it turn.
TEST_P(ForcesThatPress, FollowAPointWithoutAJump) {
  const Valleys valleys(2 + GetParam() % 2, GetParam());
  const SurfaceContact contact = valleys.contact();
  constexpr int steps = 4000;
  Eigen::Matrix3d last = directions_of(pressing_forces(valleys.forces(contact, 0)));
  double largest = 0, largest_jump = 0, largest_turn = 0;
  int taken_back = 0;
  for (int k = 1; k <= steps; ++k) {
    const std::vector<PartForce> all = valleys.forces(contact, double(k) / steps);
    for (const PartForce& force : all) taken_back += force.force < 0;
    const Eigen::Matrix3d now = directions_of(pressing_forces(all));
    largest = std::max(largest, now.norm());
    largest_jump = std::max(largest_jump, std::abs((now - last).trace()));
    largest_turn = std::max(largest_turn, (now - last).norm());
    last = now;
  }
  EXPECT_GT(taken_back, 0);
  EXPECT_LT(largest_jump, 0.01 * largest);
  EXPECT_LT(largest_turn, 0.05 * largest);
}

INSTANTIATE_TEST_SUITE_P(OverValleys, ForcesThatPress, ::testing::Range(0, 12));

}  // namespace
}  // namespace resilin
