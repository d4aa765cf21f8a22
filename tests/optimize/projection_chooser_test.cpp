#include "resilin/optimize/projection_chooser.hpp"

#include <gtest/gtest.h>

namespace resilin {
namespace {

TEST(ProjectionChooser, StaysWithAFixedPolicy) {
  const ProjectionChooser none(ProjectionPolicy::none), clamp(ProjectionPolicy::clamp);
  EXPECT_EQ(none.first_choice(), Projection::none);
  EXPECT_EQ(none.next_choice(Projection::none), Projection::none);
  EXPECT_EQ(clamp.first_choice(), Projection::clamp);
  EXPECT_EQ(clamp.next_choice(Projection::clamp), Projection::clamp);
  EXPECT_EQ(ProjectionChooser(ProjectionPolicy::absolute).first_choice(), Projection::absolute);
}

TEST(ProjectionChooser, TriesStrongerProjectionsAfterAFailure) {
  const ProjectionChooser chooser(ProjectionPolicy::adaptive);
  EXPECT_EQ(chooser.next_choice(Projection::none), Projection::clamp);
  EXPECT_EQ(chooser.next_choice(Projection::clamp), Projection::absolute);
  EXPECT_EQ(chooser.next_choice(Projection::absolute), Projection::absolute);
}

TEST(ProjectionChooser, ProjectsForFourStepsAfterAnIndefiniteMatrix) {
  ProjectionChooser chooser(ProjectionPolicy::on_failure);
  EXPECT_EQ(chooser.first_choice(), Projection::none);
  chooser.matrix_was_indefinite();
  for (int step = 0; step < 4; ++step) {
    EXPECT_EQ(chooser.first_choice(), Projection::clamp) << step;
    chooser.step_was_taken(1, 1);
  }
  EXPECT_EQ(chooser.first_choice(), Projection::none);
}

/// By the ratio of the actual to the predicted decrease, and the length of the step.
TEST(ProjectionChooser, FollowsHowWellStepsWerePredicted) {
  ProjectionChooser chooser(ProjectionPolicy::adaptive);
  EXPECT_EQ(chooser.first_choice(), Projection::none);
  chooser.step_was_taken(0.5, 1);
  EXPECT_EQ(chooser.first_choice(), Projection::clamp);
  chooser.step_was_taken(0.1, 1);
  EXPECT_EQ(chooser.first_choice(), Projection::absolute);
  chooser.step_was_taken(0.5, 0.5);
  EXPECT_EQ(chooser.first_choice(), Projection::clamp);
  chooser.step_was_taken(0.9, 0.1);
  EXPECT_EQ(chooser.first_choice(), Projection::absolute);
  chooser.step_was_taken(0.9, 1);
  EXPECT_EQ(chooser.first_choice(), Projection::none);
  chooser.step_was_taken(0.1, 1);  // the exact Hessian is left for the next stronger one
  EXPECT_EQ(chooser.first_choice(), Projection::clamp);
}

}  // namespace
}  // namespace resilin
