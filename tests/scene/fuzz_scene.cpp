#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "fuzz_driver.hpp"
#include "resilin/core/error.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/world/world.hpp"

// Every outcome of reading a scene other than a world or an InputError of one line is a failure.

namespace resilin {
namespace {

constexpr std::int64_t max_box_cells = 2000;  // keeps worlds small

void require_one_line(const std::string& message) {
  if (message.empty() || message.find('\n') != message.npos)
    throw std::logic_error("the message is not one line");
}

template <class Work>
void allow_refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    require_one_line(error.what());
  }
}

void read_and_build(std::string_view text, const SceneOptions& options) {
  allow_refusal([&] {
    const Scene scene = read_scene_from_text(text, "scene.toml", RESILIN_SCENES, options);
    for (const std::string& warning : scene.warnings) require_one_line(warning);
    const World world(scene.description);
  });
}

}  // namespace
}  // namespace resilin

/// Entry for libFuzzer and its kin.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  resilin::read_and_build(text, {.overrides = {}, .max_box_cells = resilin::max_box_cells});
  return 0;
}

int main(int argc, char** argv) {
  return resilin::testing::fuzz_main(argc, argv, [](const resilin::testing::FuzzInput& input) {
    if (input.name.ends_with(".set")) {  // arguments of --set
      resilin::read_and_build(input.corpus.at("plane.toml"),
                              {.overrides = {input.bytes}, .max_box_cells = resilin::max_box_cells});
    } else {
      resilin::read_and_build(input.bytes, {.overrides = {}, .max_box_cells = resilin::max_box_cells});
    }
  });
}
