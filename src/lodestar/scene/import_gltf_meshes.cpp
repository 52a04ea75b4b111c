// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/scene/import_gltf_convert.hpp>
#include <lodestar/scene/tangents.hpp>

namespace lodestar::scene::gltf {

namespace {

// Coordinates beyond this would overflow in squared lengths and in Bounds.
constexpr float kFarthest = 1e15f;

/// The attributes of one primitive, from its accessors or its Draco data.
class PrimitiveSource {
public:
    PrimitiveSource(Document& document, const Place& primitive)
        : document(document), attributes(primitive.get("attributes")) {
        if (primitive.extension("KHR_draco_mesh_compression"))
            draco = decodeDraco(document, primitive);
        if (const std::optional<Place> indices = primitive.find("indices"); indices && !draco)
            indexAccessor = indices->whole();
        if (draco) {
            vertexCount = draco->vertexCount;
        } else if (const std::optional<Place> position = attributes.find("POSITION")) {
            vertexCount = document.accessors[position->whole()].count;
        }
    }

    bool has(const std::string& name) const { return attributes.find(name).has_value(); }
    std::string place(const std::string& name) const { return attributes.get(name).path(); }
    std::size_t components(const std::string& name) const {
        return document.accessors[attributes.get(name).whole()].components;
    }
    /// `components(name)` floats a vertex.
    std::vector<float> read(const std::string& name) {
        if (draco && draco->attributes.contains(name)) return draco->attributes.at(name);
        const Place accessor = attributes.get(name);
        const std::size_t count = document.accessors[accessor.whole()].count;
        if (count != vertexCount)
            accessor.refuse(fmt::format("{} elements beside {} vertices", count, vertexCount));
        return readFloats(document, accessor.whole());
    }

