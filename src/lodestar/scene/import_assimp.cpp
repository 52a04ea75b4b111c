// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include <lodestar/scene/assimp_materials.hpp>
#include <lodestar/scene/assimp_nodes.hpp>
#include <lodestar/scene/assimp_plausible.hpp>
#include <lodestar/scene/import.hpp>

namespace lodestar::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t(2)
                                         << 30;  // assimp needs several times this
constexpr float kMaxCoordinate = 1e18f;          // squares of lengths stay finite
constexpr float kCreaseDegrees = 60;             // sharper edges get no common normal

constexpr unsigned kMaxCorners = 10'000;  // of one polygon: cutting it up takes their square

constexpr unsigned kSteps = aiProcess_Triangulate | aiProcess_SortByPType |
                            aiProcess_GenSmoothNormals | aiProcess_GenUVCoords |
                            aiProcess_TransformUVCoords | aiProcess_CalcTangentSpace |
                            aiProcess_JoinIdenticalVertices;

constexpr std::string_view kNoTriangles =
    "there are no triangles in it (points and lines are not drawn)";
constexpr std::string_view kNoMemory = "there is not enough memory for what it asks for";

/// Why a file is refused; ends the import.
struct Refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

std::string oneLine(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

glm::vec3 toGlm(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

bool finite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::vec3 normalizedOr(glm::vec3 v, glm::vec3 otherwise) {
    const float length = glm::length(v);
    return std::isfinite(length) && length > 0 ? v / length : otherwise;
}

float linearFromSrgb(float s) {
    const float c = std::clamp(s, 0.0f, 1.0f);
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

glm::vec2 uvAt(const aiMesh& mesh, unsigned set, unsigned i) {
    if (!mesh.HasTextureCoords(set)) return glm::vec2(0);
    const aiVector3D& uv = mesh.mTextureCoords[set][i];
    // assimp counts v from the bottom of the image.
    return std::isfinite(uv.x) && std::isfinite(uv.y) ? glm::vec2(uv.x, 1 - uv.y) : glm::vec2(0);
}

/// The file's tangent, made orthogonal; any direction in the plane where it has none.
glm::vec4 tangentAt(const aiMesh& mesh, unsigned i, glm::vec3 normal) {
    const glm::vec3 any = std::abs(normal.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 fallback = glm::normalize(any - normal * glm::dot(any, normal));
    if (!mesh.HasTangentsAndBitangents()) return {fallback, 1};
    const glm::vec3 t = toGlm(mesh.mTangents[i]);
    const glm::vec3 tangent = normalizedOr(t - normal * glm::dot(t, normal), fallback);
    const float side = glm::dot(glm::cross(normal, tangent), toGlm(mesh.mBitangents[i]));
    return {tangent, side < 0 ? -1.0f : 1.0f};
}

Vertex vertexAt(const aiMesh& mesh, unsigned i) {
    Vertex vertex;
    vertex.position = toGlm(mesh.mVertices[i]);
    vertex.normal =
        normalizedOr(mesh.HasNormals() ? toGlm(mesh.mNormals[i]) : glm::vec3(0), {0, 1, 0});
    vertex.tangent = tangentAt(mesh, i, vertex.normal);
    vertex.uv0 = uvAt(mesh, 0, i);
    // Formats number their sets as they like and assimp closes the gaps, so a material may name a
    // second set where the mesh has but one.
    vertex.uv1 = mesh.HasTextureCoords(1) ? uvAt(mesh, 1, i) : vertex.uv0;
    if (mesh.HasVertexColors(0)) {
        const aiColor4D& c = mesh.mColors[0][i];
        vertex.color = {linearFromSrgb(c.r), linearFromSrgb(c.g), linearFromSrgb(c.b),
                        std::clamp(c.a, 0.0f, 1.0f)};
        if (!finite(vertex.color) || !std::isfinite(vertex.color.a)) vertex.color = glm::vec4(1);
    }
    return vertex;
}

/// Some files wind their triangles against their own normals. What is seen goes by the winding, so
/// the normals turn around where most of the surface disagrees with them.
void turnNormalsToWinding(Mesh& mesh) {
    double agreement = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Vertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                     &c = mesh.vertices[mesh.indices[i + 2]];
        const glm::dvec3 edge1 = b.position - a.position, edge2 = c.position - a.position;
        agreement += glm::dot(glm::cross(edge1, edge2), glm::dvec3(a.normal + b.normal + c.normal));
    }
    if (agreement >= 0) return;
    for (Vertex& vertex : mesh.vertices) {
        vertex.normal = -vertex.normal;
        vertex.tangent.w = -vertex.tangent.w;  // the bitangent stays
    }
}

Mesh convertMesh(const aiMesh& from) {
    Mesh mesh;
    mesh.name = from.mName.C_Str();
    mesh.vertices.reserve(from.mNumVertices);
    for (unsigned i = 0; i < from.mNumVertices; ++i) mesh.vertices.push_back(vertexAt(from, i));
    mesh.indices.reserve(std::size_t(from.mNumFaces) * 3);
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
        const aiFace& face = from.mFaces[f];
        if (face.mNumIndices != 3) continue;  // points and lines that hide in a mixed mesh
        for (unsigned k = 0; k < 3; ++k) {
            mesh.indices.push_back(face.mIndices[k]);
            mesh.bounds.add(mesh.vertices[face.mIndices[k]].position);
        }
    }
    turnNormalsToWinding(mesh);
    return mesh;
}

void checkPositions(const aiMesh& mesh) {
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const glm::vec3 p = toGlm(mesh.mVertices[i]);
        if (!finite(p))
            throw Refusal(fmt::format("mesh '{}': the position of vertex {} is not finite",
                                      mesh.mName.C_Str(), i));
        if (glm::any(glm::greaterThan(glm::abs(p), glm::vec3(kMaxCoordinate))))
            throw Refusal(fmt::format("mesh '{}': the position of vertex {} is beyond {:g}",
                                      mesh.mName.C_Str(), i, kMaxCoordinate));
    }
}

template <typename T>
void gather(T*& values, const std::vector<unsigned>& from) {
    if (values == nullptr) return;
    T* gathered = new T[from.size()];
    for (std::size_t i = 0; i < from.size(); ++i) gathered[i] = values[from[i]];
    delete[] values;
    values = gathered;
}

/// Gives every corner a vertex of its own, as assimp's steps expect but not all of its importers
/// do: where corners share a vertex, its generated normal smooths any edge, however sharp. Meshes
/// that have normals, bones or morph targets stay as they are.
void unshareVertices(aiMesh& mesh) {
    if (mesh.HasNormals() || mesh.HasBones() || mesh.mNumAnimMeshes > 0) return;
    std::vector<unsigned> from;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        aiFace& face = mesh.mFaces[f];
        for (unsigned k = 0; k < face.mNumIndices; ++k) {
            from.push_back(face.mIndices[k]);
            face.mIndices[k] = static_cast<unsigned>(from.size() - 1);
        }
    }
    gather(mesh.mVertices, from);
    gather(mesh.mTangents, from);
    gather(mesh.mBitangents, from);
    for (aiColor4D*& colors : mesh.mColors) gather(colors, from);
    for (aiVector3D*& uvs : mesh.mTextureCoords) gather(uvs, from);
    mesh.mNumVertices = static_cast<unsigned>(from.size());
}

