#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "resilin/contact/surface_contact.hpp"
#include "slide_and_tilt.hpp"

namespace resilin {
namespace {

using testing::SlideAndTilt;

constexpr double reach = 0.02;  // [m]

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
