// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <exception>
#include <iostream>
#include <new>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli.hpp"
#include "app/compare.hpp"
#include "app/console.hpp"
#include "app/inspect.hpp"
#ifdef LODESTAR_VULKAN
#include <lodestar/gpu/device.hpp>

#include "app/info.hpp"
#include "app/render.hpp"
#endif

namespace lodestar::app {

namespace {

void addCommands(CLI::App& app, int& exitCode) {
#ifdef LODESTAR_VULKAN
    addInfo(app, exitCode);
#endif
    addInspect(app, exitCode);
#ifdef LODESTAR_VULKAN
    addRender(app, exitCode);
#endif
    addCompare(app, exitCode);
    for (CLI::App* command : app.get_subcommands({})) command->group("Commands");
}

/// The parser's word on what was typed, made one line that says where to look further.
int usageError(const CLI::App& app, std::string message) {
    std::string command = "lodestar";
    for (const CLI::App* used : app.get_subcommands()) command += " " + used->get_name();
    printError(message + " (see " + command + " --help)");
    return kExitUsage;
}

/// A first word that names no command is best answered with the names there are.
bool isUnknownCommand(CLI::App& app, const std::string& word) {
    return !word.empty() && word.front() != '-' && app.get_subcommand_no_throw(word) == nullptr;
}

int run(int argc, char** argv) {
    int exitCode = kExitOk;
    CLI::App app("Renders a scene inside a time budget by level of detail.", "lodestar");
    app.set_version_flag("--version", "lodestar " LODESTAR_VERSION, "print the version");
    app.get_formatter()->column_width(32);
    app.get_formatter()->label("SUBCOMMAND", "COMMAND");
    app.get_formatter()->label("OPTIONS", "[options]");
    app.require_subcommand(1);
    addCommands(app, exitCode);
    app.footer(
        "Examples:\n"
#ifdef LODESTAR_VULKAN
        "  lodestar render model.glb --out frame.png\n"
        "  lodestar render model.glb --budget 50% --frames 120 --path orbit --reference --out "
        "f.png\n"
#endif
        "  lodestar inspect model.glb\n"
        "  lodestar inspect builtin:\n"
        "  lodestar compare reference.png test.png\n"
        "\n`lodestar COMMAND --help` explains a command. Exit status: 0 done, 2 bad usage, 1 any "
        "other "
        "failure.");

    if (argc > 1 && isUnknownCommand(app, argv[1])) {
        std::string names;
        for (const CLI::App* command : app.get_subcommands({}))
            names += (names.empty() ? "" : ", ") + command->get_name();
        return usageError(app, "unknown command '" + std::string(argv[1]) + "': one of " + names);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return usageError(app, error.what());
    }
    return exitCode;
}

}  // namespace

}  // namespace lodestar::app

int main(int argc, char** argv) {
    using namespace lodestar::app;
    try {
        return run(argc, argv);
    } catch (const std::bad_alloc&) {
        printError("out of memory: try a smaller scene or --size, or close other programs");
#ifdef LODESTAR_VULKAN
    } catch (const vk::OutOfDeviceMemoryError&) {
        printError("out of device memory: try a smaller scene, --size or --shadow-map");
    } catch (const vk::OutOfHostMemoryError&) {
        printError("out of memory: try a smaller scene or --size, or close other programs");
    } catch (const vk::DeviceLostError&) {
        printError(
            "the device was lost: its driver gave up on a frame; try again with a smaller --size, "
            "or another --device");
#endif
    } catch (const std::exception& error) {
        printError(error.what());
    }
    return kExitFailure;
}
