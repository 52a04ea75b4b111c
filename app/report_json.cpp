// SPDX-License-Identifier: Apache-2.0
#include "app/report_json.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>

#include <lodestar/budget/trace.hpp>

namespace lodestar::app {

namespace {

Json orNull(const std::optional<std::string>& text) {
    return text ? Json(*text) : Json();
}

Json qualityJson(const QualityFigures& quality) {
    const bool identical = std::isinf(quality.psnrDb);
    return {{"psnr_db", identical ? Json() : Json(quality.psnrDb)},
            {"ssim", quality.ssim},
            {"flip", quality.flip},
            {"identical", identical}};
}

}  // namespace

std::vector<PassTimes> summarisePasses(const std::vector<budget::FrameCosts>& frames) {
    std::vector<std::string> order;
    std::map<std::string, std::vector<double>> times;
    for (const budget::FrameCosts& frame : frames) {
        std::map<std::string, double> sums;
        for (const budget::PassCost& pass : frame.passes) {
            if (!times.contains(pass.name)) {
                order.push_back(pass.name);
                times[pass.name];
            }
            sums[pass.name] += pass.ms;
        }
        for (const auto& [name, ms] : sums) times[name].push_back(ms);
    }
    std::vector<PassTimes> result;
    for (const std::string& name : order) {
        const std::vector<double>& values = times[name];
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        result.push_back({name, budget::median(values), *least, *most});
    }
    return result;
}

Json toJson(const Report& report) {
    Json json;
    json["lodestar"] = LODESTAR_VERSION;
    json["device"] = orNull(report.device);
    json["driver"] = orNull(report.driver);
    json["scene"] = report.scene;
    json["settings"] = report.settings;
    json["passes"] = Json::array();
    for (const PassTimes& pass : report.passes)
        json["passes"].push_back({{"name", pass.name},
                                  {"ms_median", pass.median},
                                  {"ms_min", pass.least},
                                  {"ms_max", pass.most}});
    json["frame_ms"] = report.frameMs ? Json(*report.frameMs) : Json();
    json["counts"] = report.counts;
    json["memory"] = Json::array();
    std::uint64_t sum = 0;
    for (const MemoryUse& use : report.memory) {
        json["memory"].push_back(
            {{"resource", use.resource}, {"bytes", use.bytes}, {"transient", use.transient}});
        sum += use.bytes;
    }
    json["peak_bytes"] = report.peakBytes.value_or(sum);
    if (report.quality) json["quality"] = qualityJson(*report.quality);
    for (const auto& [key, value] : report.more.items()) json[key] = value;
    return json;
}

Result<void> writeJson(const std::filesystem::path& file, const Json& json) {
    const auto bad = [&](const std::string& why) {
        return fail("cannot write '" + file.string() + "': " + why);
    };
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return bad("it is a folder; name a file in it");
    if (file.has_parent_path()) {
        std::filesystem::create_directories(file.parent_path(), error);
        if (error) return bad("its folder cannot be made (" + error.message() + ")");
    }
    std::filesystem::path partial = file;
    partial += ".part";
    {
        std::ofstream out(partial, std::ios::binary);
        // Names come from files, which may hold bytes that are no UTF-8.
        out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
        out.close();
        if (!out) {
            std::filesystem::remove(partial, error);
            return bad("check that the folder is writable and the disk is not full");
        }
    }
    std::filesystem::rename(partial, file, error);
    if (error) {
        const std::string why = error.message();
        std::filesystem::remove(partial, error);
        return bad(why);
    }
    return {};
}

}  // namespace lodestar::app
