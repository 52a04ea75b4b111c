// SPDX-License-Identifier: Apache-2.0
#include "whole_file.hpp"

#include <fstream>
#include <random>
#include <system_error>

#include <fmt/format.h>

namespace lodestar::app {
namespace {

/// In the same folder, because only a rename within one file system is atomic.
std::filesystem::path temporaryBeside(const std::filesystem::path& path) {
    std::filesystem::path temporary = path;
    temporary += fmt::format(".{:08x}.tmp", std::random_device{}());
    return temporary;
}

}  // namespace

Result<void> writeWholeFile(const std::filesystem::path& path, std::string_view bytes) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        return fail(fmt::format("{}: is a folder; name a file to write", path.string()));
    if (path.has_parent_path() && !std::filesystem::is_directory(path.parent_path(), error))
        return fail(fmt::format("{}: its folder does not exist; create it first", path.string()));
    // A device or a pipe (/dev/stdout) cannot be replaced by a rename.
    const bool inPlace =
        std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error);
    const std::filesystem::path target = inPlace ? path : temporaryBeside(path);

    std::ofstream file(target, std::ios::binary);
    if (!file)
        return fail(fmt::format("{}: cannot be written; check the permissions of its folder",
                                path.string()));
    file.write(bytes.data(), std::streamsize(bytes.size()));
    file.close();
    if (!file) {
        if (!inPlace) std::filesystem::remove(target, error);
        return fail(fmt::format("{}: writing failed; check the free disk space", path.string()));
    }
    if (inPlace) return {};
    std::filesystem::rename(target, path, error);
    if (error) {
        const std::string why = error.message();
        std::filesystem::remove(target, error);
        return fail(fmt::format("{}: cannot be replaced: {}", path.string(), why));
    }
    return {};
}

}  // namespace lodestar::app
