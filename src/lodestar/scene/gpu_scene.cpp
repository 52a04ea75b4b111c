// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/gpu_scene.hpp>

#include <algorithm>
#include <cmath>

#include <lodestar/shared/octahedral.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/displaced_meshes.hpp>
#include <lodestar/scene/gpu_materials.hpp>
#include <lodestar/scene/meshlets.hpp>
#include <lodestar/scene/texture_arrays.hpp>

namespace lodestar::scene {

using shared::GpuChunk;
using shared::GpuCluster;
using shared::GpuInstance;
using shared::GpuLight;
using shared::GpuLod;
using shared::GpuMaterialRecord;
using shared::GpuMesh;
using shared::GpuMeshlet;
using shared::GpuTriangle;
using shared::GpuVertex;
using shared::GpuVertexAttributes;

struct GpuScene::Packed {
    std::vector<GpuVertex> vertices;
    std::vector<GpuVertexAttributes> attributes;
    std::vector<glm::vec2> secondUvs;
    std::vector<GpuTriangle> triangles;
    std::vector<GpuMeshlet> meshlets;
    std::vector<std::uint32_t> meshletVertices;
    std::vector<GpuMesh> meshes;
    std::vector<GpuLod> lods;
    std::vector<GpuCluster> clusters;  // all at the finest level, after the unused one
    std::array<std::uint32_t, kDrawBins + 1> wholeBins{};
    std::vector<GpuMaterialRecord> materials;
    TextureArrays textures;
    SceneFeatures features;
    std::vector<std::uint32_t> order;
    std::vector<glm::uvec2> chunkSpans;
    std::array<std::uint32_t, kDrawBins + 1> bins{};
    std::uint64_t clustersDrawn = 0, trianglesDrawn = 0;
    std::size_t lodsMost = 1;
    DisplacedMeshes displaced;

    std::vector<std::uint32_t> meshOf;
    std::vector<Deform::Part> deforming;
    std::uint32_t firstDeformed = 0, firstDeformedMeshlet = 0;

    void addMeshes(const Scene&, const std::vector<MeshLods>&);
    void add(const Mesh&, const Material&, const MeshLods&);
    void arrange(const Scene&);
    void makePlaces();
};

namespace {

constexpr auto kWords = vk::Format::eR32G32B32A32Uint;

DrawBin binOf(const Material& material) {
    if (material.alphaMode == AlphaMode::opaque)
        return material.doubleSided ? DrawBin::opaqueDoubleSided : DrawBin::opaque;
    return material.doubleSided ? DrawBin::maskedDoubleSided : DrawBin::masked;
}

gpu::Image uploadTextures(const gpu::Device& device, const TextureArray& array, std::size_t index) {
    using Usage = vk::ImageUsageFlagBits;
    gpu::Image image(device,
                     {.name = "textures " + std::to_string(index),
                      .format = array.space == ColorSpace::srgb ? vk::Format::eR8G8B8A8Srgb
                                                                : vk::Format::eR8G8B8A8Unorm,
                      .extent = {static_cast<std::uint32_t>(array.width),
                                 static_cast<std::uint32_t>(array.height)},
                      .usage = Usage::eSampled | Usage::eTransferDst,
                      .layers = array.layers,
                      .levels = array.mipLevels,
                      .array = true});
    for (std::uint32_t level = 0; level < array.mipLevels; ++level) {
        const std::size_t begin = array.levelOffset(level);
        const std::size_t end =
            level + 1 < array.mipLevels ? array.levelOffset(level + 1) : array.texels.size();
        gpu::uploadImage(device, image, level,
                         std::as_bytes(std::span(array.texels).subspan(begin, end - begin)));
    }
    return image;
}

}  // namespace

/// The meshes, then those of instances that deform once more each: what shows the scene finds
/// their vertices in place like all others.
void GpuScene::Packed::addMeshes(const Scene& scene, const std::vector<MeshLods>& chains) {
    const auto count = static_cast<std::uint32_t>(scene.instances.size());
    std::vector<bool> shared(scene.meshes.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        const Instance& instance = scene.instances[i];
        meshOf.push_back(instance.mesh);
        if (scene::deforms(scene, instance))
            deforming.push_back({.instance = i, .firstVertex = 0});
        else
            shared[instance.mesh] = true;
    }
    const auto addOne = [&](std::uint32_t mesh) {
        add(scene.meshes[mesh], scene.materials[scene.meshes[mesh].material], chains[mesh]);
    };
    static const Mesh kNothing;
    for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
        if (shared[i] || deforming.empty())
            addOne(i);
        else
            add(kNothing, scene.materials[scene.meshes[i].material], {});
    }
    firstDeformed = static_cast<std::uint32_t>(vertices.size());
    firstDeformedMeshlet = static_cast<std::uint32_t>(meshlets.size());
    for (Deform::Part& part : deforming) {
        part.firstVertex = static_cast<std::uint32_t>(vertices.size());
        meshOf[part.instance] = static_cast<std::uint32_t>(meshes.size());
        addOne(scene.instances[part.instance].mesh);
    }
}