    Document& document;
    Place attributes;
    std::size_t vertexCount = 0;
    std::optional<DracoPrimitive> draco;
    std::optional<std::size_t> indexAccessor;
};

template <int N>
glm::vec<N, float> at(const std::vector<float>& values, std::size_t i) {
    glm::vec<N, float> v;
    for (int c = 0; c < N; ++c) v[c] = values[i * N + static_cast<std::size_t>(c)];
    return v;
}

std::vector<Vertex> readVertices(PrimitiveSource& source) {
    const std::size_t count = source.vertexCount;
    source.document.spend(count * sizeof(Vertex), source.attributes.path());
    std::vector<Vertex> vertices(count);
    // Assigns the attribute `name` of N components, where there is one.
    const auto assign = [&]<int N>(const char* name, glm::vec<N, float> Vertex::*member) {
        if (!source.has(name)) return;
        const std::vector<float> values = source.read(name);
        for (std::size_t i = 0; i < count; ++i) vertices[i].*member = at<N>(values, i);
    };
    assign.operator()<3>("POSITION", &Vertex::position);
    assign.operator()<3>("NORMAL", &Vertex::normal);
    assign.operator()<4>("TANGENT", &Vertex::tangent);
    assign.operator()<2>("TEXCOORD_0", &Vertex::uv0);
    assign.operator()<2>("TEXCOORD_1", &Vertex::uv1);
    if (source.has("COLOR_0")) {
        const std::vector<float> values = source.read("COLOR_0");
        const bool alpha = source.components("COLOR_0") == 4;
        for (std::size_t i = 0; i < count; ++i)
            vertices[i].color =
                glm::clamp(alpha ? at<4>(values, i) : glm::vec4(at<3>(values, i), 1), 0.0f, 1.0f);
    }
    return vertices;
}

std::vector<MorphTarget> readTargets(PrimitiveSource& source, const Place& primitive) {
    std::vector<MorphTarget> targets;
    for (const Place& place : primitive.elements("targets")) {
        MorphTarget& target = targets.emplace_back();
        const auto read = [&](const char* name, std::vector<glm::vec3>& list) {
            const std::optional<Place> accessor = place.find(name);
            if (!accessor) return;
            const std::vector<float> deltas = readFloats(source.document, accessor->whole());
            if (deltas.size() != 3 * source.vertexCount)
                accessor->refuse(fmt::format("{} elements beside {} vertices", deltas.size() / 3,
                                             source.vertexCount));
            source.document.spend(source.vertexCount * sizeof(glm::vec3), accessor->path());
            list.resize(source.vertexCount);
            for (std::size_t i = 0; i < list.size(); ++i) list[i] = at<3>(deltas, i);
        };
        read("POSITION", target.position);
        // Directions that belong to none in the mesh are left out.
        if (source.has("NORMAL")) read("NORMAL", target.normal);
        if (source.has("NORMAL") && source.has("TANGENT")) read("TANGENT", target.tangent);
    }
    return targets;
}

/// Moves the vertices to where the targets have them, which are done with then.
void applyMorphTargets(const std::vector<float>& weights, Mesh& mesh) {
    for (std::size_t t = 0; t < std::min(mesh.targets.size(), weights.size()); ++t) {
        const MorphTarget& target = mesh.targets[t];
        const float weight = weights[t];
        if (weight == 0) continue;
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            Vertex& vertex = mesh.vertices[i];
            if (!target.position.empty()) vertex.position += weight * target.position[i];
            if (!target.normal.empty()) vertex.normal += weight * target.normal[i];
            if (!target.tangent.empty()) vertex.tangent += glm::vec4(weight * target.tangent[i], 0);
        }
    }
    mesh.targets.clear();
}

/// The inverse transpose of `m` but for a positive factor; exists for singular matrices too.
glm::mat3 normalMatrix(const glm::mat3& m) {
    const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                              glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

/// Fills Mesh::influences from all sets of joints: weights that are none are left out, the others
/// made to add up to 1; a vertex that nothing holds goes with the first joint.
void readInfluences(PrimitiveSource& source, std::size_t joints, Mesh& mesh) {
    std::vector<std::vector<Influence>> all(mesh.vertices.size());
    source.document.spend(mesh.vertices.size() * (sizeof all[0] + 4 * sizeof(Influence)),
                          source.attributes.path());
    for (int set = 0;; ++set) {
        const std::string jointsName = fmt::format("JOINTS_{}", set);
        const std::string weightsName = fmt::format("WEIGHTS_{}", set);
        if (!source.has(jointsName) || !source.has(weightsName)) break;
        source.document.spend(4 * mesh.vertices.size() * sizeof(Influence),
                              source.attributes.path());
        const std::vector<float> joint = source.read(jointsName), weight = source.read(weightsName);
        for (std::size_t i = 0; i < weight.size(); ++i) {
            if (!(weight[i] > 0) || std::isinf(weight[i])) continue;
            if (!(joint[i] >= 0 && joint[i] < static_cast<float>(joints)))  // Draco's, unchecked
                refuse(source.place(jointsName),
                       fmt::format("joint {} is not below the number of joints ({})", joint[i],
                                   joints));
            all[i / 4].push_back({static_cast<std::uint32_t>(joint[i]), weight[i]});
        }
    }
    std::size_t most = 1;
    for (std::vector<Influence>& of : all) {
        if (of.empty()) of.push_back({0, 1});
        double total = 0;
        for (const Influence& influence : of) total += influence.weight;
        for (Influence& influence : of)
            influence.weight = static_cast<float>(influence.weight / total);
        most = std::max(most, of.size());
    }
    source.document.spend(mesh.vertices.size() * most * sizeof(Influence),
                          source.attributes.path());
    mesh.jointsPerVertex = static_cast<std::uint32_t>(most);
    mesh.influences.assign(mesh.vertices.size() * most, {});
    for (std::size_t i = 0; i < all.size(); ++i)
        std::copy(all[i].begin(), all[i].end(),
                  mesh.influences.begin() + static_cast<std::ptrdiff_t>(i * most));
}

glm::mat4 blended(const Mesh& mesh, std::size_t vertex, const std::vector<glm::mat4>& joints) {
    glm::mat4 m(0);
    for (std::size_t k = 0; k < mesh.jointsPerVertex; ++k) {
        const Influence& influence = mesh.influences[vertex * mesh.jointsPerVertex + k];
        m += influence.weight * joints[influence.joint];
    }
    return m;
}

/// Whether the joints mirror most of the vertices.
bool mirrors(const Mesh& mesh, const std::vector<glm::mat4>& joints) {
    std::size_t mirrored = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        mirrored += glm::determinant(glm::mat3(blended(mesh, i, joints))) < 0;
    return mirrored * 2 > mesh.vertices.size();
}

/// Moves the vertices to where the joints hold them, which are done with then.
void applySkin(const std::vector<glm::mat4>& joints, Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const glm::mat4 m = blended(mesh, i, joints);
        Vertex& vertex = mesh.vertices[i];
        vertex.position = glm::vec3(m * glm::vec4(vertex.position, 1));
        vertex.normal = normalMatrix(glm::mat3(m)) * vertex.normal;
        vertex.tangent = glm::vec4(glm::mat3(m) * glm::vec3(vertex.tangent), vertex.tangent.w);
    }
    mesh.jointsPerVertex = 0;
    mesh.influences.clear();
}

/// Triangles of a primitive by its mode; nothing if it has none.
std::vector<std::uint32_t> triangulated(int mode, const std::vector<std::uint32_t>& v) {
    std::vector<std::uint32_t> triangles;
    const std::size_t n = v.size();
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        triangles.insert(triangles.end(), {v[a], v[b], v[c]});
    };
    if (mode == TINYGLTF_MODE_TRIANGLES)
        triangles.assign(v.begin(), v.end() - static_cast<std::ptrdiff_t>(n % 3));
    for (std::size_t i = 0; i + 2 < n && mode == TINYGLTF_MODE_TRIANGLE_STRIP; ++i)
        add(i, i + 1 + i % 2, i + 2 - i % 2);
    for (std::size_t i = 0; i + 2 < n && mode == TINYGLTF_MODE_TRIANGLE_FAN; ++i)
        add(i + 1, i + 2, 0);
    return triangles;
}

