// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lodestar/scene/import_gltf_place.hpp>

/// The glTF importer's inside: bytes → Document (read, then vetted) → Scene.
namespace lodestar::scene::gltf {

using Bytes = std::span<const std::uint8_t>;

enum ComponentType : std::uint32_t {
    kByte = 5120,
    kUnsignedByte = 5121,
    kShort = 5122,
    kUnsignedShort = 5123,
    kUnsignedInt = 5125,
    kFloat = 5126,
};

/// Part of EXT_meshopt_compression: where a view's bytes come from instead.
struct Compression {
    std::size_t buffer = 0, offset = 0, length = 0, stride = 0, count = 0;
    enum class Mode { attributes, triangles, indices } mode = Mode::attributes;
    enum class Filter { none, octahedral, quaternion, exponential } filter = Filter::none;
};

struct BufferView {
    std::size_t buffer = 0, offset = 0, length = 0;
    std::size_t stride = 0;  ///< 0 = elements are packed
    std::optional<Compression> compression;
    std::vector<std::uint8_t> decoded;  ///< of a compressed view, once it has been read
};

struct Sparse {
    std::size_t count = 0;
    std::size_t indicesView = 0, indicesOffset = 0;
    std::uint32_t indicesType = 0;
    std::size_t valuesView = 0, valuesOffset = 0;
};

/// An accessor that has been found to lie within its view.
struct Accessor {
    std::optional<std::size_t> view;  ///< none = zeros
    std::size_t offset = 0, count = 0, stride = 0;
    std::uint32_t componentType = kFloat;
    std::string type;              ///< "VEC3"
    std::size_t components = 1;    ///< of an element
    std::size_t elementBytes = 4;  ///< with the padding of matrix columns
    std::size_t lastBytes = 4;     ///< of the last element, which may end without padding
    bool normalized = false;
    std::optional<Sparse> sparse;
};

struct Document {
    Json json;
    std::filesystem::path folder;  ///< of the files it may refer to; empty = none
    /// One a buffer; empty where the file gives none (a meshopt fallback, or a missing GLB chunk).
    std::vector<std::vector<std::uint8_t>> buffers;
    std::vector<BufferView> views;
    std::vector<Accessor> accessors;
    /// Bytes of all files read: what the import may spend depends on it.
    std::uint64_t fileBytes = 0;
    std::uint64_t budget = 0;                   ///< bytes that may still be produced
    std::set<std::filesystem::path> filesRead;  ///< a file counts once, however often it is named

    Place root() const { return Place(json, ""); }
    /// Takes `bytes` of the budget. References are cheap to write and costly to follow (a thousand
    /// primitives of one accessor), so all that is read or made is charged against the file's size.
    void spend(std::uint64_t bytes, const std::string& place);
    void addFileBytes(std::uint64_t bytes);
};

/// Extensions that are read. A file may require these and no others.
bool isSupported(std::string_view extension);

/// Splits the container and parses its JSON; loads all buffers.
Document readDocument(Bytes file, const std::filesystem::path& folder);

/// The whole file, if it is a regular file of at most `most` bytes; refuses otherwise.
std::vector<std::uint8_t> readFile(const std::filesystem::path&, std::uint64_t most,
                                   const std::string& place);

/// Checks the form of a URI without reading what it names: a sound data URI, or a relative path
/// that stays below the folder.
void checkUri(const Place& uri);
/// The bytes a URI names: `least` at least, and no more than `most` of them.
std::vector<std::uint8_t> readUri(Document&, const Place& uri, std::uint64_t least,
                                  std::uint64_t most);

/// Fills Document::views and ::accessors and refuses the document wherever an index, size, offset
/// or hierarchy is not true, or something it requires is not supported.
void validate(Document&);
/// The parts of validate().
void validateViewsAndAccessors(Document&);
void validateMeshes(Document&);
void validateMaterials(const Document&);
void validateNodes(const Document&);
void validateAnimations(const Document&);
void validateData(Document&);  ///< values: finite floats, indices within their vertices

/// True if the view's bytes are there to be read.
bool hasBytes(const Document&, std::size_t view);
/// The bytes of a view, decompressed if need be.
Bytes viewBytes(Document&, std::size_t view);
/// All components of all elements as floats, normalised if the accessor says so.
std::vector<float> readFloats(Document&, std::size_t accessor);
/// All components of all elements of an accessor of unsigned integers.
std::vector<std::uint32_t> readUnsigned(Document&, std::size_t accessor);
/// One component as a float.
float componentAsFloat(const std::uint8_t* bytes, std::uint32_t componentType, bool normalized);
std::size_t componentBytes(std::uint32_t componentType);

inline std::string placeOf(const char* things, std::size_t index) {
    return std::string("/") + things + '/' + std::to_string(index);
}

}  // namespace lodestar::scene::gltf
