// SPDX-License-Identifier: Apache-2.0
// The vetting of a document: head, views, accessors and values. What follows it may index freely.
// Cosmetic faults (unknown members, wrong or missing min/max, odd targets) are let pass.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include <lodestar/scene/import_gltf_document.hpp>

namespace lodestar::scene::gltf {

namespace {

constexpr std::array<std::string_view, 11> kSupported = {
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_materials_variants",  // every primitive also has a material of its own
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
};

void validateHead(const Document& document) {
    const Place root = document.root().object();
    const Place asset = root.get("asset").object();
    const Place version = asset.get("version");
    if (!version.text().starts_with("2."))
        version.refuse(fmt::format("glTF {} is not supported", cleaned(version.text())),
                       "convert it to glTF 2.0");
    if (const std::optional<Place> least = asset.find("minVersion"))
        if (least->text() != "2.0")
            least->refuse(fmt::format("needs glTF {}", cleaned(least->text())),
                          "convert it to glTF 2.0");
    for (const Place& used : root.elements("extensionsUsed")) used.text();
    for (const Place& required : root.elements("extensionsRequired"))
        if (!isSupported(required.text()))
            required.refuse(
                fmt::format("requires {}, which is not supported", cleaned(required.text())),
                "export it without that extension");
}

/// Refuses `offset … offset + length` outside of `size` bytes. No argument is over 2^53.
void checkRange(const Place& place, std::uint64_t offset, std::uint64_t length, std::uint64_t size,
                const std::string& whole) {
    if (offset > size || length > size - offset)
        place.refuse(fmt::format("bytes {} to {} are beyond the {} bytes of {}", offset,
                                 offset + length, size, whole));
}

std::uint64_t wholeOr(const Place& holder, const char* key, std::uint64_t otherwise) {
    const std::optional<Place> member = holder.find(key);
    return member ? member->whole() : otherwise;
}

std::uint64_t declaredLength(const Document& document, std::size_t buffer) {
    return document.root().get("buffers")[buffer].get("byteLength").whole();
}

Compression compressionOf(const Document& document, const Place& place, std::size_t viewLength) {
    Compression packed;
    packed.buffer = place.get("buffer").index(document.buffers.size(), "buffers");
    packed.offset = wholeOr(place, "byteOffset", 0);
    packed.length = place.get("byteLength").whole();
    packed.stride = place.get("byteStride").whole(256);
    packed.count = place.get("count").whole();
    checkRange(place, packed.offset, packed.length, declaredLength(document, packed.buffer),
               placeOf("buffers", packed.buffer));

    using Mode = Compression::Mode;
    using Filter = Compression::Filter;
    const Place mode = place.get("mode");
    if (mode.text() == "ATTRIBUTES") {
        packed.mode = Mode::attributes;
    } else if (mode.text() == "TRIANGLES") {
        packed.mode = Mode::triangles;
    } else if (mode.text() == "INDICES") {
        packed.mode = Mode::indices;
    } else {
        mode.refuse(fmt::format("'{}' is not a known mode", cleaned(mode.text())));
    }
    if (const std::optional<Place> filter = place.find("filter")) {
        if (filter->text() == "OCTAHEDRAL") {
            packed.filter = Filter::octahedral;
        } else if (filter->text() == "QUATERNION") {
            packed.filter = Filter::quaternion;
        } else if (filter->text() == "EXPONENTIAL") {
            packed.filter = Filter::exponential;
        } else if (filter->text() != "NONE") {
            filter->refuse(fmt::format("'{}' is not a known filter", cleaned(filter->text())));
        }
    }
    const std::size_t stride = packed.stride;
    const bool fits = packed.mode == Mode::attributes ? stride > 0 && stride % 4 == 0
                                                      : stride == 2 || stride == 4;
    const bool filterFits = packed.filter == Filter::none ||
                            (packed.mode == Mode::attributes &&
                             (packed.filter == Filter::octahedral   ? stride == 4 || stride == 8
                              : packed.filter == Filter::quaternion ? stride == 8
                                                                    : true));
    if (!fits || !filterFits)
        place.get("byteStride").refuse(fmt::format("{} does not suit the mode and filter", stride));
    if (packed.mode == Mode::triangles && packed.count % 3 != 0)
        place.get("count").refuse(fmt::format("{} is no multiple of 3", packed.count));
    if (packed.count > viewLength / stride || packed.count * stride != viewLength)
        place.get("count").refuse(fmt::format("{} elements of {} bytes are not the {} of the view",
                                              packed.count, stride, viewLength));
    // No stream of these codecs shrinks below 1/64: the vertex codec spends at least 2 bits on 16
    // bytes of a column, the index codecs a byte on a triangle or an index.
    if (viewLength / 64 > packed.length)
        place.get("byteLength")
            .refuse(fmt::format("{} bytes can't hold {}", packed.length, viewLength));
    return packed;
}

BufferView viewOf(const Document& document, const Place& place) {
    BufferView view;
    view.buffer = place.object().get("buffer").index(document.buffers.size(), "buffers");
    view.offset = wholeOr(place, "byteOffset", 0);
    view.length = place.get("byteLength").whole();
    if (view.length == 0) place.get("byteLength").refuse("is 0");
    checkRange(place, view.offset, view.length, declaredLength(document, view.buffer),
               placeOf("buffers", view.buffer));
    if (const std::optional<Place> stride = place.find("byteStride")) {
        view.stride = stride->whole();
        if (view.stride < 4 || view.stride > 252 || view.stride % 4 != 0)
            stride->refuse(fmt::format("{} is no multiple of 4 from 4 to 252", view.stride));
    }
    if (const std::optional<Place> packed = place.extension("EXT_meshopt_compression"))
        view.compression = compressionOf(document, *packed, view.length);
    return view;
}

std::uint32_t componentTypeOf(const Place& place) {
    const auto type = static_cast<std::uint32_t>(place.whole(0xffffffff));
    if (componentBytes(type) == 0) place.refuse(fmt::format("{} is not a component type", type));
    return type;
}

Sparse sparseOf(const Document& document, const Place& place, const Accessor& accessor) {
    Sparse sparse;
    sparse.count = place.object().get("count").whole();
    if (sparse.count > accessor.count)
        place.get("count").refuse(
            fmt::format("{} is over the accessor's {} elements", sparse.count, accessor.count));
    const Place indices = place.get("indices").object(), values = place.get("values").object();
    const std::size_t views = document.views.size();
    sparse.indicesView = indices.get("bufferView").index(views, "bufferViews");
    sparse.indicesOffset = wholeOr(indices, "byteOffset", 0);
    sparse.indicesType = componentTypeOf(indices.get("componentType"));
    if (sparse.indicesType != kUnsignedByte && sparse.indicesType != kUnsignedShort &&
        sparse.indicesType != kUnsignedInt)
        indices.get("componentType").refuse("is not an unsigned type");
    checkRange(indices, sparse.indicesOffset, sparse.count * componentBytes(sparse.indicesType),
               document.views[sparse.indicesView].length,
               placeOf("bufferViews", sparse.indicesView));
    sparse.valuesView = values.get("bufferView").index(views, "bufferViews");
    sparse.valuesOffset = wholeOr(values, "byteOffset", 0);
    checkRange(values, sparse.valuesOffset, sparse.count * accessor.elementBytes,
               document.views[sparse.valuesView].length, placeOf("bufferViews", sparse.valuesView));
    return sparse;
}

Accessor accessorOf(const Document& document, const Place& place) {
    struct Shape {
        const char* name;
        std::size_t components, columns;
    };
    static constexpr std::array<Shape, 7> kShapes = {{{"SCALAR", 1, 1},
                                                      {"VEC2", 2, 1},
                                                      {"VEC3", 3, 1},
                                                      {"VEC4", 4, 1},
                                                      {"MAT2", 4, 2},
                                                      {"MAT3", 9, 3},
                                                      {"MAT4", 16, 4}}};
    Accessor accessor;
    const Place type = place.object().get("type");
    const auto shape = std::find_if(kShapes.begin(), kShapes.end(),
                                    [&](const Shape& s) { return type.text() == s.name; });
    if (shape == kShapes.end())
        type.refuse(fmt::format("'{}' is not a type", cleaned(type.text())));
    accessor.type = shape->name;
    accessor.components = shape->components;
    accessor.componentType = componentTypeOf(place.get("componentType"));
    if (const std::optional<Place> normalized = place.find("normalized"))
        accessor.normalized = normalized->boolean() && accessor.componentType != kFloat;
    // The columns of a matrix start at multiples of 4 bytes.
    const std::size_t column =
        accessor.components / shape->columns * componentBytes(accessor.componentType);
    const std::size_t padded = shape->columns > 1 ? (column + 3) / 4 * 4 : column;
    accessor.elementBytes = padded * shape->columns;
    accessor.lastBytes = accessor.elementBytes - (padded - column);
    accessor.stride = accessor.elementBytes;
    accessor.count = place.get("count").whole();
    const std::optional<Place> offset = place.find("byteOffset");
    if (offset) accessor.offset = offset->whole();

    if (const std::optional<Place> viewIndex = place.find("bufferView")) {
        accessor.view = viewIndex->index(document.views.size(), "bufferViews");
        const BufferView& view = document.views[*accessor.view];
        if (view.stride != 0) accessor.stride = view.stride;
        if (accessor.stride < accessor.elementBytes)
            place.refuse(fmt::format("elements of {} bytes overlap in a view of stride {}",
                                     accessor.elementBytes, accessor.stride));
        if (accessor.count > view.length)
            place.get("count").refuse(fmt::format("{} elements are more than the {} bytes of {}",
                                                  accessor.count, view.length,
                                                  placeOf("bufferViews", *accessor.view)));
        const std::uint64_t length =
            accessor.count == 0 ? 0 : accessor.stride * (accessor.count - 1) + accessor.lastBytes;
        checkRange(place, accessor.offset, length, view.length,
                   placeOf("bufferViews", *accessor.view));
    } else {
        if (offset) offset->refuse("an offset without a bufferView");
        // Zeros (sparse) or Draco's output: no bytes bound the count, so the file's size has to.
        if (accessor.count > 16 * document.fileBytes)
            place.get("count").refuse(
                fmt::format("{} elements are far more than a file of {} bytes "
                            "can hold",
                            accessor.count, document.fileBytes));
    }
    if (const std::optional<Place> sparse = place.find("sparse"))
        accessor.sparse = sparseOf(document, *sparse, accessor);
    return accessor;
}

/// The largest value of an unsigned accessor; 0 if it is empty.
std::uint32_t largest(Document& document, std::size_t accessor,
                      std::vector<std::optional<std::uint32_t>>& known) {
    if (!known[accessor]) {
        const std::vector<std::uint32_t> values = readUnsigned(document, accessor);
        known[accessor] = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
    }
    return *known[accessor];
}

/// The index that graphics APIs may take for the start of a new strip; glTF bans it.
std::uint32_t restartIndex(std::uint32_t componentType) {
    return componentType == kUnsignedByte    ? 0xff
           : componentType == kUnsignedShort ? 0xffff
                                             : 0xffffffffu;
}

bool isReadable(const Document& document, std::size_t index) {
    const Accessor& accessor = document.accessors[index];
    if (accessor.view && !hasBytes(document, *accessor.view)) return false;
    if (!accessor.sparse) return accessor.view.has_value();
    return hasBytes(document, accessor.sparse->indicesView) &&
           hasBytes(document, accessor.sparse->valuesView);
}

void checkFinite(Document& document, std::size_t index) {
    const std::vector<float> values = readFloats(document, index);
    const auto bad = std::find_if_not(values.begin(), values.end(),
                                      [](float value) { return std::isfinite(value); });
    if (bad != values.end())
        refuse(
            placeOf("accessors", index),
            fmt::format("element {} is not finite", static_cast<std::size_t>(bad - values.begin()) /
                                                        document.accessors[index].components));
}

/// The least number of joints that the skins of the nodes showing each mesh have.
std::vector<std::size_t> jointsOfMeshes(const Place& root) {
    std::vector<std::size_t> least(root.elements("meshes").size(),
                                   std::numeric_limits<std::size_t>::max());
    const std::vector<Place> skins = root.elements("skins");
    for (const Place& node : root.elements("nodes")) {
        const std::optional<Place> mesh = node.find("mesh"), skin = node.find("skin");
        if (!mesh || !skin) continue;
        std::size_t& joints = least[mesh->whole()];
        joints = std::min(joints, skins[skin->whole()].get("joints").size());
    }
    return least;
}

}  // namespace

bool isSupported(std::string_view extension) {
    return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

void validateViewsAndAccessors(Document& document) {
    const Place root = document.root();
    for (const Place& view : root.elements("bufferViews"))
        document.views.push_back(viewOf(document, view));
    for (const Place& accessor : root.elements("accessors"))
        document.accessors.push_back(accessorOf(document, accessor));
}

void validateData(Document& document) {
    const Place root = document.root();
    for (std::size_t i = 0; i < document.accessors.size(); ++i) {
        if (!isReadable(document, i)) continue;
        // Reading checks the sparse indices, which is why it is done for other types too.
        if (document.accessors[i].componentType == kFloat || document.accessors[i].sparse)
            checkFinite(document, i);
    }
    std::vector<std::optional<std::uint32_t>> known(document.accessors.size());
    const std::vector<std::size_t> joints = jointsOfMeshes(root);
    const std::vector<Place> meshes = root.elements("meshes");
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        for (const Place& primitive : meshes[m].elements("primitives")) {
            if (primitive.extension("KHR_draco_mesh_compression")) continue;
            const Place attributes = primitive.get("attributes");
            const std::optional<Place> indices = primitive.find("indices");
            const std::optional<Place> position = attributes.find("POSITION");
            if (indices && position && isReadable(document, indices->whole())) {
                const std::uint32_t most = largest(document, indices->whole(), known);
                const std::size_t count = document.accessors[position->whole()].count;
                const Accessor& accessor = document.accessors[indices->whole()];
                if (accessor.count > 0 && most >= count)
                    indices->refuse(fmt::format("index {} is not below the number of vertices ({})",
                                                most, count));
                if (most == restartIndex(accessor.componentType))
                    indices->refuse(fmt::format("index {} asks for a primitive restart", most));
            }
            for (int set = 0;; ++set) {
                const std::optional<Place> accessor =
                    attributes.find(fmt::format("JOINTS_{}", set));
                if (!accessor) break;
                if (!isReadable(document, accessor->whole())) continue;
                const std::uint32_t most = largest(document, accessor->whole(), known);
                if (most >= joints[m])
                    accessor->refuse(fmt::format("joint {} is not below the number of joints ({})",
                                                 most, joints[m]));
            }
        }
    }
}

void validate(Document& document) {
    validateHead(document);
    validateViewsAndAccessors(document);
    validateMaterials(document);
    validateMeshes(document);
    validateNodes(document);
    validateAnimations(document);
    validateData(document);
}

}  // namespace lodestar::scene::gltf