/// Checks what an importer made, before the steps that work on it: those trust it, and Debian
/// builds assimp with assertions that end the program.
void prepare(aiMesh& mesh) {
    checkPositions(mesh);
    unsigned kept = 0, types = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        aiFace& face = mesh.mFaces[f];
        const unsigned corners = face.mNumIndices;
        if (corners > kMaxCorners)
            throw Refusal(fmt::format("mesh '{}': face {} has {} corners; the limit is {}",
                                      mesh.mName.C_Str(), f, corners, kMaxCorners));
        for (unsigned k = 0; k < corners; ++k)
            if (face.mIndices[k] >= mesh.mNumVertices)
                throw Refusal(fmt::format("mesh '{}': face {} has vertex {} of {}",
                                          mesh.mName.C_Str(), f, face.mIndices[k],
                                          mesh.mNumVertices));
        if (corners == 0) continue;
        types |= corners == 1   ? aiPrimitiveType_POINT
                 : corners == 2 ? aiPrimitiveType_LINE
                 : corners == 3 ? aiPrimitiveType_TRIANGLE
                                : aiPrimitiveType_POLYGON;
        std::swap(mesh.mFaces[kept].mNumIndices, face.mNumIndices);
        std::swap(mesh.mFaces[kept].mIndices, face.mIndices);
        ++kept;
    }
    mesh.mNumFaces = kept;
    mesh.mPrimitiveTypes = types;
    if (kept == 0) throw Refusal(fmt::format("mesh '{}' has no faces", mesh.mName.C_Str()));
    unshareVertices(mesh);
}

