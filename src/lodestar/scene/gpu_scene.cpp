// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/gpu_scene.hpp>

#include <algorithm>
#include <cmath>

#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/meshlets.hpp>
#include <lodestar/scene/texture_arrays.hpp>
#include <lodestar/shared/octahedral.h>

namespace lodestar::scene {

using shared::GpuCluster;
using shared::GpuInstance;
using shared::GpuLight;
using shared::GpuMaterial;
using shared::GpuMeshlet;
using shared::GpuTextureUse;
using shared::GpuVertex;

struct GpuScene::Packed {
    std::vector<GpuVertex> vertices;
    std::vector<std::uint32_t> meshletVertices, meshletTriangles;
    std::vector<GpuMeshlet> meshlets;
    std::vector<GpuCluster> clusters;
    std::vector<GpuMaterial> materials;
    TextureArrays textures;
    SceneFeatures features;
    std::array<std::uint32_t, kDrawBins + 1> bins{};
    std::uint32_t triangles = 0;
};

namespace {

GpuVertex pack(const Vertex& v) {
    return {.position = v.position,
            .normal = shared::packNormal(v.normal),
            .tangent = shared::packTangent(v.tangent),
            .uv0 = v.uv0,
            .uv1 = v.uv1,
            .color = glm::packUnorm4x8(v.color)};
}

GpuTextureUse pack(const TextureUse& use, const Scene& scene, const TextureArrays& arrays) {
    GpuTextureUse packed{.array = shared::LS_NO_TEXTURE,
                         .uRow = {1, 0, 0},
                         .vRow = {0, 1, 0}};
    if (use.texture == kNone) return packed;
    const auto wrap = [](Wrap w) {
        return w == Wrap::repeat           ? shared::LS_WRAP_REPEAT
               : w == Wrap::mirroredRepeat ? shared::LS_WRAP_MIRROR
                                           : shared::LS_WRAP_CLAMP;
    };
    const Texture& texture = scene.textures[use.texture];
    const TextureSlot slot = arrays.slotOf[use.texture];
    packed.array = slot.array;
    packed.layer = slot.layer;
    packed.uRow = {use.transform[0][0], use.transform[1][0], use.transform[2][0]};
    packed.vRow = {use.transform[0][1], use.transform[1][1], use.transform[2][1]};
    const bool transformed = use.transform != glm::mat3x2(1, 0, 0, 1, 0, 0);
    packed.reading = wrap(texture.wrapU) | wrap(texture.wrapV) << 2 |
                     std::uint32_t(texture.nearest) << 4 | use.uvSet << 5 |
                     std::uint32_t(transformed) << 6;
    return packed;
}

GpuMaterial pack(const Material& m, const Scene& scene, const TextureArrays& arrays) {
    // Blended surfaces are drawn as masked ones at 0.5 until there is a pass for them.
    const bool masked = m.alphaMode != AlphaMode::opaque;
    return {.baseColor = m.baseColor,
            .emissive = m.emissive,
            .metallic = m.metallic,
            .roughness = m.roughness,
            .normalScale = m.normalScale,
            .occlusionStrength = m.occlusionStrength,
            .alphaCutoff = m.alphaMode == AlphaMode::blend ? 0.5f : m.alphaCutoff,
            .flags = (masked ? shared::LS_MATERIAL_MASK : 0) |
                     (m.doubleSided ? shared::LS_MATERIAL_DOUBLE_SIDED : 0) |
                     (m.unlit ? shared::LS_MATERIAL_UNLIT : 0),
            .baseColorTexture = pack(m.baseColorTexture, scene, arrays),
            .normalTexture = pack(m.normalTexture, scene, arrays),
            .metallicRoughnessTexture = pack(m.metallicRoughnessTexture, scene, arrays),
            .occlusionTexture = pack(m.occlusionTexture, scene, arrays),
            .emissiveTexture = pack(m.emissiveTexture, scene, arrays)};
}

SceneFeatures featuresOf(const std::vector<GpuMaterial>& materials, const TextureArrays& arrays) {
    SceneFeatures f;
    f.textureArrays = static_cast<std::uint32_t>(arrays.arrays.size());
    const auto used = [](const GpuTextureUse& use) { return use.array != shared::LS_NO_TEXTURE; };
    for (const GpuMaterial& m : materials) {
        f.normalMaps |= used(m.normalTexture);
        f.metallicRoughnessMaps |= used(m.metallicRoughnessTexture);
        f.occlusionMaps |= used(m.occlusionTexture);
        if (used(m.occlusionTexture))
            f.occlusionSharesMetallicRoughness &=
                m.occlusionTexture.array == m.metallicRoughnessTexture.array &&
                m.occlusionTexture.layer == m.metallicRoughnessTexture.layer;
        f.emissiveMaps |= used(m.emissiveTexture);
        f.emissive |= m.emissive != glm::vec3(0);
        f.unlit |= (m.flags & shared::LS_MATERIAL_UNLIT) != 0;
        f.masked |= (m.flags & shared::LS_MATERIAL_MASK) != 0;
        for (const GpuTextureUse* use :
             {&m.baseColorTexture, &m.normalTexture, &m.metallicRoughnessTexture,
              &m.occlusionTexture, &m.emissiveTexture})
            f.uvTransforms |= used(*use) && use->reading != 0;
    }
    return f;
}

DrawBin binOf(const Material& material) {
    if (material.alphaMode == AlphaMode::opaque)
        return material.doubleSided ? DrawBin::opaqueDoubleSided : DrawBin::opaque;
    return material.doubleSided ? DrawBin::maskedDoubleSided : DrawBin::masked;
}

gpu::Image uploadTextures(const gpu::Device& device, const TextureArray& array, std::size_t index) {
    using Usage = vk::ImageUsageFlagBits;
    gpu::Image image(
        device,
        {.name = "textures " + std::to_string(index),
         .format = array.space == ColorSpace::srgb ? vk::Format::eR8G8B8A8Srgb
                                                   : vk::Format::eR8G8B8A8Unorm,
         .extent = {static_cast<std::uint32_t>(array.width), static_cast<std::uint32_t>(array.height)},
         .usage = Usage::eSampled | Usage::eTransferDst,
         .layers = array.layers,
         .levels = array.mipLevels,
         .array = true});
    for (std::uint32_t level = 0; level < array.mipLevels; ++level) {
        const std::size_t begin = array.levelOffset(level);
        const std::size_t end = level + 1 < array.mipLevels ? array.levelOffset(level + 1)
                                                            : array.texels.size();
        gpu::uploadImage(device, image, level,
                         std::as_bytes(std::span(array.texels).subspan(begin, end - begin)));
    }
    return image;
}

}  // namespace

GpuScene::GpuScene(const gpu::Device& device, const Scene& scene,
                   const std::function<void(const char*, int, int)>& progress)
    : GpuScene(device, scene, [&] {
          const auto say = [&](const char* what, std::size_t done, std::size_t of) {
              if (progress) progress(what, static_cast<int>(done), static_cast<int>(of));
          };
          Packed packed;
          std::vector<std::uint32_t> firstMeshlet;
          for (const Mesh& mesh : scene.meshes) {
              say("meshlets", firstMeshlet.size(), scene.meshes.size());
              firstMeshlet.push_back(static_cast<std::uint32_t>(packed.meshlets.size()));
              const auto vertexBase = static_cast<std::uint32_t>(packed.vertices.size());
              for (const Vertex& v : mesh.vertices) packed.vertices.push_back(pack(v));
              const auto tableBase = static_cast<std::uint32_t>(packed.meshletVertices.size());
              const auto triangleBase = static_cast<std::uint32_t>(packed.meshletTriangles.size());
              const MeshletSet set = buildMeshlets(mesh);
              for (std::uint32_t v : set.vertices) packed.meshletVertices.push_back(vertexBase + v);
              packed.meshletTriangles.insert(packed.meshletTriangles.end(), set.triangles.begin(),
                                             set.triangles.end());
              for (const Meshlet& m : set.meshlets)
                  packed.meshlets.push_back({.centre = m.centre,
                                             .radius = m.radius,
                                             .coneAxis = m.coneAxis,
                                             .coneCutoff = m.coneCutoff,
                                             .vertexOffset = tableBase + m.vertexOffset,
                                             .triangleOffset = triangleBase + m.triangleOffset,
                                             .counts = m.vertexCount | m.triangleCount << 8,
                                             .material = mesh.material});
          }
          firstMeshlet.push_back(static_cast<std::uint32_t>(packed.meshlets.size()));

          packed.clusters.push_back({});
          for (std::size_t bin = 0; bin < kDrawBins; ++bin) {
              packed.bins[bin] = static_cast<std::uint32_t>(packed.clusters.size());
              for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
                  const std::uint32_t mesh = scene.instances[i].mesh;
                  if (binOf(scene.materials[scene.meshes[mesh].material]) != DrawBin(bin)) continue;
                  for (std::uint32_t m = firstMeshlet[mesh]; m < firstMeshlet[mesh + 1]; ++m) {
                      packed.clusters.push_back({.instance = i, .meshlet = m});
                      packed.triangles += packed.meshlets[m].counts >> 8;
                  }
              }
          }
          packed.bins[kDrawBins] = static_cast<std::uint32_t>(packed.clusters.size());

          say("textures", 0, scene.textures.size());
          packed.textures = buildTextureArrays(scene);
          for (const Material& m : scene.materials)
              packed.materials.push_back(pack(m, scene, packed.textures));
          packed.features = featuresOf(packed.materials, packed.textures);
          return packed;
      }()) {}