void GpuScene::Packed::add(const Mesh& mesh, const Material& material, const MeshLods& chain) {
    const auto number = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
    const std::uint32_t firstVertex = number(vertices.size());
    for (const Vertex& v : mesh.vertices) {
        vertices.push_back({v.position, shared::packNormal(v.normal)});
        attributes.push_back({v.uv0, shared::packTangent(v.tangent), glm::packUnorm4x8(v.color)});
        secondUvs.push_back(v.uv1);
    }
    const bool empty = mesh.bounds.empty();
    float radius = 0;
    const glm::vec3 centre = empty ? glm::vec3(0) : mesh.bounds.centre();
    for (const std::uint32_t index : mesh.indices)
        radius = std::max(radius, glm::distance(centre, mesh.vertices[index].position));
    if (mesh.displacement) radius += mesh.displacement->amplitude;
    meshes.push_back({.centre = centre,
                      .radius = radius * (1 + 1e-6f) + 1e-7f * glm::length(centre),
                      .firstLod = number(lods.size()),
                      .lodCount = number(chain.levels.size()),
                      .bin = std::uint32_t(binOf(material))});
    lodsMost = std::max(lodsMost, chain.levels.size());
    for (std::size_t level = 0; level < chain.levels.size(); ++level) {
        const MeshletSet& set = chain.levels[level].meshlets;
        lods.push_back({.firstMeshlet = number(meshlets.size()),
                        .meshletCount = number(set.meshlets.size()),
                        .error = chain.levels[level].error});
        for (const Meshlet& m : set.meshlets) {
            // A double-sided meshlet that faces away is seen from behind.
            meshlets.push_back({.centre = m.centre,
                                .radius = m.radius,
                                .coneAxis = m.coneAxis,
                                .coneCutoff = material.doubleSided ? 1.0f : m.coneCutoff,
                                .triangles = number(triangles.size()),
                                .vertices = number(meshletVertices.size()),
                                .material = mesh.material,
                                .counts = m.triangleCount |
                                          m.vertexCount << shared::LS_MESHLET_VERTICES_SHIFT |
                                          number(level) << shared::LS_MESHLET_LOD_SHIFT});
            const std::uint32_t* local = &set.vertices[m.vertexOffset];
            for (std::uint32_t i = 0; i < m.vertexCount; ++i)
                meshletVertices.push_back(firstVertex + local[i]);
            for (std::uint32_t i = 0; i < m.triangleCount; ++i) {
                const std::uint32_t t = set.triangles[m.triangleOffset + i];
                triangles.push_back({firstVertex + local[t & 255],
                                     firstVertex + local[t >> 8 & 255],
                                     firstVertex + local[t >> 16 & 255], t});
            }
        }
    }
}

