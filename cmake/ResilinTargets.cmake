# Functions that define the library's modules and tests, so that each module lists only its sources.

# What everything is compiled with.
add_library(resilin_common_options INTERFACE)
target_compile_features(resilin_common_options INTERFACE cxx_std_20)
target_compile_options(resilin_common_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wpedantic
  $<$<BOOL:${RESILIN_WARNINGS_AS_ERRORS}>:-Werror>
  # g++ 12 sees overlaps and overruns in sums of std::string that are none (GCC bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict -Wno-error=array-bounds
  -Wno-error=stringop-overflow>
  # g++ collects garbage once it holds so many KiB; by then most files are done.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=400000>
  $<$<BOOL:${RESILIN_SANITIZE_THREAD}>:-fsanitize=thread -fno-omit-frame-pointer -Wno-tsan>
  $<$<BOOL:${RESILIN_COVERAGE}>:--coverage>)
target_link_options(resilin_common_options INTERFACE
  $<$<BOOL:${RESILIN_SANITIZE}>:-fsanitize=address,undefined>
  $<$<BOOL:${RESILIN_SANITIZE_THREAD}>:-fsanitize=thread>
  $<$<BOOL:${RESILIN_COVERAGE}>:--coverage>)

# What the library and the programs are compiled with: sanitizers ask for little optimisation and line numbers only, half
# the time to build, and keep assertions.
add_library(resilin_options INTERFACE)
target_link_libraries(resilin_options INTERFACE resilin_common_options)
target_compile_options(resilin_options INTERFACE
  # A null pointer, an object that is too small and a pointer out of range end in the address sanitizer all the same,
  # x86-64 reads from any address: these four checks are a third of what there is to compile.
  $<$<BOOL:${RESILIN_SANITIZE}>:-O1 -g1 -UNDEBUG -fsanitize=address,undefined -fno-sanitize=null,object-size,alignment,pointer-overflow
  -fno-sanitize-recover=undefined -fno-omit-frame-pointer>
  # Uses of a variable after its scope: a third of what there is to compile.
  $<$<AND:$<BOOL:${RESILIN_SANITIZE}>,$<NOT:$<BOOL:${RESILIN_SANITIZE_SCOPES}>>>:-fno-sanitize-address-use-after-scope>
  # Eigen pads its arrays where it sees the address sanitizer, and could not free those of the tests, which do not.
  $<$<BOOL:${RESILIN_SANITIZE}>:-DEIGEN_MALLOC_ALREADY_ALIGNED=1>
  # With sanitizers g++ takes the states of std::regex for numbers that were never set (GCC bug 105562).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${RESILIN_SANITIZE}>>:-Wno-maybe-uninitialized>)

# What is checked for reads and writes out of bounds alone. In the lanes' straight-line code, which is inlined into very
# large functions, the other checks take minutes of compilation (all laws together: 88 s for scopes and 59 s for undefined
# behaviour, against 7 s) and have little to find. Linked after resilin_options, whose sanitizers these flags take back.
add_library(resilin_bounds_only INTERFACE)
target_compile_options(resilin_bounds_only INTERFACE
  $<$<BOOL:${RESILIN_SANITIZE}>:-fno-sanitize=undefined -fno-sanitize-address-use-after-scope>)

# For sources of tests, beside resilin_common_options: the library that they test is optimised, what they say themselves
# need not be. They are the same with sanitizers as without, so that ccache has their objects from the other build; see
# resilin_sanitized_first.
add_library(resilin_test_options INTERFACE)
target_compile_options(resilin_test_options INTERFACE $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Og>)

# ccache keeps objects that saw a precompiled header only when told that their macros and dates do not matter; relative
# paths let two build folders share objects.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
  list(PREPEND CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_BASEDIR=${PROJECT_SOURCE_DIR})
endif()

# resilin_precompile(TARGET GROUP <header> ...): parses these headers once for all targets of a group, in the first of
# them. The targets of a group have the same compile flags; kernels, whose flags differ, go without.
# Headers of this project stay out: ccache does not see a change of their comments, and an old precompiled header then clashes
# with the new file.
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

# What sources of modules and programs have precompiled.
set(RESILIN_PRECOMPILED_HEADERS
  <Eigen/Core> <Eigen/Geometry> <algorithm> <cmath> <functional> <map> <memory> <optional> <span> <string> <vector>)

# resilin_compile_quickly(TARGET): for what reads, asks and answers once for a run: GCC's -O1 takes a quarter less to compile
# than -O3. A precompiled header brings the optimisation along with which it was compiled, so that these have one of their
# own; where nothing else is compiled with -O1, they share that of the modules.
function(resilin_compile_quickly target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE -O1)
    resilin_precompile(${target} QUICK ${RESILIN_PRECOMPILED_HEADERS})
  else()
    resilin_precompile(${target} MODULES ${RESILIN_PRECOMPILED_HEADERS})
  endif()
endfunction()

# resilin_module(NAME [QUICKLY] SOURCES a.cpp ... ALONE big.cpp ... DEPENDS core ...): the static library resilin_NAME, alias
# resilin::NAME. ALONE: see resilin_unite. QUICKLY: see resilin_compile_quickly.
function(resilin_module name)
  cmake_parse_arguments(ARG "QUICKLY" "" "SOURCES;ALONE;DEPENDS;LINK" ${ARGN})
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
  if(ARG_QUICKLY)
    resilin_compile_quickly(${target})
  else()
    resilin_precompile(${target} MODULES ${RESILIN_PRECOMPILED_HEADERS})
  endif()
  resilin_unite(${target} ${ARG_ALONE})
  set_property(GLOBAL APPEND PROPERTY RESILIN_MODULES ${target})
endfunction()

# resilin_archives_of(OUT TARGET ...): the libraries of this project that these targets are or use.
function(resilin_archives_of out)
  set(found)
  set(waiting ${ARGN})
  while(waiting)
    list(POP_FRONT waiting target)
    if(NOT TARGET ${target})
      continue()
    endif()
    get_target_property(aliased ${target} ALIASED_TARGET)
    if(aliased)
      set(target ${aliased})
    endif()
    get_target_property(type ${target} TYPE)
    get_target_property(imported ${target} IMPORTED)
    if(imported OR target IN_LIST found OR NOT type STREQUAL "STATIC_LIBRARY")
      continue()
    endif()
    list(APPEND found ${target})
    get_target_property(links ${target} INTERFACE_LINK_LIBRARIES)
    if(links)
      list(APPEND waiting ${links})
    endif()
  endwhile()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# resilin_sanitized_first(TARGET LIBRARY ...): of inline functions that both the sanitized libraries and the tests have, which
# are compiled without, the linker takes those that it sees first.
function(resilin_sanitized_first target)
  if(RESILIN_SANITIZE)
    resilin_archives_of(archives ${ARGN})
    list(TRANSFORM archives REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE files)
    target_link_options(${target} PRIVATE -Wl,--whole-archive ${files} -Wl,--no-whole-archive)
  endif()
endfunction()

# resilin_test(NAME SOURCES a_test.cpp ... ALONE big_test.cpp ... LINK resilin::x ... NOT_WHEN_SANITIZED regex ...): a
# GoogleTest program; ctest runs each of its tests, under the name that its INSTANTIATE_TEST_SUITE_P gives it: values as
# GoogleTest prints them may hold addresses, and differ from run to run. ALONE: see resilin_unite. Tests whose names match
# one of NOT_WHEN_SANITIZED have the label not_when_sanitized: they take most of the time there and run no line that others
# do not (references, further seeds and integrators, long motions), or mean nothing there.
function(resilin_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;LINK;NOT_WHEN_SANITIZED" ${ARGN})
  set(target ${name}_test)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE resilin_common_options resilin_test_options resilin_test_support ${ARG_LINK})
  resilin_sanitized_first(${target} ${ARG_LINK})
  resilin_precompile(${target} TESTS)
  resilin_unite(${target} ${ARG_ALONE})
  gtest_discover_tests(${target} TEST_PREFIX "${name}/" NO_PRETTY_VALUES DISCOVERY_MODE PRE_TEST
                       DISCOVERY_TIMEOUT 60)
  if(ARG_NOT_WHEN_SANITIZED)
    # Tests are known when ctest reads the list that gtest_discover_tests makes.
    list(JOIN ARG_NOT_WHEN_SANITIZED "]==] [==[" patterns)  # one by one: CMake takes ten groups in an expression
    set(script "${CMAKE_CURRENT_BINARY_DIR}/${target}_labels.cmake")
    file(WRITE "${script}" "foreach(test IN LISTS ${target}_TESTS)
  foreach(pattern IN ITEMS [==[${patterns}]==])
    if(test MATCHES \"\${pattern}\")
      set_tests_properties(\"\${test}\" PROPERTIES LABELS not_when_sanitized)
    endif()
  endforeach()
endforeach()
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${script}")
  endif()
endfunction()
