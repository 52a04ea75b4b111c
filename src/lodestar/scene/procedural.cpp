// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/procedural.hpp>

#include <charconv>
#include <cstdint>
#include <optional>
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

/// The number after a scene's name, within its limits.
Result<std::uint64_t> numberOf(const std::string& spec, std::string_view count, const char* what,
                               std::uint64_t least, std::uint64_t most) {
    std::uint64_t number = 0;
    const char* end = count.data() + count.size();
    const auto [stop, status] = std::from_chars(count.data(), end, number);
    if (status == std::errc::invalid_argument || stop != end)
        return fail(
            fmt::format("builtin:{}: '{}' is not a whole number; give the number of {}, as in "
                        "builtin:{}100000",
                        spec, count, what, spec.substr(0, spec.find(':') + 1)));
    if (status != std::errc() || number < least || number > most)
        return fail(fmt::format("builtin:{}: {} {} cannot be made; give a number from {} to {}",
                                spec, count, what, least, most));
    return number;
}

}  // namespace

const std::vector<Builtin>& builtins() {
    static const std::vector<Builtin> list = {
        {"columns", "a vaulted hall of columns with railings, cables and lamps: many depth edges"},
        {"spheres", "spheres of every roughness and metallic over a checkered floor"},
        {"grid:N", "a height field of N small triangles (2 to 100000000), for scaling runs"},
        {"instances:N", "N objects (1 to 20000000) on a plain, of which two cameras see some"},
        {"mountains", "a mountain valley with 8000 trees and rocks"},
        {"mountains:N", "the same with N (0 to 20000000)"},
    };
    return list;
}

Result<Scene> buildBuiltin(const std::string& spec) {
    if (spec == "columns") return procedural::buildColumns();
    if (spec == "spheres") return procedural::buildSpheres();
    if (spec == "mountains") return procedural::buildMountains(procedural::kMountainObjects);
    const auto numbered = [&](std::string_view name, const char* what, std::uint64_t least,
                              std::uint64_t most, auto build) -> std::optional<Result<Scene>> {
        if (!spec.starts_with(name)) return std::nullopt;
        const auto number =
            numberOf(spec, std::string_view(spec).substr(name.size()), what, least, most);
        if (!number) return Result<Scene>(tl::unexpected(number.error()));
        return Result<Scene>(build(*number));
    };
    if (auto scene = numbered("grid:", "triangles", procedural::kMinGridTriangles,
                              procedural::kMaxGridTriangles, procedural::buildGrid))
        return std::move(*scene);
    if (auto scene = numbered("instances:", "instances", 1, procedural::kMaxInstances,
                              procedural::buildInstances))
        return std::move(*scene);
    if (auto scene = numbered("mountains:", "trees and rocks", 0, procedural::kMaxInstances,
                              procedural::buildMountains))
        return std::move(*scene);
    return fail(fmt::format("builtin:{}: no such scene; there are {}", spec, knownNames()));
}

}  // namespace lodestar::scene
