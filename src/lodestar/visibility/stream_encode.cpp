// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>

#include <xxhash.h>
#include <zstd.h>

#include <lodestar/visibility/stream_code.hpp>

namespace lodestar::visibility {
namespace {

using namespace stream_code;

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kTriangleBits = 7;  // of an id: the triangle of its cluster

void putVarint(Bytes& to, std::uint64_t value) {
    for (; value >= 128; value >>= 7) to.push_back(static_cast<std::uint8_t>(value | 128));
    to.push_back(static_cast<std::uint8_t>(value));
}

/// The clusters in use, in order, and ids that count those instead: small numbers, side by side.
struct Renumbering {
    std::vector<std::uint32_t> used;

    explicit Renumbering(const Record& record) {
        const auto note = [&](std::uint32_t id) {
            if (id != 0 && (used.empty() || used.back() != id >> kTriangleBits))
                used.push_back(id >> kTriangleBits);
        };
        for (const auto& head : record.heads) note(head.id);
        for (const auto& node : record.nodes) note(idOf(node));
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
    }
    std::uint32_t operator()(std::uint32_t id) const {
        if (id == 0) return 0;
        const auto at = std::lower_bound(used.begin(), used.end(), id >> kTriangleBits);
        const auto number = static_cast<std::uint32_t>(at - used.begin()) + 1;
        return number << kTriangleBits | (id & ((1u << kTriangleBits) - 1));
    }
};

void check(const Stream& stream) {
    const Record& r = stream.record;
    const auto refuse = [](const char* what) {
        throw std::invalid_argument(std::string("encodeStream: ") + what);
    };
    if (stream.scene.size() > kMaxName) refuse("scene name over 1023 bytes");
    if (r.side != 1 && r.side != 2 && r.side != 4 && r.side != 8) refuse("side");
    if (r.width == 0 || r.height == 0 || r.heads.size() != std::size_t{r.width} * r.height)
        refuse("heads");
    std::size_t next = 0;
    for (const auto& head : r.heads) {
        if (!hasList(head)) continue;
        if (head.list != next) refuse("lists are not in the order of the pixels");
        while (next < r.nodes.size() && !isLast(r.nodes[next])) ++next;
        if (next++ == r.nodes.size()) refuse("a list does not end");
    }
    if (next != r.nodes.size()) refuse("nodes of no pixel");
}

void putHeads(const Record& record, const EncodeOptions& options,
              std::array<Bytes, kColumns>& columns) {
    for (std::size_t pixel = 0; pixel < record.heads.size(); ++pixel) {
        const auto& head = record.heads[pixel];
        const auto before = earlier(record.heads, record.width, pixel);
        std::uint8_t code = 0;
        if (options.predictIds) {
            while (code < kSameAs && before[code] != head.id) ++code;
            if (code == kOther)
                putVarint(columns[headDeltas], zigzag(std::int64_t{head.id} - before[0]));
        } else {
            code = kOther;
            putVarint(columns[headDeltas], head.id);
        }
        columns[headCodes].push_back(hasList(head) ? code | kMixed : code);
    }
}

void putNodes(const Record& record, const EncodeOptions& options,
              std::array<Bytes, kColumns>& columns) {
    for (std::size_t pixel = 0; pixel < record.heads.size(); ++pixel) {
        const auto list = listOf(record, pixel);
        if (list.empty()) continue;
        columns[counts].push_back(static_cast<std::uint8_t>(list.size() - 1));
        Candidates candidates(record, pixel);
        for (const auto& node : list) {
            const auto known = options.predictIds ? candidates.take(idOf(node)) : std::nullopt;
            columns[nodeCodes].push_back(known.value_or(kEscape));
            if (known) continue;
            const std::int64_t base = options.predictIds ? record.heads[pixel].id : 0;
            putVarint(columns[nodeDeltas], zigzag(std::int64_t{idOf(node)} - base));
        }
    }
    // Rows of masks differ little from the row above: one edge crosses them. Column by column of
    // rows, since each has its own habits.
    for (std::uint32_t y = 0; y < record.side; ++y)
        for (const auto& node : record.nodes) {
            const std::uint8_t above = y > 0 ? rowOf(maskOf(node), record.side, y - 1) : 0;
            columns[masks].push_back(rowOf(maskOf(node), record.side, y) ^ above);
        }
}

}  // namespace

std::uint64_t hashOf(std::span<const std::byte> bytes, std::uint64_t seed) {
    return XXH64(bytes.data(), bytes.size(), seed);
}

std::uint64_t hashOf(const scene::Scene& scene) {
    std::uint64_t hash = 1;
    const auto addBytes = [&](const void* data, std::size_t size) {
        hash = XXH64(data, size, hash);
    };
    const auto add = [&](const auto&... values) { (addBytes(&values, sizeof values), ...); };
    for (const scene::Mesh& mesh : scene.meshes) {
        // Vertices have no padding: floats alone.
        static_assert(sizeof(scene::Vertex) == 18 * sizeof(float));
        add(mesh.material, mesh.vertices.size(), mesh.indices.size());
        addBytes(mesh.vertices.data(), mesh.vertices.size() * sizeof(scene::Vertex));
        addBytes(mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
        if (!mesh.deforms()) continue;
        addBytes(mesh.influences.data(), mesh.influences.size() * sizeof(scene::Influence));
        for (const scene::MorphTarget& target : mesh.targets)
            for (const auto* list : {&target.position, &target.normal, &target.tangent})
                addBytes(list->data(), list->size() * sizeof(glm::vec3));
    }
    for (const scene::Skin& skin : scene.skins)
        for (std::size_t j = 0; j < skin.joints.size(); ++j)
            add(skin.joints[j], skin.jointFromBind[j]);
    for (const scene::Image& image : scene.images) {
        add(image.width, image.height);
        addBytes(image.rgba.data(), image.rgba.size());
    }
    for (const scene::Texture& t : scene.textures) add(t.image, t.space, t.wrapU, t.wrapV);
    for (const scene::Material& m : scene.materials) {
        add(m.baseColor, m.metallic, m.roughness, m.emissive, m.normalScale, m.occlusionStrength,
            m.alphaMode, m.alphaCutoff);
        const int sides = m.doubleSided, unlit = m.unlit;
        add(sides, unlit);
        for (const scene::TextureUse* use :
             {&m.baseColorTexture, &m.normalTexture, &m.metallicRoughnessTexture,
              &m.occlusionTexture, &m.emissiveTexture})
            add(use->texture, use->uvSet, use->transform);
    }
    for (const glm::mat4& m : scene::worldFromNode(scene)) add(m);
    for (const scene::Instance& i : scene.instances) add(i.mesh, i.node, i.nodeFromObject);
    for (const scene::Instance& i : scene.instances)
        if (scene::deforms(scene, i)) add(i.skin, i.weightsNode);
    return hash;
}

std::vector<std::byte> encodeStream(const Stream& stream, const EncodeOptions& options) {
    check(stream);
    const Renumbering renumber(stream.record);
    Record record = stream.record;
    for (auto& head : record.heads) head.id = renumber(head.id);
    for (auto& node : record.nodes)
        node.id = renumber(idOf(node)) | (node.id & shared::LS_LAST_NODE);

    std::array<Bytes, kColumns> columns;
    std::uint32_t last = 0;
    for (const std::uint32_t cluster : renumber.used) {
        putVarint(columns[clusters], cluster - last);
        last = cluster;
    }
    putHeads(record, options, columns);
    putNodes(record, options, columns);
    Bytes raw;
    for (const Bytes& column : columns) {
        putVarint(raw, column.size());
        raw.insert(raw.end(), column.begin(), column.end());
    }
    Bytes frame(ZSTD_compressBound(raw.size()));
    const std::size_t size =
        ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), options.level);
    if (ZSTD_isError(size)) throw std::runtime_error(ZSTD_getErrorName(size));

