#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "resilin/simulation/most_strained.hpp"
#include "resilin/simulation/step.hpp"
#include "resilin/world/fingerprint.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// Data for a bitwise-identical restart with the same verdict.
struct Checkpoint {
  std::string version;      ///< version of the program that wrote it
  Fingerprint fingerprint;  ///< fingerprint of the scene
  FailedSteps failed_steps;
  MostStrained most_strained{};
  State state;
};

/// The bytes of checkpoint.bin.
std::string serialize(const Checkpoint& checkpoint);

/// The checkpoint of such bytes. Throws InputError naming `place` when they are damaged or of another format;
/// whether the state fits a world is for `Simulation::resume_from` to say.
Checkpoint parse_checkpoint(std::string_view bytes, const std::string& place);

/// Whether a run may go on in a scene that is not the one of its checkpoint.
enum class Resume { same_scene, anyway };

/// Throws InputError naming `place` and the first difference when a checkpoint is not of the scene with this
/// fingerprint. With `anyway` the difference comes back in words; only a checkpoint of another kind (static,
/// dynamic, modes) is refused even then.
std::optional<std::string> check_scene(const Checkpoint& checkpoint, const Fingerprint& scene, Resume resume,
                                       const std::string& place);

}  // namespace resilin
