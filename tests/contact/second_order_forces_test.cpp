#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "resilin/contact/surface_contact.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double reach = 0.02;

/// Two tetrahedra, an edge of one across an edge of the other at a distance. The way slides the upper edge
/// along itself and tilts it about its middle: to first order the distance stays as it is, at the end it
/// would be below zero.
struct SlideAndTilt {
  std::vector<ContactBody> bodies;
  VectorX positions = VectorX::Zero(24);
  VectorX way = VectorX::Zero(24);

  SlideAndTilt(const Eigen::Quaterniond& turn, double distance, double tilt) {
    const std::array<Vector3, 8> places = {
        Vector3(-1, 0, 0), {1, 0, 0},        {0, -0.5, -1},           {0, 0.5, -1},
        {0, -1, distance}, {0, 1, distance}, {-0.5, 0, 1 + distance}, {0.5, 0, 1 + distance}};
    for (Index v = 0; v < 8; ++v) {
      const Vector3& x = places[static_cast<std::size_t>(v)];
      positions.segment<3>(3 * v) = turn * x;
      if (v >= 4) way.segment<3>(3 * v) = turn * Vector3(0, 0.5, tilt * x.y());
    }
    for (const Index first : {0, 4}) {
      CellBlock facets = boundary(*make_box({1, 1, 1}, {1, 1, 1}).find_solid(3)).facets;
      facets.nodes.clear();
      for (const std::array<Index, 3>& face : {std::array<Index, 3>{0, 1, 2}, std::array<Index, 3>{0, 3, 1},
                                               std::array<Index, 3>{1, 3, 2}, std::array<Index, 3>{2, 3, 0}})
        for (const Index corner : face) facets.nodes.push_back(first + corner);
      bodies.push_back({std::move(facets), 1e5});
    }
  }
};

TEST(SecondOrderForces, LeadAStepAroundWhatTurnsInItsWay) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(normal(generator), normal(generator), normal(generator), normal(generator))
            .normalized();
    const double distance = reach * std::pow(10, -0.3 - 0.06 * i);
    const SlideAndTilt bad(turn, distance, 4 * distance), good(turn, distance, -4 * distance);
    const VectorX& x = bad.positions;
    const SurfaceContact contact("contact", make_contact_surface(3, bad.bodies, x), BodyMeetings(2, false),
                                 reach, x);
    VectorX forces = VectorX::Zero(x.size());
    EXPECT_EQ(contact.max_step(x, good.way, {}), 1);
    EXPECT_FALSE(contact.add_second_order_forces(x, good.way, {}, forces));
    EXPECT_TRUE(forces.isZero(0));

    const double length = contact.max_step(x, bad.way, {});
    EXPECT_NEAR(length, std::sqrt(0.9 / 2), 0.02);
    ASSERT_TRUE(contact.add_second_order_forces(x, bad.way, {}, forces));
    Vector3 sum = Vector3::Zero();
    for (Index v = 0; v < 8; ++v) sum += forces.segment<3>(3 * v);
    EXPECT_LE(sum.norm(), 1e-12 * forces.norm());

    BlockMatrix hessian(3, std::make_shared<const BlockPattern>(BlockPatternBuilder(8).build()));
    contact.add_hessian(x, {}, Projection::clamp, hessian);
    Eigen::MatrixXd H(24, 24);
    for (Eigen::Index k = 0; k < 24; ++k) {
      VectorX column;
      multiply(hessian, VectorX::Unit(24, k), column);
      H.col(k) = column;
    }
    H.diagonal().array() += 0.1 * H.diagonal().maxCoeff();
    const VectorX correction = H.ldlt().solve(forces);
    EXPECT_LT(correction.norm(), 40 * distance);
    EXPECT_EQ(contact.max_step(x, bad.way + correction, {}), 1) << distance;
  }
}

}  // namespace
}  // namespace resilin
