#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// Everything in a description that the course of a simulation depends on, as names (those of `--set`:
/// "body.beam.material.youngs_modulus") and exact texts of their values; of meshes and long lists the size
/// and a hash. Equal fingerprints mean equal steps, bit by bit.
///
/// Left out is what is only watched or written (titles, probes, sections, skins, output), where messages say
/// it comes from, and an end that the steps before it do not see.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

/// Hash of all that the steps of a run depend on; outputs are not in it.
Fingerprint fingerprint_of(const Description& description);

/// A value that two fingerprints do not share; empty where one of them does not have it.
struct FingerprintDifference {
  std::string name, before, now;
};

/// The first; nothing when they are equal.
std::optional<FingerprintDifference> first_difference(const Fingerprint& before, const Fingerprint& now);

/// "body.beam.material.youngs_modulus is 1e6, not 2e6 as in the scene".
std::string describe(const FingerprintDifference& difference);

}  // namespace resilin
