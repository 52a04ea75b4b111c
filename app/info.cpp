// SPDX-License-Identifier: Apache-2.0
#include "app/info.hpp"

#include <memory>

#include <fmt/format.h>

#include <lodestar/gpu/device.hpp>

#include "app/cli.hpp"
#include "app/console.hpp"
#include "app/report_json.hpp"

namespace lodestar::app {
namespace {

struct Options {
    std::string device;
    std::filesystem::path json;
};

Result<void> run(const Options& options) {
    const auto devices = gpu::Device::enumerate();
    const gpu::Device device(gpu::DeviceRequest{.device = options.device});
    const gpu::DeviceDescription& chosen = device.description();

    Table list(
        {{"", Table::Align::right}, {"device"}, {"type"}, {"driver"}, {"Vulkan"}, {"verdict"}});
    Json listed = Json::array();
    for (const auto& d : devices) {
        const std::string verdict = !d.unusableBecause.empty() ? "unusable: " + d.unusableBecause
                                    : d.index == chosen.index  ? "chosen: " + device.whyChosen()
                                                               : "usable";
        list.row({std::to_string(d.index), d.name, d.type, d.driver, d.api, verdict});
        listed.push_back({{"index", d.index},
                          {"name", d.name},
                          {"type", d.type},
                          {"driver", d.driver},
                          {"api", d.api},
                          {"verdict", verdict}});
    }
    Table features({{"optional feature"}, {"here"}, {"without it"}});
    Json optional = Json::array();
    for (const auto& feature : device.optionalFeatures()) {
        features.row({feature.name, feature.present ? "yes" : "no", feature.fallback});
        optional.push_back(
            {{"name", feature.name}, {"present", feature.present}, {"fallback", feature.fallback}});
    }
    fmt::print("Vulkan devices\n{}\n{}", list.text(), features.text());
    if (options.json.empty()) return {};
    Report report{.device = chosen.name, .driver = chosen.driver};
    report.more["devices"] = listed;
    report.more["optional_features"] = optional;
    report.more["why_chosen"] = device.whyChosen();
    return writeJson(options.json, toJson(report));
}

}  // namespace

void addInfo(CLI::App& app, int& exitCode) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "info",
        "the Vulkan devices, which one is chosen and why, and what stands in for what it lacks");
    addDeviceOption(*command, options->device);
    addJsonOption(*command, options->json);
    command->callback([options, &exitCode] { exitCode = finish(run(*options)); });
}

}  // namespace lodestar::app
