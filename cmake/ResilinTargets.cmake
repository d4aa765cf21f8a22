# Functions that define the library's modules and tests, so that each module lists only its sources.

add_library(resilin_options INTERFACE)
target_compile_features(resilin_options INTERFACE cxx_std_20)
target_compile_options(resilin_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wpedantic
  $<$<BOOL:${RESILIN_WARNINGS_AS_ERRORS}>:-Werror>
  # g++ 12 sees overlaps and overruns in sums of std::string that are none (GCC bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict -Wno-error=array-bounds
  -Wno-error=stringop-overflow>
  # g++ collects garbage once it holds so many KiB; by then most files are done.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=400000>
  # A null pointer and an object that is too small end in the address sanitizer all the same, x86-64 reads from any
  # address: these three checks are a quarter of what there is to compile.
  $<$<BOOL:${RESILIN_SANITIZE}>:-fsanitize=address,undefined -fno-sanitize=null,object-size,alignment
  -fno-sanitize-recover=undefined -fno-omit-frame-pointer>
  # With sanitizers g++ takes the states of std::regex for numbers that were never set (GCC bug 105562).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${RESILIN_SANITIZE}>>:-Wno-maybe-uninitialized>
  $<$<BOOL:${RESILIN_SANITIZE_THREAD}>:-fsanitize=thread -fno-omit-frame-pointer>
  $<$<BOOL:${RESILIN_COVERAGE}>:--coverage>)
target_link_options(resilin_options INTERFACE
  $<$<BOOL:${RESILIN_SANITIZE}>:-fsanitize=address,undefined>
  $<$<BOOL:${RESILIN_SANITIZE_THREAD}>:-fsanitize=thread>
  $<$<BOOL:${RESILIN_COVERAGE}>:--coverage>)

# What is checked for reads and writes out of bounds alone. In the lanes' straight-line code, which is inlined into very
# large functions, the other checks take minutes of compilation (all laws together: 88 s for scopes and 59 s for undefined
# behaviour, against 7 s) and have little to find; in the sources of tests they are a third of what there is to compile.
# Linked after resilin_options, whose sanitizers these flags take back.
add_library(resilin_bounds_only INTERFACE)
target_compile_options(resilin_bounds_only INTERFACE
  $<$<BOOL:${RESILIN_SANITIZE}>:-fno-sanitize=undefined -fno-sanitize-address-use-after-scope>)

# Sources of tests: the library that they test is optimised, what they say themselves need not be.
add_library(resilin_test_options INTERFACE)
target_compile_options(resilin_test_options INTERFACE $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Og>)
target_link_libraries(resilin_test_options INTERFACE resilin_bounds_only)

# ccache keeps objects that saw a precompiled header only when told that their macros and dates do not matter; relative
# paths let two build folders share objects.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
  list(PREPEND CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_BASEDIR=${PROJECT_SOURCE_DIR})
endif()

# resilin_precompile(TARGET GROUP <header> ...): parses these headers once for all targets of a group, in the first of
# them. The targets of a group have the same compile flags; kernels, whose flags differ, go without.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON does without.
function(resilin_precompile target group)
  get_property(first GLOBAL PROPERTY RESILIN_PRECOMPILED_${group})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY RESILIN_PRECOMPILED_${group} ${target})
  endif()
  # The preprocessor alone, which ccache runs, reads a precompiled header only when told so.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

# resilin_unite(TARGET a.cpp ...): its sources are compiled in groups of four, in the order of the list; those named here,
# big ones or with names that others have, by themselves.
function(resilin_unite target)
  if(RESILIN_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 4)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()

# resilin_module(NAME SOURCES a.cpp ... ALONE big.cpp ... DEPENDS core ...): the static library resilin_NAME, alias
# resilin::NAME. ALONE: see resilin_unite.
function(resilin_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;DEPENDS;LINK" ${ARGN})
  set(target resilin_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(resilin::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:resilin_options>)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC resilin_${dependency})
  endforeach()
  target_link_libraries(${target} PUBLIC ${ARG_LINK})
  resilin_precompile(${target} MODULES
    <Eigen/Core> <Eigen/Geometry> <algorithm> <cmath> <functional> <map> <memory> <optional> <span> <string> <vector>)
  resilin_unite(${target} ${ARG_ALONE})
  set_property(GLOBAL APPEND PROPERTY RESILIN_MODULES ${target})
endfunction()

# resilin_test(NAME SOURCES a_test.cpp ... ALONE big_test.cpp ... LINK resilin::x ...): a GoogleTest program; ctest runs each
# of its tests, under the name that its INSTANTIATE_TEST_SUITE_P gives it: values as GoogleTest prints them may hold addresses,
# and differ from run to run. ALONE: see resilin_unite.
function(resilin_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;LINK" ${ARGN})
  set(target ${name}_test)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE resilin_options resilin_test_options resilin_test_support ${ARG_LINK})
  resilin_precompile(${target} TESTS)
  resilin_unite(${target} ${ARG_ALONE})
  gtest_discover_tests(${target} TEST_PREFIX "${name}/" NO_PRETTY_VALUES DISCOVERY_MODE PRE_TEST
                       DISCOVERY_TIMEOUT 60)
endfunction()
