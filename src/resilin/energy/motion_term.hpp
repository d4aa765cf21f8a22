#pragma once

#include "resilin/energy/stage_term.hpp"

namespace resilin {

/// A term that acts only while time passes: something in the stages of a step in motion, whose velocities
/// follow from their positions.
class MotionTerm : public StageTerm {
 public:
  std::unique_ptr<Energy> begin_stage(const Stage& stage) const final {
    return stage.is_static() ? nullptr : in_motion(stage);
  }

 private:
  virtual std::unique_ptr<Energy> in_motion(const Stage& stage) const = 0;
};

}  // namespace resilin
