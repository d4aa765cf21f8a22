include_guard(GLOBAL)

# Kernels: sources that are compiled once for each instruction set. core/simd.hpp says what such a source has to keep to;
# core/cpu.hpp chooses at run time.
#
# resilin_kernels(MODULE SOURCES a.cpp ... [OPTIONS ...] [OPTIONS_avx512 ...] [DISPATCH b.cpp]): compiles
# the sources for each instruction set, with these further options, and puts them into the library of the module. DISPATCH,
# compiled once, sees which sets there are (core/kernel_dispatch.hpp).

set(RESILIN_INSTRUCTION_SETS all CACHE STRING
  "Instruction sets of the kernels: all, native (the best one of this machine alone) or a list such as baseline,avx2")

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(known_sets baseline avx2 avx512)
else()
  set(known_sets baseline)
endif()
set(RESILIN_FLAGS_baseline)
set(RESILIN_FLAGS_avx2 -mavx2 -mfma)
set(RESILIN_FLAGS_avx512 -mavx512f -mavx512cd -mavx512dq -mavx512vl -mavx512bw -mavx2 -mfma)
set(RESILIN_WIDTH_baseline 2)
set(RESILIN_WIDTH_avx2 4)
set(RESILIN_WIDTH_avx512 8)

if(RESILIN_INSTRUCTION_SETS STREQUAL "all")
  set(RESILIN_COMPILED_SETS ${known_sets})
elseif(RESILIN_INSTRUCTION_SETS STREQUAL "native")
  # Asked at every configuration: a folder may have come from another machine.
  try_run(RESILIN_NATIVE_RUNS RESILIN_NATIVE_COMPILES ${CMAKE_BINARY_DIR}/CMakeFiles/native_instruction_set
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/native_instruction_set.cpp
    CMAKE_FLAGS -DINCLUDE_DIRECTORIES=${PROJECT_SOURCE_DIR}/src
    CXX_STANDARD 20
    RUN_OUTPUT_VARIABLE RESILIN_COMPILED_SETS)
  if(NOT RESILIN_NATIVE_COMPILES OR NOT RESILIN_NATIVE_RUNS EQUAL 0)
    message(FATAL_ERROR "RESILIN_INSTRUCTION_SETS=native needs a compiler whose programs run here; name the sets instead")
  endif()
  unset(RESILIN_NATIVE_RUNS CACHE)
  unset(RESILIN_NATIVE_COMPILES CACHE)
else()
  string(REPLACE "," ";" wanted_sets "${RESILIN_INSTRUCTION_SETS}")
  set(RESILIN_COMPILED_SETS)
  foreach(set IN LISTS known_sets)  # the slowest first, whatever the order of the list
    if(set IN_LIST wanted_sets)
      list(APPEND RESILIN_COMPILED_SETS ${set})
    endif()
  endforeach()
  list(REMOVE_ITEM wanted_sets ${known_sets})
  if(wanted_sets OR NOT RESILIN_COMPILED_SETS)
    message(FATAL_ERROR "RESILIN_INSTRUCTION_SETS is \"${RESILIN_INSTRUCTION_SETS}\": expected all, native or some of "
      "${known_sets}")
  endif()
endif()
message(STATUS "Instruction sets of the kernels: ${RESILIN_COMPILED_SETS}")

# For the sources that choose between the sets.
list(TRANSFORM RESILIN_COMPILED_SETS PREPEND "InstructionSet::" OUTPUT_VARIABLE RESILIN_DISPATCH_DEFINITION)
string(REPLACE ";" "," RESILIN_DISPATCH_DEFINITION "RESILIN_COMPILED_SETS=${RESILIN_DISPATCH_DEFINITION}")

# errno and floating-point traps would keep square roots and selections out of the lanes.
set(RESILIN_KERNEL_FLAGS -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Loops over the entries of a 3x3 matrix must be unrolled for the entries to live in registers.
  list(APPEND RESILIN_KERNEL_FLAGS --param=max-completely-peeled-insns=4000 --param=max-completely-peel-times=81
    -fno-tree-loop-distribute-patterns)
endif()

function(resilin_kernels module)
  cmake_parse_arguments(ARG "" "DISPATCH" "SOURCES;OPTIONS;OPTIONS_avx512" ${ARGN})
  foreach(set IN LISTS RESILIN_COMPILED_SETS)
    set(objects resilin_${module}_${set})
    add_library(${objects} OBJECT ${ARG_SOURCES})
    target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(${objects} PRIVATE resilin_options resilin_bounds_only)
    target_compile_definitions(${objects} PRIVATE
      RESILIN_SIMD_NAMESPACE=${set} RESILIN_SIMD_WIDTH=${RESILIN_WIDTH_${set}})
    target_compile_options(${objects} PRIVATE ${RESILIN_KERNEL_FLAGS} ${RESILIN_FLAGS_${set}}
      ${ARG_OPTIONS} ${ARG_OPTIONS_${set}})
    target_sources(resilin_${module} PRIVATE $<TARGET_OBJECTS:${objects}>)
  endforeach()
  if(ARG_DISPATCH)
    target_sources(resilin_${module} PRIVATE ${ARG_DISPATCH})
    set_source_files_properties(${ARG_DISPATCH} PROPERTIES COMPILE_DEFINITIONS "${RESILIN_DISPATCH_DEFINITION}")
  endif()
endfunction()
