#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "resilin/fields/evaluator.hpp"
#include "resilin/results/summary.hpp"
#include "resilin/simulation/simulation.hpp"

/// The parts of report.json. Included by sources only: the JSON header is heavy.
namespace resilin {

/// JSON whose keys keep their order.
using Json = nlohmann::ordered_json;  // keys stay in the order of the contract

/// One entry of "frames". Vectors have `dimension` numbers; angular momentum has 3, in 2D 1.
Json frame_json(const Frame& frame, int dimension);

/// The whole frame, with the "extremes" of the fields that are written: for each that has such, { min, max }
/// with value, body, cell or vertex, and position.
Json frame_json(const Frame& frame, const World& world, const State& state,
                std::span<const FieldValues> fields);

/// "bodies".
Json bodies_json(const World& world);
/// "fixes" and "loads": what each acts on, and what a load amounts to.
Json fixes_json(const World& world);
Json loads_json(const World& world);

/// The whole report; `frames` is a list of frame_json.
Json report_json(const World& world, Json frames, const RunSummary& summary);

/// The report as text that people can read too: a line for each key, for each frame and for each body.
std::string report_text(const Json& report);

/// Largest memory that the process has had [MiB].
double peak_memory_MiB();

}  // namespace resilin
