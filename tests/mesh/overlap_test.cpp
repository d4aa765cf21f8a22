// Cells that share space, and cells that only touch.
#include "resilin/mesh/overlap.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <random>

#include "resilin/mesh/generators.hpp"

namespace resilin {
namespace {

struct Solid {
  CellBlock block{CellKind::tetrahedron, {}};
  std::vector<double> positions;

  Solid(const Mesh& mesh, int dim) : block(*mesh.find_solid(dim)) {
    for (const Vector3& X : mesh.vertices) positions.insert(positions.end(), X.data(), X.data() + dim);
  }
  int dim() const { return dimension(block.kind); }
  PlacedCells placed() const { return {block.kind, block.nodes, positions}; }

  Solid moved(const std::function<Vector3(const Vector3&)>& motion) const {
    Solid result = *this;
    for (std::size_t i = 0; i < positions.size(); i += static_cast<std::size_t>(dim())) {
      Vector3 X = Vector3::Zero();
      for (int k = 0; k < dim(); ++k) X[k] = positions[i + static_cast<std::size_t>(k)];
      X = motion(X);
      for (int k = 0; k < dim(); ++k) result.positions[i + static_cast<std::size_t>(k)] = X[k];
    }
    return result;
  }
  Solid shifted(const Vector3& by) const {
    return moved([by](const Vector3& X) -> Vector3 { return X + by; });
  }
};

struct SolidCase {
  std::string name;
  Solid solid;  ///< a box, or a rectangle, from the origin to (1, 1, 1) in 3 x 3 x 3 cells or cubes of them
};

void PrintTo(const SolidCase& c, std::ostream* out) { *out << c.name; }

struct OverlapOfBoxes : ::testing::TestWithParam<SolidCase> {
  const Solid& box = GetParam().solid;
  static bool share(const Solid& a, const Solid& b) {
    const bool here = find_overlap(a.placed(), b.placed()).has_value();
    EXPECT_EQ(find_overlap(b.placed(), a.placed()).has_value(), here);
    return here;
  }
};

INSTANTIATE_TEST_SUITE_P(
    Kinds, OverlapOfBoxes,
    ::testing::Values(SolidCase{"tetrahedra", {make_box({1, 1, 1}, {3, 3, 3}), 3}},
                      SolidCase{"hexahedra", {make_hexahedron_box({1, 1, 1}, {3, 3, 3}), 3}},
                      SolidCase{"triangles", {make_rectangle({1, 1}, {3, 3}), 2}},
                      SolidCase{"quadrilaterals", {make_quadrilateral_rectangle({1, 1}, {3, 3}), 2}}),
    [](const auto& entry) { return entry.param.name; });

TEST_P(OverlapOfBoxes, IsNoneWhereTheyTouch) {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const Vector3 by(x, y, box.dim() == 3 ? z : 0);
        if (by == Vector3::Zero()) continue;
        EXPECT_FALSE(share(box, box.shifted(by))) << by.transpose();
        EXPECT_FALSE(share(box, box.shifted(Vector3(by * (1 - 1e-5)))))
            << by.transpose();                                    // rounded coordinates
        const Vector3 along(0, 0.17, box.dim() == 3 ? 0.11 : 0);  // meshes that do not match
        EXPECT_FALSE(share(box, box.shifted(Vector3(x == 0 ? 1 : x, 0, 0) + along)));
      }
}

TEST_P(OverlapOfBoxes, IsFoundWhereOneReachesIntoTheOther) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share_of_side(-0.95, 0.95), angle(0, 3);
  for (int i = 0; i < 50; ++i) {
    const Vector3 by(share_of_side(random), share_of_side(random),
                     box.dim() == 3 ? share_of_side(random) : 0);
    EXPECT_TRUE(share(box, box.shifted(by))) << by.transpose();
    // Turned about a place that both have.
    const Vector3 middle = Vector3(0.5, 0.5, box.dim() == 3 ? 0.5 : 0);
    const Eigen::AngleAxisd turn(angle(random), Vector3::UnitZ());
    const auto turned = [&](const Vector3& X) -> Vector3 { return middle + turn * (X - middle) + 0.3 * by; };
    EXPECT_TRUE(share(box, box.moved(turned))) << by.transpose();
  }
}

TEST_P(OverlapOfBoxes, IsFoundWhereTheyAreTheSame) { EXPECT_TRUE(share(box, box)); }

TEST_P(OverlapOfBoxes, IsFoundWhereOneIsInsideOfACellOfTheOther) {
  const Solid small =
      box.moved([](const Vector3& X) -> Vector3 { return Vector3(0.41, 0.36, 0) + 0.01 * X; });
  const Solid inner = box.dim() == 2 ? small : small.shifted(Vector3(0, 0, 0.39));
  EXPECT_TRUE(share(box, inner));
}

/// Bars across each other: no vertex of one is inside the other.
TEST_P(OverlapOfBoxes, IsFoundWhereTheyCross) {
  const auto bar = [&](int axis) {
    return box.moved([axis](const Vector3& X) -> Vector3 {
      Vector3 stretched = 0.1 * X;
      stretched[axis] = 10 * X[axis] - 5;
      return stretched;
    });
  };
  EXPECT_TRUE(share(bar(0), bar(1)));
}

TEST_P(OverlapOfBoxes, DoesNotMindCellsInsideOut) {
  const auto mirrored = [](const Vector3& X) -> Vector3 { return {1 - X.x(), X.y(), X.z()}; };
  EXPECT_TRUE(share(box, box.moved(mirrored).shifted(Vector3(0.5, 0.2, 0))));
  EXPECT_FALSE(share(box, box.moved(mirrored).shifted(Vector3(1, 0.2, 0))));
}

/// The sizes of coordinates and of bodies do not matter.
TEST_P(OverlapOfBoxes, IsTheSameForAnySize) {
  for (const double size : {1e-6, 1e-3, 1e3, 1e6}) {
    const Solid scaled = box.moved([size](const Vector3& X) -> Vector3 { return size * X; });
    EXPECT_TRUE(share(scaled, scaled.shifted(Vector3(0.9 * size, 0, 0))));
    EXPECT_FALSE(share(scaled, scaled.shifted(Vector3(size, 0, 0))));
    EXPECT_FALSE(share(scaled, scaled.shifted(Vector3(1.1 * size, 0, 0))));
  }
}

TEST_P(OverlapOfBoxes, NamesTheFirstCellsAndAPlaceOfBoth) {
  const Solid other = box.shifted(Vector3(0.9, 0.05, 0));
  const auto found = find_overlap(box.placed(), other.placed());
  ASSERT_TRUE(found);
  EXPECT_GT(found->place.x(), 0.89);
  EXPECT_LT(found->place.x(), 1.01);
  EXPECT_LT(found->cell, box.block.num_cells());
  EXPECT_LT(found->other, other.block.num_cells());
}

}  // namespace
}  // namespace resilin