GpuScene::GpuScene(const gpu::Device& device, const Scene& scene, Packed&& packed)
    : vertices(gpu::makeBuffer(device, "vertices", packed.vertices)),
      meshletVertices(gpu::makeBuffer(device, "meshlet vertices", packed.meshletVertices)),
      meshletTriangles(gpu::makeBuffer(device, "meshlet triangles", packed.meshletTriangles)),
      meshlets(gpu::makeBuffer(device, "meshlets", packed.meshlets)),
      instances(device, "instances", scene.instances.size() * sizeof(GpuInstance)),
      clusterTable(gpu::makeBuffer(device, "clusters", packed.clusters)),
      materials(gpu::makeBuffer(device, "materials", packed.materials)),
      lights(device, "lights", scene.lights.size() * sizeof(GpuLight)),
      source(&scene),
      sceneFeatures(packed.features),
      bins(packed.bins),
      clusters(static_cast<std::uint32_t>(packed.clusters.size())),
      triangles(packed.triangles) {
    for (std::size_t i = 0; i < packed.textures.arrays.size(); ++i)
        textureArrays.push_back(uploadTextures(device, packed.textures.arrays[i], i));
    if (textureArrays.empty()) {
        const TextureArray white{.width = 1, .height = 1, .layers = 1, .mipLevels = 1,
                                 .texels = {255, 255, 255, 255}};
        textureArrays.push_back(uploadTextures(device, white, 0));
    }
    animate(0);
}

