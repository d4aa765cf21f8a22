#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "resilin/simulation/simulation.hpp"
#include "resilin/world/description_image.hpp"
#include "viewer/live_room.hpp"
#include "viewer/live_turns.hpp"
#include "viewer/mailbox.hpp"
#include "viewer/served_live_scene.hpp"

/// Functions that a self-contained page calls: the live scene of `resilin view`, in the page itself.
///
/// Bytes go in through `resilin_input`, and come out at `resilin_output`. What returns an int says 0 when it
/// has failed; the output then is one line that says why.
namespace {

using resilin::Scene;
using Clock = resilin::viewer::LiveTurns::Clock;

/// A scene that one page plays with.
struct Game {
  Game(std::string image, std::vector<std::string> warnings, std::optional<resilin::State> start)
      : turns(std::make_unique<resilin::viewer::ServedLiveScene>(
                  [image = std::move(image), warnings = std::move(warnings)] {
                    return Scene{resilin::deserialize_description(image, "the scene of this page"), warnings};
                  },
                  resilin::viewer::SaveChanges{}, std::move(start)),
              mailbox) {
    room.opened(page);
  }

  static constexpr resilin::viewer::ClientId page = 1;
  resilin::viewer::Mailbox mailbox;
  resilin::viewer::LiveRoom room{mailbox};
  resilin::viewer::LiveTurns turns;
};

/// The module is one program with one page: what it holds lives as long as it.
struct Program {
  std::string input, output;
  std::vector<std::string> warnings;
  std::optional<resilin::State> start;
  std::unique_ptr<Game> game;
};

Program& program() {
  static Program all;
  return all;
}

template <class Work>
int without_throwing(const Work& work) {
  try {
    work();
    return 1;
  } catch (const std::exception& error) {
    program().output = error.what();
    return 0;
  }
}

}  // namespace

#define RESILIN_EXPORT(name) extern "C" __attribute__((export_name(#name)))

/// Where `size` bytes can be written to, for the call that follows.
RESILIN_EXPORT(resilin_input) char* resilin_input(std::uint32_t size) {
  program().input.resize(size);
  return program().input.data();
}

RESILIN_EXPORT(resilin_output) const char* resilin_output() { return program().output.data(); }
RESILIN_EXPORT(resilin_output_size) std::uint32_t resilin_output_size() {
  return static_cast<std::uint32_t>(program().output.size());
}

/// Adds the input to the warnings of the scene that is then opened.
RESILIN_EXPORT(resilin_warn) void resilin_warn() { program().warnings.push_back(program().input); }

/// The scene that is then opened begins at the state whose image is the input.
RESILIN_EXPORT(resilin_start) int resilin_start() {
  return without_throwing(
      [] { program().start = resilin::deserialize_state(program().input, "the frame of this page"); });
}

/// Begins to play with the scene whose image is the input.
RESILIN_EXPORT(resilin_open) int resilin_open() {
  return without_throwing([] {
    program().game = std::make_unique<Game>(std::move(program().input), program().warnings, program().start);
  });
}

/// The page says what the input holds: docs/view_protocol.md, "Messages of the page".
RESILIN_EXPORT(resilin_receive) int resilin_receive(int is_text) {
  return without_throwing(
      [is_text] { program().game->room.received(Game::page, is_text != 0, program().input); });
}

/// Milliseconds until the next turn; negative where there is none before the page says something.
RESILIN_EXPORT(resilin_wait) double resilin_wait() {
  const Game& game = *program().game;
  if (!game.turns.is_active() && !game.mailbox.has_requests()) return -1;
  const std::chrono::duration<double, std::milli> left = game.turns.due() - Clock::now();
  return left.count() > 0 ? left.count() : 0;
}

RESILIN_EXPORT(resilin_turn) int resilin_turn() {
  return without_throwing([] { program().game->turns.turn(program().game->mailbox.take()); });
}

/// Puts the next message for the page into the output; returns 0 for none, 1 for a text, 2 for bytes.
RESILIN_EXPORT(resilin_next) int resilin_next() {
  const std::optional<resilin::viewer::Outgoing> message = program().game->room.next(Game::page);
  if (!message) return 0;
  program().output = *message->bytes;
  return message->is_text ? 1 : 2;
}

/// Runs the scene whose image is the input to its end; the output is where its nodes then are [m].
RESILIN_EXPORT(resilin_run) int resilin_run() {
  return without_throwing([] {
    resilin::Simulation simulation(
        resilin::deserialize_description(program().input, "the scene of this page"));
    while (!simulation.is_finished()) {
      const resilin::StepReport report = simulation.step();
      if (report.status != resilin::StepReport::Status::converged) throw std::runtime_error(report.reason);
    }
    const resilin::VectorX& x = simulation.state().positions;
    program().output.resize(static_cast<std::size_t>(x.size()) * sizeof(double));
    std::memcpy(program().output.data(), x.data(), program().output.size());
  });
}