/// Instances by bin, then along a Morton curve, cut into chunks: neighbours are culled together.
void GpuScene::Packed::arrange(const Scene& scene) {
    const auto count = static_cast<std::uint32_t>(scene.instances.size());
    const std::vector<glm::mat4> worldFromNodes = worldFromNode(scene);
    const Bounds box = worldBounds(scene, worldFromNodes);
    const glm::vec3 scale = 1023.0f / glm::max(box.upper - box.lower, glm::vec3(1e-20f));
    const auto spread = [](std::uint32_t v) {  // ten bits, two zeros between each
        v = (v | v << 16) & 0x30000ffu;
        v = (v | v << 8) & 0x300f00fu;
        v = (v | v << 4) & 0x30c30c3u;
        return (v | v << 2) & 0x9249249u;
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> keys(count);  // bin and place, instance
    for (std::uint32_t i = 0; i < count; ++i) {
        const Instance& instance = scene.instances[i];
        const GpuMesh& mesh = meshes[meshOf[i]];
        const glm::vec3 at(worldFromNodes[instance.node] * instance.nodeFromObject *
                           glm::vec4(mesh.centre, 1));
        const glm::vec3 cell = (at - box.lower) * scale;
        std::uint32_t key = mesh.bin << 30;
        for (int axis = 0; axis < 3; ++axis)  // a comparison with NaN fails: cell 0
            if (cell[axis] > 0)
                key |= spread(static_cast<std::uint32_t>(std::min(cell[axis], 1023.0f))) << axis;
        keys[i] = {key, i};
        const std::uint32_t level = mesh.firstLod;
        clustersDrawn += lods[level].meshletCount;
        trianglesDrawn += scene.meshes[instance.mesh].indices.size() / 3;
    }
    std::sort(keys.begin(), keys.end());
    order.resize(count);
    std::uint32_t bin = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        order[i] = keys[i].second;
        const std::uint32_t own = keys[i].first >> 30;
        const bool begins =
            chunkSpans.empty() || own != bin || chunkSpans.back().y == shared::LS_CHUNK;
        for (; bin < own; ++bin) bins[bin + 1] = static_cast<std::uint32_t>(chunkSpans.size());
        if (begins) chunkSpans.push_back({i, 0});
        ++chunkSpans.back().y;
    }
    for (; bin < kDrawBins; ++bin) bins[bin + 1] = static_cast<std::uint32_t>(chunkSpans.size());

    // In the order in which Cull lists them all.
    clusters.reserve(std::min(clustersDrawn, kMaxVisibleClusters) + 1);
    clusters.push_back({});
    wholeBins.fill(1);
    for (const std::uint32_t i : order) {
        const GpuMesh& mesh = meshes[meshOf[i]];
        const GpuLod& lod = lods[mesh.firstLod];
        for (std::uint32_t m = lod.firstMeshlet; m < lod.firstMeshlet + lod.meshletCount; ++m) {
            if (clusters.size() > kMaxVisibleClusters) break;
            clusters.push_back({.instance = i,
                                .meshlet = m,
                                .triangles = meshlets[m].triangles,
                                .material = meshlets[m].material,
                                .triangleCount = meshletTriangles(meshlets[m]),
                                .bin = mesh.bin});
        }
        for (std::size_t later = mesh.bin + 1; later <= kDrawBins; ++later)
            wholeBins[later] = static_cast<std::uint32_t>(clusters.size());
    }
}

/// Room for what displaced meshes are refined to, after everything that stays.
void GpuScene::Packed::makePlaces() {
    const std::size_t places = displaced.places;
    for (std::size_t i = 0; i < places * shared::LS_TESS_VERTICES; ++i)
        meshletVertices.push_back(static_cast<std::uint32_t>(vertices.size() + i));
    vertices.resize(vertices.size() + places * shared::LS_TESS_VERTICES);
    attributes.resize(vertices.size());
    secondUvs.resize(vertices.size());
    triangles.resize(triangles.size() + places * shared::LS_TESS_TRIANGLES);
    meshlets.resize(meshlets.size() + places);
}

namespace {

Relief makeRelief(const gpu::Device& device, const DisplacedMeshes& of, std::size_t vertices,
                  std::size_t triangles, std::size_t meshlets, std::size_t listed) {
    const auto places = static_cast<std::uint32_t>(of.places);
    constexpr auto kPair = vk::Format::eR32G32Uint;
    return {
        .displaced = gpu::makeTexelBuffer(device, "displaced instances", of.records, kWords),
        .pairs = gpu::makeTexelBuffer(device, "displaced meshlets", of.pairs, kPair),
        .refined = gpu::makeTexelBuffer(device, "refined",
                                        std::vector<shared::GpuRefined>(of.records.size()), kPair),
        .masks = gpu::makeTexelBuffer(device, "refined triangles",
                                      std::vector<glm::uvec4>(of.pairs.size()), kWords),
        .instances = static_cast<std::uint32_t>(of.records.size()),
        .pairCount = static_cast<std::uint32_t>(of.pairs.size()),
        .firstVertex = static_cast<std::uint32_t>(vertices) - places * shared::LS_TESS_VERTICES,
        .firstTriangle = static_cast<std::uint32_t>(triangles) - places * shared::LS_TESS_TRIANGLES,
        .firstMeshlet = static_cast<std::uint32_t>(meshlets) - places,
        .firstListed = static_cast<std::uint32_t>(listed) - places * shared::LS_TESS_VERTICES,
        .capacity = places};
}

}  // namespace

