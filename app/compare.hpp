// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

namespace lodestar::app {

struct CompareOptions {
    std::filesystem::path reference, test;
    std::filesystem::path out;   ///< where the FLIP map goes as a PNG; empty = nowhere
    std::filesystem::path json;  ///< where the figures go as data; empty = nowhere
};

/// Prints PSNR, SSIM and FLIP of two pictures of one size. Returns the exit code: 0, or 1 after one
/// line on stderr.
int runCompare(const CompareOptions&);

/// Registers `lodestar compare`; when it is the command given, `exitCode` (which must outlive
/// `app`'s parsing) becomes what runCompare() returned.
void addCompare(CLI::App& app, int& exitCode);

}  // namespace lodestar::app
