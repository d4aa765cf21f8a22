# resilin_embed(OUTPUT FILE HEADER FUNCTION): at build time, writes OUTPUT, a source that defines
# `std::span<const unsigned char> FUNCTION()` of HEADER over the bytes of FILE.
function(resilin_embed output file header function)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DFILE=${file} -DHEADER=${header} -DFUNCTION=${function}
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    DEPENDS ${file} ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    VERBATIM)
endfunction()