void GpuScene::animate(float seconds) {
    std::vector<glm::mat4> now = worldFromNode(*source, seconds);
    if (now == worldFromNodes) return;
    worldFromNodes = std::move(now);
    worldBox = worldBounds(*source, worldFromNodes);
    instances.upload(packInstances());
    const auto packedLights = packLights();
    lightsUsed = static_cast<std::uint32_t>(packedLights.size());
    lights.upload(packedLights);
    ++changes;
}

std::vector<GpuInstance> GpuScene::packInstances() const {
    std::vector<GpuInstance> packed;
    packed.reserve(source->instances.size());
    for (const Instance& instance : source->instances) {
        const glm::mat4 m = worldFromNodes[instance.node] * instance.nodeFromObject;
        const glm::mat4 rows = glm::transpose(m);
        const glm::vec3 scale{glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])),
                              glm::length(glm::vec3(m[2]))};
        const float longest = std::max({scale.x, scale.y, scale.z});
        const float shortest = std::min({scale.x, scale.y, scale.z});
        const glm::mat3 linear(m);
        const float shear = std::max({std::abs(glm::dot(linear[0], linear[1])),
                                      std::abs(glm::dot(linear[1], linear[2])),
                                      std::abs(glm::dot(linear[0], linear[2]))});
        const bool uniform =
            longest - shortest <= 1e-3f * longest && shear <= 1e-3f * longest * longest;
        // The largest singular value is at most the Frobenius norm, and the longest axis when the
        // axes are orthogonal.
        const float bound = shear <= 1e-3f * longest * longest ? longest * 1.01f : glm::length(scale);
        packed.push_back(
            {.row0 = rows[0],
             .row1 = rows[1],
             .row2 = rows[2],
             .maxScale = bound,
             .flags = (glm::determinant(linear) < 0 ? shared::LS_INSTANCE_REFLECTED : 0) |
                      (uniform ? shared::LS_INSTANCE_CONE_VALID : 0)});
    }
    return packed;
}

std::vector<GpuLight> GpuScene::packLights() const {
    std::vector<GpuLight> packed;
    for (const Light& light : source->lights) {
        if (light.kind == LightKind::directional) continue;  // becomes the sun
        const glm::mat4& m = worldFromNodes[light.node];
        const float inner = std::cos(light.innerCone), outer = std::cos(light.outerCone);
        const float scale = 1 / std::max(inner - outer, 1e-3f);  // KHR_lights_punctual's formula
        packed.push_back({.position = glm::vec3(m[3]),
                          .range = light.range,
                          .color = light.color * light.intensity,
                          .kind = light.kind == LightKind::point ? 1u : 2u,
                          .direction = -glm::normalize(glm::vec3(m[2])),
                          .coneScale = scale,
                          .coneOffset = -outer * scale});
    }
    return packed;
}

std::vector<gpu::View> GpuScene::textureViews() const {
    std::vector<gpu::View> views;
    for (const gpu::Image& image : textureArrays) views.push_back(image.view());
    return views;
}

}  // namespace lodestar::scene
