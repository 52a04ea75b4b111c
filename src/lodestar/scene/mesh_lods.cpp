// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/mesh_lods.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <numeric>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <lodestar/scene/lod_looks.hpp>

namespace lodestar::scene {
namespace {

namespace fs = std::filesystem;

constexpr double kGain = 0.8;            // a level must have at most this share of the triangles
constexpr std::size_t kFewest = 8;       // triangles of which no fewer are made
constexpr float kAnyError = 1e6f;        // the number of triangles is the goal, not the error
constexpr std::size_t kOpened = 300000;  // indices of which every one is looked at, at most
constexpr std::size_t kCached = 20000;   // indices from which reading is faster than building

// What a surface that is off its place counts. Pictures of one sample a pixel show an edge that is
// half a pixel off in every second pixel along it. Set together with kLight of lod_looks.cpp on
// builtin:mountains: of the pairs with which 1 px leaves a fifth of the triangles, the one whose
// picture is nearest to that of them all.
constexpr float kPlace = 1.8f;

struct Attempt {
    Indices indices;
    float error = 0;
};

bool gains(const Attempt& attempt, const Indices& before) {
    return !attempt.indices.empty() &&
           double(attempt.indices.size()) <= kGain * double(before.size());
}

const float* positionsOf(const Mesh& mesh) {
    return &mesh.vertices[0].position.x;
}

std::size_t half(const Indices& indices) {
    return (indices.size() / 3 + 1) / 2 * 3;
}

/// Locked borders stay where they are, so that meshes that meet at one (the primitives of an
/// object) still do; free ones may open a gap as wide as the error. Vertices split at a seam of
/// attributes are moved together by meshoptimizer.
enum class Borders { locked, free };
Attempt collapsed(const float* positions, std::size_t count, std::size_t stride,
                  const Indices& from, float scale, Borders borders) {
    Attempt attempt{Indices(from.size())};
    float error = 0;
    attempt.indices.resize(meshopt_simplify(
        attempt.indices.data(), from.data(), from.size(), positions, count, stride, half(from),
        kAnyError, borders == Borders::locked ? meshopt_SimplifyLockBorder : 0, &error));
    attempt.error = error * scale;
    return attempt;
}

/// Vertices at the same place and of the same colour as one, and back: each corner takes that of
/// the vertices at its place whose normal is nearest to the new face's.
class Welded {
public:
    explicit Welded(const Mesh& m) : mesh(&m), placeOf(m.vertices.size()) {
        const meshopt_Stream streams[]{
            {positionsOf(m), sizeof(glm::vec3), sizeof(Vertex)},
            {&m.vertices[0].color.x, sizeof(m.vertices[0].color), sizeof(Vertex)}};
        meshopt_generateVertexRemapMulti(placeOf.data(), m.indices.data(), m.indices.size(),
                                         m.vertices.size(), streams, std::size(streams));
        first.assign(m.vertices.size(), kNone);
        next.assign(m.vertices.size(), kNone);
        for (std::uint32_t v = static_cast<std::uint32_t>(m.vertices.size()); v-- > 0;) {
            if (placeOf[v] == ~0u) continue;  // no triangle has it
            next[v] = first[placeOf[v]];
            first[placeOf[v]] = v;
            places = std::max<std::size_t>(places, placeOf[v] + 1);
        }
        for (std::size_t place = 0; place < places; ++place)
            positions.push_back(m.vertices[first[place]].position);
    }

    Attempt collapsed(const Indices& from, float scale, Borders borders) const {
        Indices welded(from.size());
        std::transform(from.begin(), from.end(), welded.begin(),
                       [&](std::uint32_t v) { return placeOf[v]; });
        Attempt attempt =
            scene::collapsed(&positions[0].x, places, sizeof(glm::vec3), welded, scale, borders);
        for (std::size_t i = 0; i < attempt.indices.size(); i += 3) unweld(&attempt.indices[i]);
        return attempt;
    }

private:
    void unweld(std::uint32_t* triangle) const {
        const auto at = [&](int i) { return positions[triangle[i]]; };
        const glm::vec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
        std::array<std::uint32_t, 3> own;
        for (int i = 0; i < 3; ++i) {
            std::uint32_t best = first[triangle[i]];
            float bestFit = -INFINITY;
            for (std::uint32_t v = best; v != kNone; v = next[v]) {
                const float fit = glm::dot(normal, mesh->vertices[v].normal);
                if (fit > bestFit) bestFit = fit, best = v;
            }
            own[i] = best;
        }
        std::copy(own.begin(), own.end(), triangle);
    }