class Import {
public:
    Import(const aiScene& from, const fs::path& path, std::string extension)
        : from(from), images(from, path.parent_path(), scene), extension(std::move(extension)) {
        scene.name = path.filename().string();
    }

    Scene run() {
        materials();
        meshes();
        convertNodes(from, meshOf, metresPerUnit(), scene);
        if (scene.instances.empty()) throw Refusal(std::string(kNoTriangles));
        notes();
        return std::move(scene);
    }

private:
    void materials() {
        const MaterialHabits habits{extension != ".obj"};
        for (unsigned i = 0; i < from.mNumMaterials; ++i)
            scene.materials.push_back(convertMaterial(*from.mMaterials[i], images, habits, scene));
        if (scene.materials.empty()) scene.materials.emplace_back();
    }

    void meshes() {
        meshOf.assign(from.mNumMeshes, kNone);
        for (unsigned i = 0; i < from.mNumMeshes; ++i) {
            const aiMesh& source = *from.mMeshes[i];
            if ((source.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
            Mesh mesh = convertMesh(source);
            if (mesh.indices.empty()) continue;
            if (source.mMaterialIndex >= scene.materials.size())
                throw Refusal(fmt::format("mesh '{}' has material {} of {}", mesh.name,
                                          source.mMaterialIndex, scene.materials.size()));
            mesh.material = source.HasVertexColors(0) ? forVertexColors(source.mMaterialIndex)
                                                      : source.mMaterialIndex;
            skinned += source.HasBones();
            meshOf[i] = static_cast<std::uint32_t>(scene.meshes.size());
            scene.meshes.push_back(std::move(mesh));
        }
    }

    /// assimp's stand-in for "no material" is grey, which would dim the colours of the vertices.
    std::uint32_t forVertexColors(std::uint32_t material) {
        if (scene.materials[material].name != AI_DEFAULT_MATERIAL_NAME) return material;
        if (white == kNone) {
            white = static_cast<std::uint32_t>(scene.materials.size());
            Material plain = scene.materials[material];
            plain.baseColor = glm::vec4(1);
            scene.materials.push_back(std::move(plain));
        }
        return white;
    }

    /// FBX is in centimetres times its UnitScaleFactor; the other formats are metres, or say
    /// nothing.
    float metresPerUnit() const {
        double factor = 1;
        if (extension != ".fbx") return 1;
        float single = 1;
        if (from.mMetaData && !from.mMetaData->Get("UnitScaleFactor", factor) &&
            from.mMetaData->Get("UnitScaleFactor", single))
            factor = single;
        return std::isfinite(factor) && factor > 1e-4 && factor < 1e6
                   ? static_cast<float>(factor * 0.01)
                   : 0.01f;
    }

    void notes() {
        if (skinned > 0)
            scene.notes.push_back(fmt::format("{} skinned meshes: shown in rest pose", skinned));
        if (from.mNumAnimations > 0)
            scene.notes.push_back(
                fmt::format("{} animations: not read from this format; convert it to glTF",
                            from.mNumAnimations));
    }

    const aiScene& from;
    Scene scene;
    AssimpImages images;
    std::string extension;
    std::vector<std::uint32_t> meshOf;  // assimp's mesh → ours, kNone where it has no triangles
    std::uint32_t white = kNone;
    unsigned skinned = 0;
};

void refuseImplausible(const fs::path& path, const std::string& extension, std::uintmax_t size) {
    if (extension != ".ply" && extension != ".off") return;
    std::string bytes(size, '\0');
    std::ifstream stream(path, std::ios::binary);
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(size)))
        throw Refusal("cannot be read");
    if (const auto problem = implausibleCounts(bytes, extension)) throw Refusal(*problem);
}

