// SPDX-License-Identifier: Apache-2.0
#include "app/report_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <lodestar/budget/trace.hpp>

#include "app/whole_file.hpp"

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

std::string csvCell(const Json& value) {
    if (value.is_null()) return "";
    if (!value.is_string()) return value.dump();
    std::string text = value.get<std::string>();
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

}  // namespace

std::string csvOf(const Json& rows) {
    std::vector<std::string> keys;
    for (const Json& row : rows)
        for (const auto& [key, value] : row.items())
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    std::string text;
    for (const std::string& key : keys) text += (text.empty() ? "" : ",") + csvCell(Json(key));
    text += '\n';
    for (const Json& row : rows) {
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (i > 0) text += ',';
            if (const auto found = row.find(keys[i]); found != row.end()) text += csvCell(*found);
        }
        text += '\n';
    }
    return text;
}

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
    // Names come from files, which may hold bytes that are no UTF-8.
    return writeWholeFile(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace lodestar::app
