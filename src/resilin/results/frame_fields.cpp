#include "resilin/results/frame_fields.hpp"

#include <charconv>
#include <cstdint>

#include "resilin/results/saved_run.hpp"
#include "resilin/view/frame_codec.hpp"

namespace resilin {
namespace {

constexpr std::string_view mark = "RSV1";

template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

/// The number of a frame in the report, from the name of its file.
std::uint32_t number_of(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  std::uint32_t number = 0;
  std::from_chars(name.data(), name.data() + name.size(), number);
  return number;
}

}  // namespace

FrameFields::FrameFields(const World& world, std::vector<std::filesystem::path> frames)
    : world_(world),
      files_(std::move(frames)),
      surface_(world),
      fields_(world, surface_),
      evaluator_(world) {}

std::size_t FrameFields::num_values() const {
  return files_.size() * static_cast<std::size_t>(surface_.num_vertices());
}

std::vector<std::string> FrameFields::values(std::span<const ScalarField> fields,
                                             const std::function<bool()>& is_wanted) {
  const auto num_vertices = static_cast<std::size_t>(surface_.num_vertices());
  std::vector<std::string> all(fields.size(), std::string(mark));
  for (std::string& bytes : all) {
    append(bytes, static_cast<std::uint32_t>(num_vertices));
    append(bytes, static_cast<std::uint32_t>(files_.size()));
  }
  std::vector<std::vector<float>> values(fields.size());
  std::vector<std::uint16_t> steps(num_vertices + num_vertices % 2, 0);  // whole words
  for (const std::filesystem::path& file : files_) {
    if (!is_wanted()) break;
    fields_.evaluate(evaluator_, state_of_frame(world_, read_vtu(file), file), fields, values);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const FieldRange range = finite_range(values[i]);
      encode_field(values[i], range, steps.data());
      append(all[i], number_of(file));
      append(all[i], range.least);
      append(all[i], range.greatest);
      all[i].append(reinterpret_cast<const char*>(steps.data()), steps.size() * sizeof(steps[0]));
    }
  }
  return all;
}

}  // namespace resilin