/// Some of assimp's messages in words that help.
std::string explained(const std::string& message) {
    for (const char* none : {"contains no faces", "No meshes remaining", "mNumMeshes is 0"})
        if (message.find(none) != message.npos) return std::string(kNoTriangles);
    if (message == "std::bad_alloc") return std::string(kNoMemory);
    return message.empty() ? "assimp failed without a message" : message;
}

Scene importOrThrow(const fs::path& path) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    Assimp::Importer importer;
    if (extension.empty() || !importer.IsExtensionSupported(extension))
        throw Refusal(
            fmt::format("{} is not a format this program reads; convert it to glTF (.glb), or "
                        "use .obj, .ply, .stl, .fbx, .dae, .3ds, .3mf, .off, .x or .x3d",
                        extension.empty() ? "a file without extension" : extension));
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path, error);
    if (error) throw Refusal(error.message());
    if (bytes > kMaxFileBytes)
        throw Refusal(
            fmt::format("{} MiB is more than the {} MiB this format is read up to; convert "
                        "it to glTF (.glb)",
                        bytes >> 20, kMaxFileBytes >> 20));
    refuseImplausible(path, extension, bytes);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCreaseDegrees);
    const std::u8string utf8 = path.u8string();
    const aiScene* imported = importer.ReadFile(reinterpret_cast<const char*>(utf8.c_str()),
                                                aiProcess_ValidateDataStructure);
    if (imported == nullptr) throw Refusal(explained(importer.GetErrorString()));
    if (imported->mRootNode == nullptr) throw Refusal("there is no scene in it");
    for (unsigned i = 0; i < imported->mNumMeshes; ++i) prepare(*imported->mMeshes[i]);
    imported = importer.ApplyPostProcessing(kSteps);
    if (imported == nullptr) throw Refusal(explained(importer.GetErrorString()));
    return Import(*imported, path, extension).run();
}

}  // namespace

Result<Scene> importAssimp(const std::filesystem::path& path) {
    const auto refuse = [&](const std::string& why) {
        return fail(path.string() + ": " + oneLine(why));
    };
    try {
        return importOrThrow(path);
    } catch (const std::bad_alloc&) {
        return refuse(std::string(kNoMemory));
    } catch (const std::exception& e) {
        return refuse(e.what());
    } catch (...) {
        return refuse("assimp failed without a message");
    }
}

}  // namespace lodestar::scene

// Debian builds assimp with its assertions on, and some of them test the file rather than the
// program: a 3MF with one flipped bit would end the whole process. assimp 5.2 calls this function
// of its own for a failed assertion, and on ELF systems the program's definition comes before a
// shared library's; thrown from here, the failure becomes the importer's ordinary error. Elsewhere
// (and with a static assimp, which would define it twice) assimp keeps its own.
#if defined(__ELF__) && !defined(LODESTAR_STATIC_ASSIMP)

namespace Assimp {

[[noreturn]] void aiAssertViolation(const char* expression, const char* file, int line);

[[noreturn]] void aiAssertViolation(const char* expression, const char* file, int line) {
    throw std::runtime_error("the file breaks a rule of assimp: " + std::string(expression) + " (" +
                             file + ", line " + std::to_string(line) + ")");
}

}  // namespace Assimp

#endif
