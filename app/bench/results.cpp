// SPDX-License-Identifier: Apache-2.0
#include "app/bench/results.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "app/console.hpp"
#include "app/whole_file.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

/// A cell as people read it: the unit is in the key.
std::string cellText(const std::string& key, const Json& row) {
    const auto found = row.find(key);
    if (found == row.end()) return "";
    if (found->is_null()) return "–";
    if (found->is_string()) return printable(found->get<std::string>());
    const double value = found->get<double>();
    if (key.ends_with("_ms")) return formatMs(value);
    if (key.ends_with("_db")) return fmt::format("{:.1f} dB", value);
    if (key.ends_with("_bytes")) return formatBytes(static_cast<std::uint64_t>(value));
    if (key.ends_with("_share")) return fmt::format("{:.1f} %", 100 * value);
    if (found->is_number_integer()) return found->dump();
    return fmt::format("{:.{}f}", value, key == "ssim" || key == "flip" ? 4 : 2);
}

/// "edge_psnr_db" → "edge psnr": cells say the unit.
std::string headingOf(std::string key) {
    for (const char* unit : {"_ms", "_db", "_share", "_bytes"})
        if (key.ends_with(unit)) key.resize(key.rfind('_'));
    std::replace(key.begin(), key.end(), '_', ' ');
    return key;
}

std::string rowsText(const Json& rows, const std::string& measures,
                     const std::vector<std::string>& keys) {
    std::vector<Table::Column> columns;
    for (const std::string& key : keys) {
        const bool text = key == "scene" || key == "camera" || key == "method" || key == "path" ||
                          key == "size" || key == "culling" || key == "lod" || key == "capture";
        columns.push_back({headingOf(key), text ? Table::Align::left : Table::Align::right});
    }
    Table table(columns);
    for (const Json& row : rows) {
        if (row.at("measures") != measures) continue;
        std::vector<std::string> cells;
        for (const std::string& key : keys) cells.push_back(cellText(key, row));
        table.row(std::move(cells));
    }
    return fmt::format("{}\n{}", measures, table.text());
}

std::string barsText(const Json& bars) {
    Table table({{"bar"}, {"measured", Table::Align::right}, {"goal", Table::Align::right}, {""}});
    for (const Json& bar : bars) {
        const Json& value = bar.at("value");
        table.row(
            {printable(bar.at("what").get<std::string>()),
             value.is_null()
                 ? "–"
                 : fmt::format("{:.2f} {}", value.get<double>(), bar.at("unit").get<std::string>()),
             bar.at("goal").get<std::string>(), bar.at("holds").get<bool>() ? "holds" : "MISSED"});
    }
    return "bars\n" + table.text();
}

Json barsJson(const std::vector<Bar>& bars) {
    Json json = Json::array();
    for (const Bar& bar : bars)
        json.push_back({{"what", bar.what},
                        {"value", finiteOrNull(bar.value)},
                        {"unit", bar.unit},
                        {"goal", bar.goal},
                        {"holds", bar.holds}});
    return json;
}

/// What earlier runs left in the folder.
Result<Json> resultsIn(const fs::path& file) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return Json{{"benches", Json::object()}};
    std::ifstream in(file);
    Json all = Json::parse(in, nullptr, false);
    if (!all.is_object() || !all.contains("benches") || !all["benches"].is_object())
        return fail(
            fmt::format("{}: holds no results of `lodestar bench`: move it away, or give "
                        "another --out",
                        file.string()));
    return all;
}

/// A bench that was cut off may not have said it.
std::string said(const Json& one, const char* key) {
    return one.at(key).is_string() ? one.at(key).get<std::string>() : "–";
}

/// The page of results.json: bars and tables of each bench, in the order of `lodestar bench list`.
std::string pageOf(const Json& all) {
    std::string page = "# Measured\n";
    for (const Bench& bench : benches()) {
        const auto found = all.at("benches").find(bench.name);
        if (found == all.at("benches").end()) continue;
        const Json& one = *found;
        page += fmt::format(
            "\n## {}\n\n{}. {}x{}, {} rounds, on {} ({}), lodestar {}.\n\n```\n{}```\n", bench.name,
            bench.what, one.at("width").get<int>(), one.at("height").get<int>(),
            one.at("rounds").get<int>(), said(one, "device"), said(one, "driver"),
            one.at("version").get<std::string>(), resultText(bench, one));
    }
    return page;
}

}  // namespace

std::string rowText(const Bench& bench, const Json& row) {
    std::string line;
    for (const auto& [measures, keys] : bench.tables) {
        if (row.at("measures") != measures) continue;
        for (const std::string& key : keys)
            if (const std::string cell = cellText(key, row); !cell.empty())
                line += fmt::format("  {} {}", headingOf(key), cell);
    }
    return line;
}

std::string resultText(const Bench& bench, const Json& result) {
    std::string text;
    for (const auto& [measures, keys] : bench.tables)
        text += rowsText(result.at("rows"), measures, keys) + "\n";
    return text + barsText(result.at("bars"));
}

Result<Json> writeResult(const Bench& bench, BenchResult& result, const fs::path& folder) {
    Report& report = result.report;
    report.more["rows"] = result.rows;
    report.more["source"] = result.source;
    report.more["bars"] = barsJson(result.bars);
    const Json json = toJson(report);
    const fs::path stem = folder / bench.name;
    if (const auto done = writeJson(stem.string() + ".json", json); !done)
        return tl::unexpected(done.error());
    if (const auto done = writeWholeFile(stem.string() + ".csv", csvOf(result.rows)); !done)
        return tl::unexpected(done.error());

    auto earlier = resultsIn(folder / "results.json");
    if (!earlier) return tl::unexpected(earlier.error());
    Json& all = *earlier;
    all["benches"][bench.name] = {{"device", json.at("device")},
                                  {"driver", json.at("driver")},
                                  {"version", json.at("lodestar")},
                                  {"width", report.settings.at("width")},
                                  {"height", report.settings.at("height")},
                                  {"rounds", report.settings.at("rounds")},
                                  {"rows", result.rows},
                                  {"bars", json.at("bars")}};
    if (const auto done = writeJson(folder / "results.json", all); !done)
        return tl::unexpected(done.error());
    if (const auto done = writeWholeFile(folder / "results.md", pageOf(all)); !done)
        return tl::unexpected(done.error());
    return json;
}

}  // namespace lodestar::app
