// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <lodestar/scene/mesh_lods.hpp>

// A chain in a file, in the byte order of the machine (the cache is its own):
//   magic u32, version u32, checksum u64 of all that follows
//   levels u32; each: error f32, off place f32, method u32, meshlets u32, vertices u32, triangles
//   u32, then these
namespace lodestar::scene {
namespace {

// Count up with every change of what buildMeshLods or buildMeshlets gives, or of the format.
constexpr std::uint32_t kVersion = 5;
constexpr std::uint32_t kMagic = 0x646f4c4c;  // "LLod"

static_assert(sizeof(Meshlet) == 48 && std::is_trivially_copyable_v<Meshlet>);
static_assert(sizeof(Vertex) == 72 && std::is_trivially_copyable_v<Vertex>);

class Writer {
public:
    template <typename T>
    void put(const T& value) {
        put(&value, 1);
    }
    template <typename T>
    void put(const T* values, std::size_t count) {
        const auto* from = reinterpret_cast<const std::byte*>(values);
        bytes.insert(bytes.end(), from, from + count * sizeof(T));
    }
    std::vector<std::byte> bytes;
};

/// Reads never go past the end; after the first that would, everything fails.
class Reader {
public:
    explicit Reader(std::span<const std::byte> from) : rest(from) {}

    template <typename T>
    bool get(T& value) {
        return get(&value, 1);
    }
    template <typename T>
    bool get(std::vector<T>& values, std::uint32_t count) {
        if (rest.size() / sizeof(T) < count) return false;  // before anything is allocated
        values.resize(count);
        return get(values.data(), count);
    }
    bool atEnd() const { return rest.empty(); }
    std::span<const std::byte> remaining() const { return rest; }

private:
    template <typename T>
    bool get(T* values, std::size_t count) {
        if (rest.size() / sizeof(T) < count) return false;
        if (count > 0) std::memcpy(values, rest.data(), count * sizeof(T));
        rest = rest.subspan(count * sizeof(T));
        return true;
    }
    std::span<const std::byte> rest;
};

bool sound(const MeshletSet& set, const Mesh& mesh) {
    for (const std::uint32_t vertex : set.vertices)
        if (vertex >= mesh.vertices.size()) return false;
    std::uint64_t triangles = 0;
    for (const Meshlet& m : set.meshlets) {
        if (m.vertexCount > kMeshletVertices || m.triangleCount > kMeshletTriangles) return false;
        if (std::uint64_t{m.vertexOffset} + m.vertexCount > set.vertices.size()) return false;
        if (m.triangleOffset != triangles) return false;
        triangles += m.triangleCount;
        if (triangles > set.triangles.size()) return false;
        for (std::uint32_t i = 0; i < m.triangleCount; ++i) {
            const std::uint32_t t = set.triangles[m.triangleOffset + i];
            if ((t & 255) >= m.vertexCount || (t >> 8 & 255) >= m.vertexCount ||
                t >> 16 >= m.vertexCount)
                return false;
        }
    }
    return triangles == set.triangles.size();
}

bool readLevel(Reader& in, const Mesh& mesh, const MeshLods& before, MeshLod& lod) {
    std::uint32_t method = 0, meshlets = 0, vertices = 0, triangles = 0;
    if (!in.get(lod.error) || !in.get(lod.offPlace) || !in.get(method) || !in.get(meshlets) ||
        !in.get(vertices) || !in.get(triangles) || !in.get(lod.meshlets.meshlets, meshlets) ||
        !in.get(lod.meshlets.vertices, vertices) || !in.get(lod.meshlets.triangles, triangles))
        return false;
    lod.method = LodMethod(method);
    if (method > std::uint32_t(LodMethod::sloppy) || !std::isfinite(lod.error) ||
        !std::isfinite(lod.offPlace) || lod.offPlace < 0 || !sound(lod.meshlets, mesh))
        return false;
    if (before.levels.empty())
        return lod.error == 0 && triangles == mesh.indices.size() / 3 &&
               lod.method == LodMethod::whole;
    const MeshLod& finer = before.levels.back();
    return lod.error >= finer.error && meshlets <= finer.meshlets.meshlets.size() &&
           triangles <= finer.meshlets.triangles.size();
}

}  // namespace

std::string lodCacheName(const Mesh& mesh, bool textured) {
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    const std::uint64_t sizes[]{kVersion, textured, mesh.vertices.size(), mesh.indices.size()};
    XXH3_128bits_update(&state, sizes, sizeof(sizes));
    XXH3_128bits_update(&state, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vertex));
    XXH3_128bits_update(&state, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
    const XXH128_hash_t hash = XXH3_128bits_digest(&state);
    return fmt::format("{:016x}{:016x}.lods", hash.high64, hash.low64);
}

std::vector<std::byte> encodeLods(const MeshLods& lods) {
    Writer body;
    body.put(static_cast<std::uint32_t>(lods.levels.size()));
    for (const MeshLod& lod : lods.levels) {
        const MeshletSet& set = lod.meshlets;
        body.put(lod.error);
        body.put(lod.offPlace);
        body.put(static_cast<std::uint32_t>(lod.method));
        body.put(static_cast<std::uint32_t>(set.meshlets.size()));
        body.put(static_cast<std::uint32_t>(set.vertices.size()));
        body.put(static_cast<std::uint32_t>(set.triangles.size()));
        body.put(set.meshlets.data(), set.meshlets.size());
        body.put(set.vertices.data(), set.vertices.size());
        body.put(set.triangles.data(), set.triangles.size());
    }
    Writer file;
    file.put(kMagic);
    file.put(kVersion);
    file.put(std::uint64_t{XXH3_64bits(body.bytes.data(), body.bytes.size())});
    file.put(body.bytes.data(), body.bytes.size());
    return std::move(file.bytes);
}

std::optional<MeshLods> decodeLods(std::span<const std::byte> bytes, const Mesh& mesh) {
    Reader in(bytes);
    std::uint32_t magic = 0, version = 0, levels = 0;
    std::uint64_t checksum = 0;
    if (!in.get(magic) || !in.get(version) || !in.get(checksum)) return std::nullopt;
    if (magic != kMagic || version != kVersion) return std::nullopt;
    if (XXH3_64bits(in.remaining().data(), in.remaining().size()) != checksum) return std::nullopt;
    if (!in.get(levels) || levels < 1 || levels > kMaxLods) return std::nullopt;
    MeshLods lods;
    for (std::uint32_t i = 0; i < levels; ++i) {
        MeshLod lod;
        if (!readLevel(in, mesh, lods, lod)) return std::nullopt;
        lods.levels.push_back(std::move(lod));
    }
    if (!in.atEnd()) return std::nullopt;
    return lods;
}

}  // namespace lodestar::scene
