// SPDX-License-Identifier: Apache-2.0
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <fmt/format.h>

#include <lodestar/scene/import_gltf_convert.hpp>

namespace lodestar::scene::gltf {

namespace {

/// The number of triangles a Draco stream announces. libdraco allocates by it before it reads on,
/// so it has to be known first. Layout: the Draco bitstream specification 2.2, "Draco header",
/// "Metadata", "Edgebreaker connectivity" and "Sequential connectivity".
std::uint64_t announcedTriangles(Bytes bytes, const std::string& place) {
    constexpr std::size_t kHeader = 11;  // "DRACO", version, geometry, method, flags
    constexpr std::uint8_t kTriangularMesh = 1, kSequential = 0;
    constexpr std::uint8_t kMetadataFlag = 0x80;  // of the second flag byte
    const std::string damaged = "the Draco data is damaged";
    if (bytes.size() < kHeader ||
        std::string_view(reinterpret_cast<const char*>(bytes.data()), 5) != "DRACO")
        refuse(place, "is not Draco data");
    if (bytes[5] != 2 || bytes[6] != 2)
        refuse(place, fmt::format("Draco bitstream {}.{} instead of 2.2", bytes[5], bytes[6]));
    if (bytes[7] != kTriangularMesh) refuse(place, "the Draco data is not a triangle mesh");

    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()) + kHeader, bytes.size() - kHeader);
    buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
    if ((bytes[10] & kMetadataFlag) != 0) {
        draco::GeometryMetadata metadata;
        if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
            refuse(place, damaged);
    }
    std::uint32_t triangles = 0, vertices = 0;
    if (bytes[8] == kSequential) {
        if (!draco::DecodeVarint(&triangles, &buffer)) refuse(place, damaged);
    } else {
        std::uint8_t traversal = 0;
        if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&vertices, &buffer) ||
            !draco::DecodeVarint(&triangles, &buffer))
            refuse(place, damaged);
    }
    return triangles;
}

std::uint32_t componentTypeOf(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8:
            return kByte;
        case draco::DT_UINT8:
            return kUnsignedByte;
        case draco::DT_INT16:
            return kShort;
        case draco::DT_UINT16:
            return kUnsignedShort;
        case draco::DT_UINT32:
            return kUnsignedInt;
        case draco::DT_FLOAT32:
            return kFloat;
        default:
            return 0;
    }
}

std::vector<float> valuesOf(const draco::PointAttribute& attribute, std::size_t vertexCount,
                            const Accessor& accessor, const std::string& place) {
    const std::uint32_t type = componentTypeOf(attribute.data_type());
    const std::size_t components = attribute.num_components();
    if (type == 0 || components != accessor.components)
        refuse(place, "the Draco attribute does not match its accessor");
    const std::size_t size = componentBytes(type);
    const auto stride = static_cast<std::uint64_t>(attribute.byte_stride());
    const std::uint64_t bytes = attribute.buffer()->data_size();
    std::vector<float> values(vertexCount * components);
    for (std::size_t i = 0; i < vertexCount; ++i) {
        const std::uint64_t entry =
            attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i))).value();
        const std::uint64_t offset =
            static_cast<std::uint64_t>(attribute.byte_offset()) + entry * stride;
        if (entry >= attribute.size() || offset > bytes || components * size > bytes - offset)
            refuse(place, "the Draco attribute is damaged");
        for (std::size_t c = 0; c < components; ++c)
            values[i * components + c] =
                componentAsFloat(attribute.buffer()->data() + offset + c * size, type,
                                 accessor.normalized && type != kFloat);
    }
    return values;
}

}  // namespace

DracoPrimitive decodeDraco(Document& document, const Place& primitive) {
    // What libdraco keeps while it decodes (corner table, traversal, attributes), about.
    constexpr std::uint64_t kBytesPerTriangle = 100;
    // Beyond what even a flat grid packs into.
    constexpr std::uint64_t kMostTrianglesPerByte = 1024;
    const Place extension = *primitive.extension("KHR_draco_mesh_compression");
    const std::string place = extension.path();
    const Bytes bytes = viewBytes(document, extension.get("bufferView").whole());
    const std::uint64_t triangles = announcedTriangles(bytes, place);
    if (triangles > kMostTrianglesPerByte * bytes.size())
        refuse(place, fmt::format("{} bytes can't hold {} triangles", bytes.size(), triangles));
    document.spend(triangles * kBytesPerTriangle, place);

    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) refuse(place, "the Draco data is damaged");
    const draco::Mesh& mesh = *decoded.value();

    DracoPrimitive result;
    result.vertexCount = mesh.num_points();
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(f))) {
            if (point.value() >= result.vertexCount) refuse(place, "the Draco data is damaged");
            result.indices.push_back(point.value());
        }
    const Place attributes = extension.get("attributes");
    for (const auto& [name, id] : attributes.json().items()) {
        const Place idPlace = attributes.get(name);
        const std::optional<Place> accessor = primitive.get("attributes").find(name);
        if (!accessor) continue;
        const draco::PointAttribute* attribute =
            mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(idPlace.whole()));
        if (attribute == nullptr)
            idPlace.refuse(fmt::format("the Draco data has no attribute {}", idPlace.whole()));
        const Accessor& shape = document.accessors[accessor->whole()];
        document.spend(result.vertexCount * shape.components * sizeof(float), place);
        result.attributes[name] = valuesOf(*attribute, result.vertexCount, shape, idPlace.path());
    }
    return result;
}

}  // namespace lodestar::scene::gltf
