# SPDX-License-Identifier: Apache-2.0
# lodestar_shaders(TARGET FILE…): compiles each GLSL file to SPIR-V at build time, as a C array that
# C++ includes by the shader's own path:
#     constexpr std::uint32_t kCode[] =
#     #include <lodestar/upsample/upsample.comp.inc>
#     ;
find_program(GLSLC glslc REQUIRED)

function(lodestar_shaders target)
    set(root ${PROJECT_SOURCE_DIR}/src)
    set(out ${PROJECT_BINARY_DIR}/shaders)
    foreach(shader IN LISTS ARGN)
        set(inc ${out}/lodestar/${shader}.inc)
        get_filename_component(folder ${inc} DIRECTORY)
        file(MAKE_DIRECTORY ${folder})
        add_custom_command(
            OUTPUT ${inc}
            COMMAND ${GLSLC} --target-env=vulkan1.3 -O -Werror -I ${root} -mfmt=c
                    -MD -MF ${inc}.d -o ${inc} ${root}/lodestar/${shader}
            DEPENDS ${root}/lodestar/${shader}
            DEPFILE ${inc}.d
            COMMENT "Compiling ${shader}" VERBATIM)
        target_sources(${target} PRIVATE ${inc})
    endforeach()
    target_include_directories(${target} PRIVATE ${out})
endfunction()
