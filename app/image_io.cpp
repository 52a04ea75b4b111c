// SPDX-License-Identifier: Apache-2.0
#include "image_io.hpp"

#include <fstream>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "exr.hpp"
#include "png.hpp"

namespace lodestar::app {

Result<quality::RgbImage> decodeImage(std::string_view bytes, const std::string& name) {
    if (bytes.empty()) return fail(fmt::format("{}: is empty; give a PNG or EXR picture", name));
    if (looksLikePng(bytes)) return decodePng(bytes, name);
    if (looksLikeExr(bytes)) return decodeExr(bytes, name);
    return fail(fmt::format("{}: is neither PNG nor EXR; convert it to one of these", name));
}

Result<quality::RgbImage> readImage(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::error_code error;
    if (!std::filesystem::exists(path, error))
        return fail(fmt::format("{}: no such file; check the path", name));
    if (!std::filesystem::is_regular_file(path, error))
        return fail(fmt::format("{}: is not a file; give a PNG or EXR picture", name));
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) return fail(fmt::format("{}: cannot be read: {}", name, error.message()));
    if (size > std::uintmax_t(std::numeric_limits<int>::max()))
        return fail(fmt::format("{}: is over 2 GiB; give a smaller picture", name));

    std::ifstream file(path, std::ios::binary);
    if (!file) return fail(fmt::format("{}: cannot be opened; check its permissions", name));
    std::string bytes(std::size_t(size), '\0');
    file.read(bytes.data(), std::streamsize(bytes.size()));
    if (std::size_t(file.gcount()) != bytes.size())
        return fail(fmt::format("{}: reading stopped at byte {}; is the file being written?", name,
                                file.gcount()));
    return decodeImage(bytes, name);
}

}  // namespace lodestar::app