std::vector<std::uint32_t> readTriangles(PrimitiveSource& source, int mode) {
    if (source.draco) return source.draco->indices;
    std::vector<std::uint32_t> order;
    if (source.indexAccessor) {
        order = readUnsigned(source.document, *source.indexAccessor);
    } else {
        order.resize(source.vertexCount);
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
    }
    source.document.spend(order.size() * 3 * sizeof(std::uint32_t), source.attributes.path());
    return triangulated(mode, order);
}

void checkPositions(const PrimitiveSource& source, const std::vector<Vertex>& vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const glm::vec3 p = glm::abs(vertices[i].position);
        if (!(std::max({p.x, p.y, p.z}) <= kFarthest) || std::isnan(p.x) || std::isnan(p.y) ||
            std::isnan(p.z))
            refuse(source.place("POSITION"),
                   fmt::format("vertex {} is not finite or beyond {}", i, kFarthest));
    }
}

void completeMesh(PrimitiveSource& source, const Material& material, Mesh& mesh) {
    const std::size_t bytes = sizeof(Vertex) + mesh.jointsPerVertex * sizeof(Influence) +
                              mesh.targets.size() * 3 * sizeof(glm::vec3);
    if (!source.has("NORMAL")) {
        source.document.spend(mesh.indices.size() * bytes, source.attributes.path());
        generateFlatNormals(mesh);
    } else {
        repairNormals(mesh);
    }
    // Tangents that come without normals have to be ignored (glTF 2.0, 3.7.2.1).
    const bool ownTangents = source.has("TANGENT") && source.has("NORMAL");
    const TextureUse& normalMap = material.normalTexture;
    if (ownTangents) {
        repairTangents(mesh);
    } else if (normalMap.texture != kNone) {
        source.document.spend(mesh.vertices.size() * bytes, source.attributes.path());
        generateTangents(mesh, normalMap.uvSet, normalMap.transform);
    } else {
        for (Vertex& vertex : mesh.vertices) vertex.tangent = {1, 0, 0, 1};
    }
    for (const std::uint32_t index : mesh.indices) mesh.bounds.add(mesh.vertices[index].position);
    if (!ownTangents)
        for (MorphTarget& target : mesh.targets) target.tangent.clear();
    mesh.boundDeformation();
}

}  // namespace

std::vector<ConvertedPrimitive> convertMesh(Conversion& c, const MeshUse& use,
                                            const std::vector<glm::mat4>& jointMatrices) {
    const Place place = c.document.root().get("meshes")[use.mesh];
    const tinygltf::Mesh& meshSource = c.model.meshes[use.mesh];
    std::vector<ConvertedPrimitive> converted;
    for (std::size_t p = 0; p < meshSource.primitives.size(); ++p) {
        const Place primitive = place.get("primitives")[p];
        c.document.spend(sizeof(Mesh), primitive.path());
        const tinygltf::Primitive& header = meshSource.primitives[p];
        if (header.mode < TINYGLTF_MODE_TRIANGLES) {
            c.notes.count("{} primitives of points or lines: not drawn");
            continue;
        }
        if (!header.attributes.contains("POSITION")) {
            c.notes.count("{} primitives without positions: not drawn");
            continue;
        }
        if (header.attributes.contains("TEXCOORD_2"))
            c.notes.count("{} primitives with more than two UV sets: the others are left out");
        PrimitiveSource source(c.document, primitive);
        Mesh mesh;
        mesh.name = cleaned(meshSource.name);
        if (meshSource.primitives.size() > 1) mesh.name += fmt::format(" #{}", p);
        mesh.indices = readTriangles(source, header.mode);
        if (mesh.indices.empty()) {
            c.notes.count("{} primitives without triangles: not drawn");
            continue;
        }
        if (header.mode == TINYGLTF_MODE_TRIANGLES && !source.draco) {
            const std::size_t count = source.indexAccessor
                                          ? c.document.accessors[*source.indexAccessor].count
                                          : source.vertexCount;
            if (count % 3 != 0)
                c.notes.count("{} triangle lists end in an incomplete triangle: dropped");
        }
        mesh.vertices = readVertices(source);
        if (!header.targets.empty()) mesh.targets = readTargets(source, primitive);
        const bool skinned = use.skin && source.has("JOINTS_0") && source.has("WEIGHTS_0");
        if (skinned) readInfluences(source, jointMatrices.size(), mesh);
        const bool mirrored = skinned && mirrors(mesh, jointMatrices);
        if (!use.deforms) {
            applyMorphTargets(use.weights, mesh);
            if (skinned) applySkin(jointMatrices, mesh);
        }
        if (mirrored)
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
                std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
        checkPositions(source, mesh.vertices);

        if (header.material < 0) c.usesDefaultMaterial = true;
        mesh.material = static_cast<std::uint32_t>(header.material < 0
                                                       ? c.model.materials.size()
                                                       : static_cast<std::size_t>(header.material));
        static const Material kStandard;
        completeMesh(source, header.material < 0 ? kStandard : c.scene.materials[mesh.material],
                     mesh);
        converted.push_back({static_cast<std::uint32_t>(c.scene.meshes.size()), skinned});
        c.scene.meshes.push_back(std::move(mesh));
    }
    return converted;
}

}  // namespace lodestar::scene::gltf
