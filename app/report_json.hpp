// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lodestar/budget/levers.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

using Json = nlohmann::ordered_json;

/// What one pass took over the frames of a run [ms].
struct PassTimes {
    std::string name;
    double median = 0, least = 0, most = 0;
};

/// Per-pass times over `frames`, in the order in which passes first appear. A pass that runs
/// several times in a frame counts with their sum; one that some frames lack is judged over those
/// that ran it.
std::vector<PassTimes> summarisePasses(const std::vector<budget::FrameCosts>& frames);

struct MemoryUse {
    std::string resource;
    std::uint64_t bytes = 0;
    bool transient = false;  ///< lives only within a frame
};

/// Against the full-quality frame. An infinite PSNR (identical pictures) is written as null with
/// `identical` true, JSON having no infinity.
struct QualityFigures {
    double psnrDb = 0, ssim = 0, flip = 0;
};

/// The fields that `--json` of every command has; docs and other programs rely on their names.
struct Report {
    std::optional<std::string> device, driver;  ///< none for a command that needs no device
    std::string scene;
    Json settings = Json::object();  ///< all levers and options as used
    std::vector<PassTimes> passes;
    std::optional<double> frameMs;  ///< median
    Json counts = Json::object();
    std::vector<MemoryUse> memory;
    std::optional<std::uint64_t> peakBytes;  ///< none = the sum of `memory`
    std::optional<QualityFigures> quality;
    Json more = Json::object();  ///< fields of this command alone, added at the end
};

Json toJson(const Report&);
/// Flat rows as a table with a heading line; a column for every key, in order of appearance.
std::string csvOf(const Json& rows);

/// Writes `json` to `file`, which appears whole or not at all.
Result<void> writeJson(const std::filesystem::path& file, const Json& json);

}  // namespace lodestar::app
