#pragma once

namespace resilin {

// Files at the top of a folder of results.
constexpr const char* report_name = "report.json";
constexpr const char* checkpoint_name = "checkpoint.bin";
constexpr const char* recording_name = "recording.bin";

}  // namespace resilin
