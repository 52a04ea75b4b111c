# SPDX-License-Identifier: Apache-2.0
# Installs BUILD into a new prefix under WORK, then configures, builds and runs each of EXAMPLES
# against it, as a stranger's project would be.
cmake_minimum_required(VERSION 3.25)

function(run)
    execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
foreach(example IN LISTS EXAMPLES)
    set(build ${WORK}/${example})
    run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/${example} -B ${build}
        -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${WORK}/prefix
        -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
        "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror -Wno-missing-field-initializers")
    run(${CMAKE_COMMAND} --build ${build})
    run(${build}/${example} ${build}/picture.png)
endforeach()

if(embed_upsample IN_LIST EXAMPLES AND NOT EXISTS ${WORK}/embed_upsample/picture.png)
    message(FATAL_ERROR "embed_upsample wrote no picture")
endif()
