// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/assimp_nodes.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace lodestar::scene {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kDefaultAspect = 16.0f / 9;  // of a camera that has none

glm::vec3 toGlm(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

bool finite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::mat4 toGlm(const aiMatrix4x4& m) {  // assimp's rows are glm's columns
    return glm::transpose(glm::mat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2,
                                    m.c3, m.c4, m.d1, m.d2, m.d3, m.d4));
}

bool affineAndFinite(const glm::mat4& m) {
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            if (!std::isfinite(m[i][k])) return false;
    return m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1;
}

/// A transform whose −z is `forward` and whose origin is `position`.
glm::mat4 lookingAlong(glm::vec3 position, glm::vec3 forward, glm::vec3 up) {
    if (!finite(position)) position = glm::vec3(0);
    if (!finite(forward) || glm::length(forward) < 1e-6f) forward = {0, 0, -1};
    forward = glm::normalize(forward);
    if (!finite(up) || glm::length(glm::cross(forward, up)) < 1e-4f)
        up = std::abs(forward.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
    const glm::vec3 right = glm::normalize(glm::cross(forward, up));
    return {glm::vec4(right, 0), glm::vec4(glm::cross(right, forward), 0), glm::vec4(-forward, 0),
            glm::vec4(position, 1)};
}

class NodeConverter {
public:
    NodeConverter(const aiScene& from, const std::vector<std::uint32_t>& meshOf, Scene& scene)
        : from(from), meshOf(meshOf), scene(scene) {}

    void run(float metresPerUnit) {
        std::uint32_t top = kNone;
        if (metresPerUnit != 1)
            top = add("metres", kNone, glm::scale(glm::mat4(1), glm::vec3(metresPerUnit)));
        hierarchy(top);
        for (unsigned i = 0; i < from.mNumCameras; ++i) camera(*from.mCameras[i], metresPerUnit);
        for (unsigned i = 0; i < from.mNumLights; ++i) light(*from.mLights[i]);
    }

private:
    std::uint32_t add(std::string name, std::uint32_t parent, const glm::mat4& matrix) {
        Node node;
        node.name = std::move(name);
        node.parent = parent;
        node.hasMatrix = true;
        node.matrix = matrix;
        scene.nodes.push_back(std::move(node));
        return static_cast<std::uint32_t>(scene.nodes.size() - 1);
    }

    /// Parents before children, with a stack of our own: a file may be deeper than the thread's.
    void hierarchy(std::uint32_t top) {
        std::vector<std::pair<const aiNode*, std::uint32_t>> open = {{from.mRootNode, top}};
        while (!open.empty()) {
            const auto [source, parent] = open.back();
            open.pop_back();
            const std::string name = source->mName.C_Str();
            const glm::mat4 matrix = toGlm(source->mTransformation);
            if (!affineAndFinite(matrix))
                throw std::runtime_error(
                    fmt::format("node '{}': its matrix is not an affine transform", name));
            const std::uint32_t node = add(name, parent, matrix);
            named.try_emplace(name, node);
            for (unsigned i = 0; i < source->mNumMeshes; ++i) {
                const unsigned mesh = source->mMeshes[i];
                if (mesh >= meshOf.size())
                    throw std::runtime_error(
                        fmt::format("node '{}' has mesh {} of {}", name, mesh, meshOf.size()));
                if (meshOf[mesh] != kNone) scene.instances.push_back({meshOf[mesh], node});
            }
            for (unsigned i = source->mNumChildren; i-- > 0;)
                open.emplace_back(source->mChildren[i], node);
        }
    }

    /// A new node for a camera or light, under the node of the same name (or none).
    std::uint32_t attach(const std::string& name, const glm::mat4& local) {
        const auto parent = named.find(name);
        return add(name, parent == named.end() ? kNone : parent->second, local);
    }

    void camera(const aiCamera& source, float metresPerUnit) {
        SceneCamera camera;
        camera.name = source.mName.C_Str();
        camera.node = attach(camera.name, lookingAlong(toGlm(source.mPosition),
                                                       toGlm(source.mLookAt), toGlm(source.mUp)));
        const float aspect = std::isfinite(source.mAspect) && source.mAspect > 0.01f
                                 ? source.mAspect
                                 : kDefaultAspect;
        // The documentation says half of the angle, but the importers give the whole one.
        const float horizontal = source.mHorizontalFOV;
        if (std::isfinite(horizontal) && horizontal > 0.01f && horizontal < kPi - 0.01f)
            camera.verticalFov = 2 * std::atan(std::tan(0.5f * horizontal) / aspect);
        const float nearPlane = source.mClipPlaneNear * metresPerUnit;
        if (std::isfinite(nearPlane) && nearPlane > 0) camera.nearPlane = nearPlane;
        scene.cameras.push_back(std::move(camera));
    }

    void light(const aiLight& source) {
        Light light;
        light.name = source.mName.C_Str();
        switch (source.mType) {
            case aiLightSource_DIRECTIONAL:
                light.kind = LightKind::directional;
                break;
            case aiLightSource_POINT:
                light.kind = LightKind::point;
                break;
            case aiLightSource_SPOT:
                light.kind = LightKind::spot;
                break;
            default:
                scene.notes.push_back(
                    fmt::format("light '{}': ambient and area lights are not drawn", light.name));
                return;
        }
        glm::vec3 color(source.mColorDiffuse.r, source.mColorDiffuse.g, source.mColorDiffuse.b);
        if (!finite(color)) color = glm::vec3(1);
        color = glm::max(color, glm::vec3(0));
        const float brightest = std::max({color.x, color.y, color.z});
        if (brightest <= 0) return;
        light.color = color / brightest;
        // These formats count in "1 = a white surface facing the light is white": π lux. A point
        // light's falloff becomes the inverse square that agrees with it one unit away.
        light.intensity = brightest * kPi;
        if (light.kind != LightKind::directional) {
            const float fade = source.mAttenuationConstant + source.mAttenuationLinear +
                               source.mAttenuationQuadratic;
            if (std::isfinite(fade) && fade > 1e-3f) light.intensity /= fade;
        }
        if (light.kind == LightKind::spot) {
            const float outer = 0.5f * source.mAngleOuterCone,
                        inner = 0.5f * source.mAngleInnerCone;
            light.outerCone =
                std::isfinite(outer) ? std::clamp(outer, 0.01f, 0.5f * kPi) : 0.25f * kPi;
            light.innerCone =
                std::isfinite(inner) ? std::clamp(inner, 0.0f, light.outerCone - 0.005f) : 0;
        }
        light.node = attach(light.name, lookingAlong(toGlm(source.mPosition),
                                                     toGlm(source.mDirection), toGlm(source.mUp)));
        scene.lights.push_back(std::move(light));
    }

    const aiScene& from;
    const std::vector<std::uint32_t>& meshOf;
    Scene& scene;
    std::unordered_map<std::string, std::uint32_t> named;
};

}  // namespace

void convertNodes(const aiScene& from, const std::vector<std::uint32_t>& meshOf,
                  float metresPerUnit, Scene& scene) {
    NodeConverter(from, meshOf, scene).run(metresPerUnit);
}

}  // namespace lodestar::scene
