# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` gives: headers, libraries, and lodestarConfig.cmake for find_package.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lodestar)
set(libraries lodestar_cpu)
if(LODESTAR_VULKAN)
    list(APPEND libraries lodestar)
endif()
install(TARGETS ${libraries} EXPORT lodestarTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT lodestarTargets NAMESPACE lodestar:: DESTINATION ${package_dir})

# GLSL headers too: a host's own shaders pack what a pass reads. The importers' insides stay here.
install(DIRECTORY src/lodestar DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h" PATTERN "*.glsl"
        PATTERN "import_gltf*" EXCLUDE PATTERN "assimp_*" EXCLUDE)

configure_package_config_file(cmake/lodestarConfig.cmake.in ${PROJECT_BINARY_DIR}/lodestarConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lodestarConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lodestarConfig.cmake
              ${PROJECT_BINARY_DIR}/lodestarConfigVersion.cmake
        DESTINATION ${package_dir})
