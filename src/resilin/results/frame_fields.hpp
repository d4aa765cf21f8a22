#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "resilin/view/surface_fields.hpp"

namespace resilin {

/// Fields of the frames of a run, computed for the page when they are wanted (docs/view_protocol.md, "Fields
/// on demand").
class FrameFields {
 public:
  /// @param world   kept by reference
  /// @param frames  files of its frames
  FrameFields(const World& world, std::vector<std::filesystem::path> frames);
  FrameFields(const FrameFields&) = delete;
  FrameFields& operator=(const FrameFields&) = delete;

  /// For each field the bytes for all frames.
  /// @param is_wanted  asked before each frame; the bytes are cut short once it says no
  /// @throws InputError  when a file is not a frame of this world
  std::vector<std::string> values(std::span<const ScalarField> fields,
                                  const std::function<bool()>& is_wanted);

  /// How many numbers a field has in all frames together.
  std::size_t num_values() const;

 private:
  const World& world_;
  std::vector<std::filesystem::path> files_;
  ShownSurface surface_;
  SurfaceFields fields_;
  FieldEvaluator evaluator_;
};

}  // namespace resilin