GpuScene::GpuScene(const gpu::Device& device, const Scene& scene,
                   const std::function<void(const char*, int, int)>& progress,
                   const LodSettings& settings)
    : GpuScene(device, scene, [&] {
          if (scene.instances.size() > shared::LS_MAX_INSTANCES)
              throw std::invalid_argument("GpuScene: more than 33,554,432 instances");
          const auto say = [&](const char* what, std::size_t done, std::size_t of) {
              if (progress) progress(what, static_cast<int>(done), static_cast<int>(of));
          };
          Packed packed;
          say("levels of detail", 0, scene.meshes.size());
          const std::vector<MeshLods> chains =
              buildSceneLods(scene, settings, [&](int done, int of) {
                  if (progress) progress("levels of detail", done, of);
              });
          packed.addMeshes(scene, chains);
          packed.arrange(scene);
          packed.displaced = findDisplaced(scene, packed.meshes, packed.lods);
          packed.makePlaces();

          say("textures", 0, scene.textures.size());
          packed.textures = buildTextureArrays(scene);
          packed.materials = packMaterials(scene, packed.textures);
          packed.features = featuresOf(packed.materials);
          for (const Light& light : scene.lights)
              packed.features.punctualLights |= light.kind != LightKind::directional;
          if (!packed.features.secondUvs) packed.secondUvs.clear();
          return packed;
      }()) {}

GpuScene::GpuScene(const gpu::Device& device, const Scene& scene, Packed&& packed)
    : vertices(gpu::makeTexelBuffer(device, "vertices", packed.vertices, kWords)),
      attributes(gpu::makeTexelBuffer(device, "attributes", packed.attributes, kWords)),
      triangles(gpu::makeTexelBuffer(device, "triangles", packed.triangles, kWords)),
      meshlets(gpu::makeTexelBuffer(device, "meshlets", packed.meshlets, kWords)),
      instances(device, "instances", scene.instances.size() * sizeof(GpuInstance), kWords),
      materials(gpu::makeTexelBuffer(device, "materials", packed.materials, kWords)),
      meshes(gpu::makeTexelBuffer(device, "meshes", packed.meshes, kWords)),
      lods(gpu::makeTexelBuffer(device, "levels of detail", packed.lods, kWords)),
      chunks(device, "chunks", packed.chunkSpans.size() * sizeof(GpuChunk), kWords),
      meshletVertices(gpu::makeTexelBuffer(device, "meshlet vertices", packed.meshletVertices,
                                           vk::Format::eR32Uint)),
      drawOrder(gpu::makeTexelBuffer(device, "draw order", packed.order, vk::Format::eR32Uint)),
      clusters(device, "visible clusters",
               3 * sizeof(GpuCluster) * (packed.clusters.size() + packed.displaced.places), kWords),
      relief(makeRelief(device, packed.displaced, packed.vertices.size(), packed.triangles.size(),
                        packed.meshlets.size(), packed.meshletVertices.size())),
      secondUvs(
          gpu::makeTexelBuffer(device, "second uvs", packed.secondUvs, vk::Format::eR32G32Sfloat)),
      lights(device, "lights", scene.lights.size() * sizeof(GpuLight)),
      source(&scene),
      sceneFeatures(packed.features),
      bins(packed.bins),
      order(std::move(packed.order)),
      displacedOf(std::move(packed.displaced.ofInstance)),
      wholeBins(packed.wholeBins),
      chunkSpans(std::move(packed.chunkSpans)),
      meshOf(std::move(packed.meshOf)),
      deformedFrom(packed.firstDeformed),
      verticesStored(relief.firstVertex),
      clustersDrawn(packed.clustersDrawn),
      trianglesDrawn(packed.trianglesDrawn),
      lodsMost(packed.lodsMost) {
    for (std::size_t i = 0; i < packed.textures.arrays.size(); ++i)
        textureArrays.push_back(uploadTextures(device, packed.textures.arrays[i], i));
    if (textureArrays.empty()) {
        const TextureArray white{
            .width = 1, .height = 1, .layers = 1, .mipLevels = 1, .texels = {255, 255, 255, 255}};
        textureArrays.push_back(uploadTextures(device, white, 0));
    }
    clusters.buffer().upload(packed.clusters);
    if (!packed.deforming.empty()) {
        const std::uint32_t first = packed.firstDeformedMeshlet;
        deform =
            std::make_unique<Deform>(device, scene, packed.deforming, first,
                                     static_cast<std::uint32_t>(packed.meshlets.size()) - first);
        packedMeshes = std::move(packed.meshes);
    }
    animate(0);
}

