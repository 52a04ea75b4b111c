# SPDX-License-Identifier: Apache-2.0
# lodestar_shaders(TARGET FILE…): compiles each GLSL file to SPIR-V at build time, as a C array that
# C++ includes by the shader's own path. FILEs are relative to the caller's folder, the include path
# to the folder above it:
#     constexpr std::uint32_t kCode[] =
#     #include <lodestar/upsample/upsample.comp.inc>
#     ;
find_program(GLSLC glslc REQUIRED)

function(lodestar_shaders target)
    cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH root)
    cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME floor)
    set(out ${PROJECT_BINARY_DIR}/shaders)
    foreach(shader IN LISTS ARGN)
        set(inc ${out}/${floor}/${shader}.inc)
        get_filename_component(folder ${inc} DIRECTORY)
        file(MAKE_DIRECTORY ${folder})
        add_custom_command(
            OUTPUT ${inc}
            COMMAND ${GLSLC} --target-env=vulkan1.3 -O -Werror -I ${PROJECT_SOURCE_DIR}/src -mfmt=c
                    -MD -MF ${inc}.d -o ${inc} ${root}/${floor}/${shader}
            DEPENDS ${root}/${floor}/${shader}
            DEPFILE ${inc}.d
            COMMENT "Compiling ${shader}" VERBATIM)
        target_sources(${target} PRIVATE ${inc})
    endforeach()
    target_include_directories(${target} PRIVATE ${out})
endfunction()