    Header header{};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.version = kStreamVersion;
    header.sceneHash = stream.sceneHash;
    header.clusterHash = stream.clusterHash;
    header.width = record.width;
    header.height = record.height;
    header.side = record.side;
    header.nodes = static_cast<std::uint32_t>(record.nodes.size());
    const scene::Camera& c = stream.camera;
    std::memcpy(header.eye, &c.eye, sizeof header.eye);
    std::memcpy(header.at, &c.at, sizeof header.at);
    std::memcpy(header.up, &c.up, sizeof header.up);
    header.verticalFov = c.verticalFov;
    header.nearPlane = c.nearPlane;
    header.aspect = stream.aspect;
    header.seconds = stream.seconds;
    header.predictIds = options.predictIds;
    header.nameBytes = static_cast<std::uint32_t>(stream.scene.size());
    header.rawBytes = raw.size();
    header.frameBytes = size;

    std::vector<std::byte> out(sizeof header + stream.scene.size() + size);
    std::memcpy(out.data() + sizeof header, stream.scene.data(), stream.scene.size());
    std::memcpy(out.data() + sizeof header + stream.scene.size(), frame.data(), size);
    std::memcpy(out.data(), &header, sizeof header);
    header.checksum = hashOf(std::span(out).subspan(kChecksummedFrom));
    std::memcpy(out.data(), &header, sizeof header);
    return out;
}

}  // namespace lodestar::visibility
