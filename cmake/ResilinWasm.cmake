# The build of the preset wasm: apps/play/resilin_play.wasm and the modules that it is made of.

enable_language(C)
include(ResilinTargets)
include(ResilinKernels)

# Lengths of Eigen have 32 bits here, which g++ says nothing about: conversions are checked by the other builds.
target_compile_options(resilin_common_options INTERFACE -Wno-c++11-narrowing -w)

# Headers of the system's libraries, without those of its C library beside them.
find_path(eigen_headers Eigen/Core PATHS /usr/include/eigen3 NO_CMAKE_FIND_ROOT_PATH REQUIRED)
find_path(json_headers nlohmann/json.hpp PATHS /usr/include NO_CMAKE_FIND_ROOT_PATH REQUIRED)
set(headers ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
file(CREATE_LINK ${json_headers}/nlohmann ${headers}/nlohmann SYMBOLIC)
add_library(Eigen3::Eigen INTERFACE IMPORTED GLOBAL)
target_include_directories(Eigen3::Eigen SYSTEM INTERFACE ${eigen_headers})
add_library(nlohmann_json::nlohmann_json INTERFACE IMPORTED GLOBAL)
target_include_directories(nlohmann_json::nlohmann_json SYSTEM INTERFACE ${headers})

add_subdirectory(cmake/wasm)
foreach(module core integrator material element linear mesh energy collision contact optimize world simulation fields live view)
  add_subdirectory(src/resilin/${module})
endforeach()
add_subdirectory(apps/play)
