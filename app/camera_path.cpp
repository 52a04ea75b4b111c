// SPDX-License-Identifier: Apache-2.0
#include "app/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "app/cli.hpp"
#include "app/report_json.hpp"

namespace lodestar::app {
namespace {

Result<std::vector<scene::Camera>> readKeys(const std::string& name) {
    std::ifstream file(name);
    if (!file)
        return fail(
            fmt::format("'{}' is no path: give orbit, orbit:DEGREES, dolly, dolly:FRACTION "
                        "or a JSON file",
                        name));
    const Json json = Json::parse(file, nullptr, false);
    if (!json.is_array() || json.empty())
        return fail(name + ": not a JSON array of cameras with \"eye\" and \"at\"");
    std::vector<scene::Camera> keys;
    for (const Json& key : json) {
        try {
            const auto vector = [&](const char* field) {
                const Json& v = key.at(field);
                return glm::vec3(v.at(0).get<float>(), v.at(1).get<float>(), v.at(2).get<float>());
            };
            scene::Camera camera{.eye = vector("eye"), .at = vector("at")};
            camera.verticalFov =
                glm::radians(key.value("fov_deg", glm::degrees(camera.verticalFov)));
            if (camera.eye == camera.at || !(camera.verticalFov > 0 && camera.verticalFov < 3.14f))
                return fail(fmt::format("{}: camera {}: eye equals at, or fov_deg is out of range",
                                        name, keys.size()));
            keys.push_back(camera);
        } catch (const Json::exception&) {
            return fail(fmt::format("{}: camera {}: needs \"eye\" and \"at\", three numbers each",
                                    name, keys.size()));
        }
    }
    return keys;
}

}  // namespace

Result<CameraPath> parsePath(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    CameraPath path;
    if (kind != "orbit" && kind != "dolly") {
        auto keys = readKeys(text);
        if (!keys) return tl::unexpected(keys.error());
        path.kind = CameraPath::Kind::keys;
        path.keys = std::move(*keys);
        return path;
    }
    double amount = kind == "orbit" ? 360 : 0.5;
    if (colon != std::string::npos) {
        const Result<double> number = parseNumber(text.substr(colon + 1));
        if (!number) return tl::unexpected(number.error());
        amount = *number;
    }
    if (kind == "dolly" && !(amount < 1))
        return fail("dolly: the fraction of the way must be below 1");
    path.kind = kind == "orbit" ? CameraPath::Kind::orbit : CameraPath::Kind::dolly;
    path.amount = static_cast<float>(kind == "orbit" ? glm::radians(amount) : amount);
    return path;
}

scene::Camera CameraPath::at(const scene::Camera& start, std::size_t index,
                             std::size_t count) const {
    // A full turn ends one step before it would repeat its first frame.
    const bool closed =
        kind == Kind::orbit && std::abs(std::abs(amount) - glm::two_pi<float>()) < 1e-4f;
    const auto steps = static_cast<float>(std::max<std::size_t>(closed ? count : count - 1, 1));
    const float t = static_cast<float>(index) / steps;
    switch (kind) {
        case Kind::still:
            return start;
        case Kind::orbit:
            return scene::orbited(start, start.at, amount * t);
        case Kind::dolly:
            return scene::dollied(start, amount * t);
        case Kind::keys: {
            const float place = t * static_cast<float>(keys.size() - 1);
            const auto first = std::min(static_cast<std::size_t>(place), keys.size() - 1);
            const auto second = std::min(first + 1, keys.size() - 1);
            const float mix = place - static_cast<float>(first);
            scene::Camera camera = start;
            camera.eye = glm::mix(keys[first].eye, keys[second].eye, mix);
            camera.at = glm::mix(keys[first].at, keys[second].at, mix);
            camera.verticalFov = glm::mix(keys[first].verticalFov, keys[second].verticalFov, mix);
            return camera;
        }
    }
    return start;
}

}  // namespace lodestar::app