    const Mesh* mesh;
    Indices placeOf, first, next;  // vertices at one place as a list
    std::size_t places = 0;
    std::vector<glm::vec3> positions;
};

/// Clusters vertices. meshoptimizer's error is that of the planes; what vanishes or shrinks is not
/// in it, so the error here is how far a vertex is from the nearest that is left.
Attempt clustered(const Mesh& mesh, std::size_t target) {
    Attempt attempt{Indices(mesh.indices.size())};
    float error = 0;
    attempt.indices.resize(meshopt_simplifySloppy(
        attempt.indices.data(), mesh.indices.data(), mesh.indices.size(), positionsOf(mesh),
        mesh.vertices.size(), sizeof(Vertex), target, kAnyError, &error));
    if (attempt.indices.empty()) return attempt;
    const Nearest left(mesh, attempt.indices);
    std::vector<bool> seen(mesh.vertices.size());
    for (const std::uint32_t v : mesh.indices) {
        if (seen[v]) continue;
        seen[v] = true;
        attempt.error =
            std::max(attempt.error, std::sqrt(left.find(mesh.vertices[v].position).distance2));
    }
    return attempt;
}

bool finite(const Mesh& mesh) {
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vertex& v) {
        return std::isfinite(v.position.x) && std::isfinite(v.position.y) &&
               std::isfinite(v.position.z);
    });
}

bool textured(const Mesh& mesh, const Scene& scene) {
    const Material& m = scene.materials[mesh.material];
    for (const TextureUse* use :
         {&m.baseColorTexture, &m.normalTexture, &m.metallicRoughnessTexture, &m.occlusionTexture,
          &m.emissiveTexture})
        if (use->texture != kNone) return true;
    return false;
}

std::vector<std::byte> readFile(const fs::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) return {};
    const std::streamoff size = file.tellg();
    std::vector<std::byte> bytes(static_cast<std::size_t>(std::max<std::streamoff>(size, 0)));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()))) return {};
    return bytes;
}

/// Whole or not at all, whoever else writes it. A cache that cannot be written is no error.
void writeFile(const fs::path& path, const std::vector<std::byte>& bytes) {
    static std::atomic<unsigned> count{0};
    const auto thread = std::hash<std::thread::id>()(std::this_thread::get_id());
    fs::path draft = path;
    draft +=
        fmt::format(".{:x}.{}.{:x}.tmp", thread, count++, reinterpret_cast<std::uintptr_t>(&bytes));
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    {
        std::ofstream file(draft, std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
        if (!file) {
            fs::remove(draft, error);
            return;
        }
    }
    fs::rename(draft, path, error);
    if (error) fs::remove(draft, error);
}

MeshLods cachedLods(const Mesh& mesh, bool textured, const fs::path& folder) {
    if (folder.empty() || mesh.indices.size() < kCached) return buildMeshLods(mesh, textured);
    const fs::path path = folder / "lods" / lodCacheName(mesh, textured);
    if (const auto bytes = readFile(path); !bytes.empty())
        if (auto found = decodeLods(bytes, mesh)) return std::move(*found);
    MeshLods built = buildMeshLods(mesh, textured);
    writeFile(path, encodeLods(built));
    return built;
}

}  // namespace

const char* nameOf(LodMethod method) {
    switch (method) {
        case LodMethod::whole:
            return "whole";
        case LodMethod::simplified:
            return "simplified";
        case LodMethod::welded:
            return "welded";
        case LodMethod::opened:
            return "opened";
        case LodMethod::sloppy:
            return "sloppy";
    }
    return "";
}

fs::path userCacheFolder() {
    if (const char* given = std::getenv("XDG_CACHE_HOME"); given && *given)
        return fs::path(given) / "lodestar";
    if (const char* home = std::getenv("HOME"); home && *home)
        return fs::path(home) / ".cache" / "lodestar";
    return {};
}

