# resilin_kernels(MODULE SOURCES a.cpp ...): compiles the sources once for each instruction set and puts them into the
# library of the module. core/simd.hpp says what such a source has to keep to; core/cpu.hpp chooses at run time.

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(RESILIN_INSTRUCTION_SETS baseline avx2 avx512)
else()
  set(RESILIN_INSTRUCTION_SETS baseline)
endif()
set(RESILIN_FLAGS_baseline)
set(RESILIN_FLAGS_avx2 -mavx2 -mfma)
set(RESILIN_FLAGS_avx512 -mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx2 -mfma)
set(RESILIN_WIDTH_baseline 2)
set(RESILIN_WIDTH_avx2 4)
set(RESILIN_WIDTH_avx512 8)

# errno and floating-point traps would keep square roots and selections out of the lanes.
set(RESILIN_KERNEL_FLAGS -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Loops over the entries of a 3x3 matrix must be unrolled for the entries to live in registers.
  list(APPEND RESILIN_KERNEL_FLAGS --param=max-completely-peeled-insns=4000 --param=max-completely-peel-times=81
    -fno-tree-loop-distribute-patterns)
endif()

# In the lanes' straight-line code, which is inlined into very large functions, two checks take minutes of compilation
# (law_kernels.cpp: 88 s for scopes and 59 s for undefined behaviour, against 7 s) and have little to find. Reads and
# writes out of bounds are checked here as everywhere.
# Linked after resilin_options, whose sanitizers these flags take back.
if(NOT TARGET resilin_kernel_options)
  add_library(resilin_kernel_options INTERFACE)
  target_compile_options(resilin_kernel_options INTERFACE
    $<$<BOOL:${RESILIN_SANITIZE}>:-fno-sanitize=undefined -fno-sanitize-address-use-after-scope>)
endif()

function(resilin_kernels module)
  cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
  foreach(set IN LISTS RESILIN_INSTRUCTION_SETS)
    set(objects resilin_${module}_${set})
    add_library(${objects} OBJECT ${ARG_SOURCES})
    target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(${objects} PRIVATE resilin_options resilin_kernel_options)
    target_compile_definitions(${objects} PRIVATE
      RESILIN_SIMD_NAMESPACE=${set} RESILIN_SIMD_WIDTH=${RESILIN_WIDTH_${set}})
    target_compile_options(${objects} PRIVATE ${RESILIN_KERNEL_FLAGS} ${RESILIN_FLAGS_${set}})
    target_sources(resilin_${module} PRIVATE $<TARGET_OBJECTS:${objects}>)
  endforeach()
endfunction()
