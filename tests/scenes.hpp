// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

/// The folder of real models: $LODESTAR_SCENES, or `shared/scenes` beside the checkout; empty when
/// there is none.
inline std::filesystem::path scenesFolder() {
    if (const char* folder = std::getenv("LODESTAR_SCENES")) return folder;
    const std::filesystem::path beside =
        std::filesystem::path(LODESTAR_SOURCE_DIR).parent_path() / "shared" / "scenes";
    return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

/// Skips the test where the models are missing, but fails it in CI, which must have them.
#define REQUIRE_SCENES()                                                                   \
    if (scenesFolder().empty()) {                                                          \
        if (std::getenv("CI")) FAIL() << "no scenes: set LODESTAR_SCENES to their folder"; \
        GTEST_SKIP() << "no scenes: set LODESTAR_SCENES to their folder";                  \
    }
