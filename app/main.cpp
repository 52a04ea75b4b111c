// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli.hpp"
#include "app/compare.hpp"
#include "app/console.hpp"
#include "app/inspect.hpp"
#ifdef LODESTAR_VULKAN
#include <lodestar/gpu/device.hpp>

#include "app/bench/bench.hpp"
#include "app/capture.hpp"
#include "app/info.hpp"
#include "app/rebuild.hpp"
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
    addCapture(app, exitCode);
    addRebuild(app, exitCode);
#endif
    addCompare(app, exitCode);
#ifdef LODESTAR_VULKAN
    addBench(app, exitCode);
#endif
    for (CLI::App* command : app.get_subcommands({})) command->group("Commands");
}

/// CLI11's help with descriptions broken at 100 columns.
class HelpFormatter : public CLI::Formatter {
public:
    HelpFormatter() {
        column_width(kNames);
        label("OPTIONS", "options");
        label("SUBCOMMAND", "COMMAND");
        label("REQUIRED", "(required)");
    }
    std::string make_option_desc(const CLI::Option* option) const override {
        std::istringstream words(option->get_description());
        std::string text, word;
        std::size_t column = 0;
        while (words >> word) {
            const bool fits = column + 1 + word.size() <= 100 - kNames;
            if (column > 0) text += fits ? ' ' : '\n';
            column = (column > 0 && fits ? column + 1 : 0) + word.size();
            text += word;
        }
        return text;
    }

private:
    static constexpr std::size_t kNames = 32;
};

/// The parser's word on what was typed, made one line that says where to look further.
int usageError(const CLI::App& app, std::string message) {
    std::string command = "lodestar";
    for (const CLI::App* used : app.get_subcommands()) command += " " + used->get_name();
    if (message.size() > 1 && std::islower(static_cast<unsigned char>(message[1])))
        message[0] = char(std::tolower(static_cast<unsigned char>(message[0])));
    printError(message + " (see " + command + " --help)");
    return kExitUsage;
}

/// The names of the commands; empty when `word` is one of them. A first word that is not is best
/// answered with what there is.
std::string commandsOtherThan(CLI::App& app, const std::string& word) {
    std::string names;
    for (const CLI::App* command : app.get_subcommands({})) {
        if (command->get_name() == word) return "";
        names += (names.empty() ? "" : ", ") + command->get_name();
    }
    return names;
}

int run(int argc, char** argv) {
    int exitCode = kExitOk;
    CLI::App app("Renders a scene inside a time budget by level of detail.", "lodestar");
    app.set_version_flag("--version", "lodestar " LODESTAR_VERSION, "print the version");
    app.set_help_flag("-h,--help", "print this help");
    app.formatter(std::make_shared<HelpFormatter>());
    app.require_subcommand(0, 1);  // that none is given is said below, after unknown options
    addCommands(app, exitCode);
    app.footer(
        "Examples:\n"
#ifdef LODESTAR_VULKAN
        "  lodestar render model.glb --out frame.png\n"
        "  lodestar render model.glb --budget 50% --frames 120 --path orbit --reference --out "
        "f.png\n"
        "  lodestar capture model.glb --out f.lvis && lodestar rebuild f.lvis model.glb --out "
        "f.png\n"
#endif
        "  lodestar inspect model.glb\n"
        "  lodestar inspect builtin:\n"
        "  lodestar compare reference.png test.png\n"
        "\n`lodestar COMMAND --help` explains a command. Exit status: 0 done, 2 bad usage, 1 any "
        "other "
        "failure.");

    const std::string word = argc > 1 ? argv[1] : "";
    if (!word.empty() && word.front() != '-')
        if (const std::string names = commandsOtherThan(app, word); !names.empty())
            return usageError(app, "unknown command '" + word + "': one of " + names);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return usageError(app, error.what());
    }
    if (app.get_subcommands().empty())
        return usageError(app, "no command given: one of " + commandsOtherThan(app, ""));
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
