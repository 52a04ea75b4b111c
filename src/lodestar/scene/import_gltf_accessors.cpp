// SPDX-License-Identifier: Apache-2.0
// Reading of views and accessors that validate() has found to lie within their buffers.
#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <lodestar/scene/import_gltf_document.hpp>

namespace lodestar::scene::gltf {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

template <typename T>
T load(const std::uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);  // offsets need not be aligned
    return value;
}

std::vector<std::uint8_t> decompressed(Document& document, std::size_t viewIndex) {
    const Compression& packed = *document.views[viewIndex].compression;
    const std::string place =
        placeOf("bufferViews", viewIndex) + "/extensions/EXT_meshopt_compression";
    const std::vector<std::uint8_t>& buffer = document.buffers[packed.buffer];
    const std::uint8_t* bytes = buffer.data() + packed.offset;
    document.spend(packed.count * packed.stride, place);
    std::vector<std::uint8_t> data(packed.count * packed.stride);
    int failed = 0;
    switch (packed.mode) {
        case Compression::Mode::attributes:
            failed = meshopt_decodeVertexBuffer(data.data(), packed.count, packed.stride, bytes,
                                                packed.length);
            break;
        case Compression::Mode::triangles:
            failed = meshopt_decodeIndexBuffer(data.data(), packed.count, packed.stride, bytes,
                                               packed.length);
            break;
        case Compression::Mode::indices:
            failed = meshopt_decodeIndexSequence(data.data(), packed.count, packed.stride, bytes,
                                                 packed.length);
            break;
    }
    if (failed != 0) refuse(place, "the compressed data is damaged");
    switch (packed.filter) {
        case Compression::Filter::none:
            break;
        case Compression::Filter::octahedral:
            meshopt_decodeFilterOct(data.data(), packed.count, packed.stride);
            break;
        case Compression::Filter::quaternion:
            meshopt_decodeFilterQuat(data.data(), packed.count, packed.stride);
            break;
        case Compression::Filter::exponential:
            meshopt_decodeFilterExp(data.data(), packed.count, packed.stride);
            break;
    }
    return data;
}

std::uint32_t componentAsUnsigned(const std::uint8_t* bytes, std::uint32_t componentType) {
    switch (componentType) {
        case kUnsignedByte:
            return *bytes;
        case kUnsignedShort:
            return load<std::uint16_t>(bytes);
        case kUnsignedInt:
            return load<std::uint32_t>(bytes);
        default:
            return 0;
    }
}

/// Calls `convert(element, component, bytes)` for every component, the sparse ones last.
template <typename Convert>
void forEachComponent(Document& document, std::size_t index, const Convert& convert) {
    const Accessor& accessor = document.accessors[index];
    const std::size_t size = componentBytes(accessor.componentType);
    // Matrices are read as if packed: the only ones in use are of floats, which have no padding.
    const auto element = [&](std::size_t i, const std::uint8_t* bytes) {
        for (std::size_t c = 0; c < accessor.components; ++c) convert(i, c, bytes + c * size);
    };
    if (accessor.view) {
        const std::uint8_t* bytes = viewBytes(document, *accessor.view).data() + accessor.offset;
        for (std::size_t i = 0; i < accessor.count; ++i) element(i, bytes + i * accessor.stride);
    }
    if (!accessor.sparse) return;
    const Sparse& sparse = *accessor.sparse;
    const std::uint8_t* indices =
        viewBytes(document, sparse.indicesView).data() + sparse.indicesOffset;
    const std::uint8_t* values =
        viewBytes(document, sparse.valuesView).data() + sparse.valuesOffset;
    for (std::size_t i = 0; i < sparse.count; ++i) {
        const std::uint32_t target = componentAsUnsigned(
            indices + i * componentBytes(sparse.indicesType), sparse.indicesType);
        if (target >= accessor.count)
            refuse(placeOf("accessors", index) + "/sparse/indices",
                   fmt::format("index {} is not below the number of elements ({})", target,
                               accessor.count));
        element(target, values + i * accessor.elementBytes);
    }
}

}  // namespace

std::size_t componentBytes(std::uint32_t componentType) {
    switch (componentType) {
        case kByte:
        case kUnsignedByte:
            return 1;
        case kShort:
        case kUnsignedShort:
            return 2;
        case kUnsignedInt:
        case kFloat:
            return 4;
        default:
            return 0;
    }
}

float componentAsFloat(const std::uint8_t* bytes, std::uint32_t componentType, bool normalized) {
    const auto scaled = [&](auto value, float most) {
        const auto number = static_cast<float>(value);
        return normalized ? std::max(number / most, -1.0f) : number;
    };
    switch (componentType) {
        case kByte:
            return scaled(load<std::int8_t>(bytes), 127.0f);
        case kUnsignedByte:
            return scaled(*bytes, 255.0f);
        case kShort:
            return scaled(load<std::int16_t>(bytes), 32767.0f);
        case kUnsignedShort:
            return scaled(load<std::uint16_t>(bytes), 65535.0f);
        case kUnsignedInt:
            return scaled(load<std::uint32_t>(bytes), 4294967295.0f);
        case kFloat:
            return load<float>(bytes);
        default:
            return 0;
    }
}

bool hasBytes(const Document& document, std::size_t view) {
    const BufferView& v = document.views[view];
    return !document.buffers[v.compression ? v.compression->buffer : v.buffer].empty();
}

Bytes viewBytes(Document& document, std::size_t index) {
    BufferView& view = document.views[index];
    if (!hasBytes(document, index)) {
        const std::size_t buffer = view.compression ? view.compression->buffer : view.buffer;
        refuse(placeOf("buffers", buffer),
               fmt::format("has no data, but {} is in use", placeOf("bufferViews", index)));
    }
    if (!view.compression)
        return Bytes(document.buffers[view.buffer]).subspan(view.offset, view.length);
    if (view.decoded.empty()) view.decoded = decompressed(document, index);
    return view.decoded;
}

std::vector<float> readFloats(Document& document, std::size_t index) {
    const Accessor& accessor = document.accessors[index];
    const std::size_t components = accessor.components;
    document.spend(accessor.count * components * sizeof(float), placeOf("accessors", index));
    std::vector<float> values(accessor.count * components);
    forEachComponent(document, index, [&](std::size_t i, std::size_t c, const std::uint8_t* bytes) {
        values[i * components + c] =
            componentAsFloat(bytes, accessor.componentType, accessor.normalized);
    });
    return values;
}

std::vector<std::uint32_t> readUnsigned(Document& document, std::size_t index) {
    const Accessor& accessor = document.accessors[index];
    const std::size_t components = accessor.components;
    document.spend(accessor.count * components * sizeof(std::uint32_t),
                   placeOf("accessors", index));
    std::vector<std::uint32_t> values(accessor.count * components);
    forEachComponent(document, index, [&](std::size_t i, std::size_t c, const std::uint8_t* bytes) {
        values[i * components + c] = componentAsUnsigned(bytes, accessor.componentType);
    });
    return values;
}

}  // namespace lodestar::scene::gltf
