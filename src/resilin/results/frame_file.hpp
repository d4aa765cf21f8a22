#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "resilin/fields/evaluator.hpp"
#include "resilin/io/vtu.hpp"

namespace resilin {

/// A state as a frame of a file: the points at their deformed places, the fields on points and cells, and the
/// number of the body on each cell, and its internal variables. Bodies of one kind of cell stand together,
/// else in their order. A rigid body has the cells of its mesh; their vertices stand behind the nodes of the
/// world, among which its control nodes are points without cells.
VtuContent frame_content(const World& world, const State& state, std::span<const FieldValues> fields);

/// Internal variables of the state of a frame (State::history); empty where the frame has none.
VectorX frame_history(const World& world, const VtuContent& frame);

/// How far moving colliders are behind [s], among the numbers of a frame where they are.
constexpr const char* delay_name = "collider_delay";

/// "0007.vtu".
std::string numbered_vtu(std::size_t number);

/// Time of a state in ParaView: seconds, in statics the load factor, of vibrations their
/// number.
double shown_time(const World& world, const State& state);
/// Gives a state the time and the load factor, or the number, that it is shown with.
void set_shown_time(double shown, const World& world, State& state);

/// Beside and renamed, so that the file is whole even when the program is killed. It does not wait for the
/// disk, which takes longer than a step of a small body: a power cut may take the last frames.
void write_frame(const std::filesystem::path& path, const VtuContent& content);

}  // namespace resilin
