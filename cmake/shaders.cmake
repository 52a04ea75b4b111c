# SPDX-License-Identifier: Apache-2.0
# lodestar_shaders(TARGET FILE…): compiles each GLSL file below src/lodestar to SPIR-V at build time,
# as a C array that C++ includes by the shader's own path:
#     constexpr std::uint32_t kCode[] =
#     #include <lodestar/upsample/upsample.comp.inc>
#     ;
# lodestar_shader_tree(TARGET FOLDER NAME FILE…) does it for the files below FOLDER, included as
# <NAME/FILE.inc>.
find_program(GLSLC glslc REQUIRED)

function(lodestar_shader_tree target folder name)
    set(out ${PROJECT_BINARY_DIR}/shaders)
    foreach(shader IN LISTS ARGN)
        set(inc ${out}/${name}/${shader}.inc)
        get_filename_component(inc_folder ${inc} DIRECTORY)
        file(MAKE_DIRECTORY ${inc_folder})
        add_custom_command(
            OUTPUT ${inc}
            COMMAND ${GLSLC} --target-env=vulkan1.3 -O -Werror -I ${PROJECT_SOURCE_DIR}/src -mfmt=c
                    -MD -MF ${inc}.d -o ${inc} ${folder}/${shader}
            DEPENDS ${folder}/${shader}
            DEPFILE ${inc}.d
            COMMENT "Compiling ${shader}" VERBATIM)
        target_sources(${target} PRIVATE ${inc})
    endforeach()
    target_include_directories(${target} PRIVATE ${out})
endfunction()

function(lodestar_shaders target)
    lodestar_shader_tree(${target} ${PROJECT_SOURCE_DIR}/src/lodestar lodestar ${ARGN})
endfunction()