gpu::FrameTimes GpuScene::animate(float seconds) {
    Pose now = poseAt(*source, seconds);
    if (now == pose && changes > 0) return {};
    pose = std::move(now);
    worldBox = worldBounds(*source, pose);
    instances.buffer().upload(packInstances());
    chunks.buffer().upload(packChunks());
    const auto packedLights = packLights();
    lightsUsed = static_cast<std::uint32_t>(packedLights.size());
    lights.upload(packedLights);
    ++changes;
    if (!deform) return {};
    moveSpheres();
    return deform->run(*source, pose, {vertices, attributes, triangles, meshlets});
}

void GpuScene::moveSpheres() {
    for (std::size_t i = 0; i < meshOf.size(); ++i) {
        const Instance& instance = source->instances[i];
        if (meshOf[i] == instance.mesh) continue;
        const Bounds box = objectBounds(*source, instance, pose);
        const glm::vec3 centre = box.empty() ? glm::vec3(0) : box.centre();
        packedMeshes[meshOf[i]].centre = centre;
        packedMeshes[meshOf[i]].radius = box.radius() * (1 + 1e-5f) + 1e-6f * glm::length(centre);
    }
    meshes.buffer().upload(packedMeshes);
}

std::vector<GpuInstance> GpuScene::packInstances() const {
    std::vector<GpuInstance> packed;
    packed.reserve(source->instances.size());
    for (const Instance& instance : source->instances) {
        const glm::mat4 m = pose.worldFromNode[instance.node] * instance.nodeFromObject;
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
        const float bound =
            shear <= 1e-3f * longest * longest ? longest * 1.01f : glm::length(scale);
        packed.push_back(
            {.row0 = rows[0],
             .row1 = rows[1],
             .row2 = rows[2],
             .maxScale = bound,
             .flags =
                 (glm::determinant(linear) < 0 ? shared::LS_INSTANCE_REFLECTED : 0) |
                 (uniform && !scene::deforms(*source, instance) ? shared::LS_INSTANCE_CONE_VALID
                                                                : 0),
             .mesh = meshOf[packed.size()],
             .displaced = displacedOf.empty() ? 0 : displacedOf[packed.size()]});
    }
    return packed;
}

std::vector<GpuChunk> GpuScene::packChunks() const {
    std::vector<GpuChunk> packed;
    packed.reserve(chunkSpans.size());
    for (const glm::uvec2 span : chunkSpans) {
        Bounds box;
        for (std::uint32_t i = span.x; i < span.x + span.y; ++i) {
            const Instance& instance = source->instances[order[i]];
            box.add(objectBounds(*source, instance, pose)
                        .transformed(pose.worldFromNode[instance.node] * instance.nodeFromObject));
        }
        const glm::vec3 centre = box.empty() ? glm::vec3(0) : box.centre();
        packed.push_back({.centre = centre,
                          .radius = box.radius() * (1 + 1e-5f) + 1e-6f * glm::length(centre),
                          .first = span.x,
                          .count = span.y});
    }
    return packed;
}

std::uint32_t GpuScene::clusterCapacity() const {
    return static_cast<std::uint32_t>(std::min(clustersDrawn, kMaxVisibleClusters) + 1) +
           relief.capacity;
}

std::uint32_t GpuScene::tableStart(TablePart part) const {
    return part == TablePart::whole ? 1 : static_cast<std::uint32_t>(part) * clusterCapacity();
}

std::uint32_t GpuScene::triangleCapacity() const {
    return static_cast<std::uint32_t>(std::min(trianglesDrawn, kMaxVisibleTriangles)) +
           relief.capacity * shared::LS_TESS_TRIANGLES;
}

std::vector<GpuLight> GpuScene::packLights() const {
    std::vector<GpuLight> packed;
    for (const Light& light : source->lights) {
        if (light.kind == LightKind::directional) continue;  // becomes the sun
        const glm::mat4& m = pose.worldFromNode[light.node];
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
