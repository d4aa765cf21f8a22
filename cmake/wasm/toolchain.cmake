# The compiler of WebAssembly: that of the Python package ziglang (scripts/setup.sh fetches it), which brings clang, lld, a libc and the
# sources of libc++. Its own libc++ knows neither exceptions nor mutexes: cmake/wasm/CMakeLists.txt makes one from the sources.

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)

set(RESILIN_ZIG "$ENV{RESILIN_ZIG}" CACHE FILEPATH "The program zig of the package ziglang")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES RESILIN_ZIG)
if(NOT RESILIN_ZIG)
  message(FATAL_ERROR "RESILIN_ZIG: expected the program zig of the Python package ziglang, got nothing; run scripts/build_wasm.sh")
endif()
get_filename_component(RESILIN_ZIG_FOLDER "${RESILIN_ZIG}" DIRECTORY)

foreach(language C CXX)
  set(CMAKE_${language}_COMPILER_TARGET wasm32-wasi)
  set(CMAKE_${language}_ARCHIVE_CREATE "\"${RESILIN_ZIG}\" ar qc <TARGET> <OBJECTS>")
  set(CMAKE_${language}_ARCHIVE_APPEND "\"${RESILIN_ZIG}\" ar q <TARGET> <OBJECTS>")
  set(CMAKE_${language}_ARCHIVE_FINISH "\"${RESILIN_ZIG}\" ranlib <TARGET>")
  # Exceptions and lanes of 128 bits as every browser has had them since 2022 (Chrome 95, Firefox 100, Safari 16.4).
  set(CMAKE_${language}_FLAGS_INIT
    "-mcpu=generic+simd128+exception_handling+bulk_memory+sign_ext+nontrapping_fptoint+mutable_globals -fwasm-exceptions -mllvm -wasm-enable-eh")
endforeach()
set(CMAKE_C_COMPILER "${RESILIN_ZIG}" cc)
set(CMAKE_CXX_COMPILER "${RESILIN_ZIG}" c++)
string(APPEND CMAKE_CXX_FLAGS_INIT " -U_LIBCPP_HAS_THREADS -D_LIBCPP_HAS_THREADS=1 -D_LIBCPP_HAS_THREAD_API_EXTERNAL=1"
  " -U_LIBCPP_HAS_FILESYSTEM -D_LIBCPP_HAS_FILESYSTEM=1 -isystem \"${CMAKE_CURRENT_LIST_DIR}/include\"")

set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
