#include "resilin/mesh/box_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace resilin::testing {
namespace {

std::vector<Box> sample_boxes(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto point = [&] { return Vector3(unit(random), unit(random), unit(random)); };
  std::vector<Box> boxes(static_cast<std::size_t>(count));
  for (Box& box : boxes) {
    const Vector3 corner = point();
    box.add(corner);
    box.add(corner + 0.2 * point());
  }
  return boxes;
}

TEST(BoxTree, FindsTheBoxesAroundAPointAsLookingAtEachDoes) {
  for (const int count : {0, 1, 4, 5, 300}) {
    const std::vector<Box> boxes = sample_boxes(count, 1);
    int number = 0;
    for (const Box& place : sample_boxes(50, 2)) {
      const BoxTree tree(boxes, ++number % 2 == 0 ? 1000 : 1);  // split, or not
      std::vector<Index> found, expected;
      tree.visit_containing(place.min, [&](Index i) { found.push_back(i); });
      for (Index i = 0; i < count; ++i)
        if (boxes[static_cast<std::size_t>(i)].contains(place.min)) expected.push_back(i);
      std::ranges::sort(found);
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(BoxTree, FindsTheBoxesThatMeetAnotherAsLookingAtEachDoes) {
  for (const int count : {0, 1, 4, 5, 300}) {
    const std::vector<Box> boxes = sample_boxes(count, 5);
    const BoxTree tree(boxes);
    for (const Box& other : sample_boxes(50, 6)) {
      std::vector<Index> found, expected;
      tree.visit_meeting(other, [&](Index i) { found.push_back(i); });
      for (Index i = 0; i < count; ++i)
        if (boxes[static_cast<std::size_t>(i)].meets(other)) expected.push_back(i);
      std::ranges::sort(found);
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(BoxTree, FindsTheNearestBoxAndOfSeveralTheFirst) {
  const std::vector<Box> boxes = sample_boxes(300, 3);
  std::vector<Box> twice = boxes;
  twice.insert(twice.end(), boxes.begin(), boxes.end());
  const BoxTree split(twice), whole(twice, 1);
  for (const Box& place : sample_boxes(50, 4)) {
    const Vector3 point = 2 * place.min;
    const auto distance = [&](Index i) { return twice[static_cast<std::size_t>(i)].squared_distance(point); };
    Index expected = 0;
    for (Index i = 1; i < 600; ++i)
      if (distance(i) < distance(expected)) expected = i;
    EXPECT_EQ(split.nearest(point, distance), expected);
    EXPECT_EQ(whole.nearest(point, distance), expected);
  }
  EXPECT_EQ(BoxTree().nearest(Vector3::Zero(), [](Index) { return 0.0; }), -1);
}

}  // namespace
}  // namespace resilin::testing
