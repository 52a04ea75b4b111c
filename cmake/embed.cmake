# SPDX-License-Identifier: Apache-2.0
# lodestar_embed(TARGET FILE…): makes each text file a C++ string literal that C++ includes by the
# file's own path. FILEs are relative to the caller's folder, the include path to the folder above:
#     constexpr char kText[] =
#     #include <app/bench/published.json.inc>
#     ;
function(lodestar_embed target)
    cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME floor)
    set(out ${PROJECT_BINARY_DIR}/embedded)
    foreach(name IN LISTS ARGN)
        set(from ${CMAKE_CURRENT_SOURCE_DIR}/${name})
        set(inc ${out}/${floor}/${name}.inc)
        add_custom_command(
            OUTPUT ${inc}
            COMMAND ${CMAKE_COMMAND} -DFROM=${from} -DTO=${inc}
                    -P ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
            DEPENDS ${from} ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
            COMMENT "Embedding ${name}" VERBATIM)
        target_sources(${target} PRIVATE ${inc})
    endforeach()
    target_include_directories(${target} PRIVATE ${out})
endfunction()