MeshLods buildMeshLods(const Mesh& mesh, bool textured) {
    MeshLods lods;
    lods.levels.push_back({.meshlets = buildMeshlets(mesh)});
    if (mesh.indices.empty() || !finite(mesh)) return lods;

    const float scale =
        meshopt_simplifyScale(positionsOf(mesh), mesh.vertices.size(), sizeof(Vertex));
    const LooksError looks(mesh, textured);
    const bool weld = !textured;  // it would smear what a corner says beside normal and colour
    std::optional<Welded> welded;
    Indices now = mesh.indices;
    while (lods.levels.size() < kMaxLods && now.size() / 3 > kFewest) {
        const MeshLod& finer = lods.levels.back();
        Attempt attempt;
        LodMethod method = LodMethod::simplified;
        // Clusters have lost the borders and seams; what follows them is clustered too.
        if (finer.method != LodMethod::sloppy) {
            const auto collapse = [&](bool places, Borders borders) {
                if (places && !welded) welded.emplace(mesh);
                attempt = places ? welded->collapsed(now, scale, borders)
                                 : collapsed(positionsOf(mesh), mesh.vertices.size(),
                                             sizeof(Vertex), now, scale, borders);
                attempt.error += finer.offPlace;  // from the level before, which has its own
            };
            collapse(false, Borders::locked);
            if (!gains(attempt, now) && weld) {
                collapse(true, Borders::locked);
                method = LodMethod::welded;
            }
            // What opened once is open in all that follows.
            if (finer.method == LodMethod::opened) method = LodMethod::opened;
            for (const bool places : {false, true}) {
                if (gains(attempt, now) || (places && !weld) || mesh.indices.size() > kOpened)
                    break;
                collapse(places, Borders::free);
                method = LodMethod::opened;
            }
        }
        if (!gains(attempt, now)) {
            attempt = clustered(mesh, half(now));
            attempt.error = std::max(attempt.error, finer.offPlace);
            method = LodMethod::sloppy;
        }
        if (!gains(attempt, now) || !std::isfinite(attempt.error)) break;
        // Collapses tell a bound that adds up from level to level; where every vertex has been
        // looked at, that is known better. Parts that vanish at a free border are not in the bound.
        const LooksError::Found found = looks.of(attempt.indices, method == LodMethod::opened);
        if (method == LodMethod::opened)
            attempt.error = std::max(found.offPlace, finer.offPlace);
        else if (method != LodMethod::sloppy)
            attempt.error = std::min(attempt.error, std::max(found.offPlace, finer.offPlace));
        const float error = std::max({finer.error, kPlace * attempt.error, found.looks});
        if (!std::isfinite(error)) break;
        MeshLod lod{buildMeshlets(mesh.vertices, attempt.indices), error, attempt.error, method};
        if (lod.meshlets.meshlets.size() > finer.meshlets.meshlets.size()) break;
        lods.levels.push_back(std::move(lod));
        now = std::move(attempt.indices);
    }
    return lods;
}

std::vector<MeshLods> buildSceneLods(const Scene& scene, const LodSettings& settings,
                                     const std::function<void(int, int)>& progress) {
    const std::size_t count = scene.meshes.size();
    std::vector<MeshLods> all(count);
    // The largest first, so that none is left for one thread at the end.
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return scene.meshes[a].indices.size() > scene.meshes[b].indices.size();
    });
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::condition_variable finishedOne;
    std::size_t done = 0;
    std::exception_ptr failure;
    const auto work = [&] {
        for (std::size_t i; (i = next++) < count;) {
            const Mesh& mesh = scene.meshes[order[i]];
            try {
                // A chain holds for the shape that it was made of.
                if (settings.simplify && !mesh.deforms())
                    all[order[i]] = cachedLods(mesh, textured(mesh, scene), settings.cache);
                else
                    all[order[i]].levels.push_back({.meshlets = buildMeshlets(mesh)});
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
            }
            const std::lock_guard lock(mutex);
            ++done;
            finishedOne.notify_one();
        }
    };
    const std::size_t threads =
        std::min<std::size_t>(std::max(std::thread::hardware_concurrency(), 1u), count);
    std::vector<std::thread> pool;
    for (std::size_t i = 0; i < threads; ++i) pool.emplace_back(work);
    {
        std::unique_lock lock(mutex);
        for (std::size_t told = 0; told < count;) {
            finishedOne.wait(lock, [&] { return done > told; });
            told = done;
            lock.unlock();
            if (progress) progress(static_cast<int>(told), static_cast<int>(count));
            lock.lock();
        }
    }
    for (std::thread& thread : pool) thread.join();
    if (failure) std::rethrow_exception(failure);
    return all;
}

}  // namespace lodestar::scene
