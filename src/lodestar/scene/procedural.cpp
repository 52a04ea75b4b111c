// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/procedural.hpp>

#include <charconv>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include <lodestar/scene/procedural_scenes.hpp>

namespace lodestar::scene {
namespace {

std::string knownNames() {
    std::string names;
    for (const Builtin& builtin : builtins())
        names += (names.empty() ? "builtin:" : ", builtin:") + builtin.usage;
    return names;
}

Result<Scene> gridOf(const std::string& spec, std::string_view count) {
    std::uint64_t triangles = 0;
    const char* end = count.data() + count.size();
    const auto [stop, status] = std::from_chars(count.data(), end, triangles);
    if (status == std::errc::invalid_argument || stop != end)
        return fail(
            fmt::format("builtin:{}: '{}' is not a whole number; give the number of "
                        "triangles, as in builtin:grid:100000",
                        spec, count));
    if (status != std::errc() || triangles < procedural::kMinGridTriangles ||
        triangles > procedural::kMaxGridTriangles)
        return fail(
            fmt::format("builtin:{}: {} triangles cannot be made; give a number from {} to {}",
                        spec, count, procedural::kMinGridTriangles, procedural::kMaxGridTriangles));
    return procedural::buildGrid(triangles);
}

}  // namespace

const std::vector<Builtin>& builtins() {
    static const std::vector<Builtin> list = {
        {"columns", "a vaulted hall of columns with railings, cables and lamps: many depth edges"},
        {"spheres", "spheres of every roughness and metallic over a checkered floor"},
        {"grid:N", "a height field of N small triangles (2 to 100000000), for scaling runs"},
    };
    return list;
}

Result<Scene> buildBuiltin(const std::string& spec) {
    if (spec == "columns") return procedural::buildColumns();
    if (spec == "spheres") return procedural::buildSpheres();
    constexpr std::string_view kGrid = "grid:";
    if (spec.starts_with(kGrid)) return gridOf(spec, std::string_view(spec).substr(kGrid.size()));
    return fail(fmt::format("builtin:{}: no such scene; there are {}", spec, knownNames()));
}

}  // namespace lodestar::scene
