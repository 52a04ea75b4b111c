// SPDX-License-Identifier: Apache-2.0
// libFuzzer target of the .lvis decoder. Build and run (clang):
//   cmake --preset asan -B build/fuzz -DLODESTAR_FUZZ=ON
//         -DLODESTAR_SANITIZE=address,undefined,fuzzer-no-link
//   cmake --build build/fuzz --target lvis_fuzz
//   build/fuzz/tests/lvis_fuzz -max_len=4096 CORPUS tests/fuzz/lvis_corpus
// The first byte says whether the rest is a whole file or the contents of a frame, which the fuzzer
// could never compress itself.
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <zstd.h>

#include <lodestar/visibility/stream_code.hpp>

using namespace lodestar;

namespace {

/// A file around `raw`: header fields from its first bytes, the rest compressed.
std::vector<std::byte> wrapped(const std::uint8_t* data, std::size_t size) {
    visibility::stream_code::Header h{};
    std::memcpy(h.magic, visibility::stream_code::kMagic, 4);
    h.version = visibility::kStreamVersion;
    h.width = size > 0 ? data[0] % 16 + 1 : 1;
    h.height = size > 1 ? data[1] % 16 + 1 : 1;
    h.side = 1u << (size > 2 ? data[2] % 4 : 3);
    h.nodes = size > 3 ? data[3] : 0;
    h.predictIds = size > 4 ? data[4] & 1 : 1;
    const std::size_t skip = std::min<std::size_t>(size, 5);
    h.verticalFov = h.nearPlane = h.aspect = 1;
    h.rawBytes = size - skip;
    std::vector<std::byte> frame(ZSTD_compressBound(size - skip));
    h.frameBytes = ZSTD_compress(frame.data(), frame.size(), data + skip, size - skip, 1);
    std::vector<std::byte> file(sizeof h + h.frameBytes);
    std::memcpy(file.data(), &h, sizeof h);
    std::copy_n(frame.begin(), h.frameBytes, file.begin() + sizeof h);
    return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    std::vector<std::byte> file;
    if (data[0] & 1) {
        file = wrapped(data + 1, size - 1);
    } else {
        const auto* bytes = reinterpret_cast<const std::byte*>(data);
        file.assign(bytes + 1, bytes + size);
    }
    const auto stream =
        visibility::decodeStream(file, "fuzz", {.checksum = false, .maxBytes = 64 << 20});
    if (!stream) {
        if (stream.error().message.find('\n') != std::string::npos) std::abort();
        return 0;
    }
    // What decodes is a record that keeps its own rules, and encodes to what decodes to the same.
    const auto ids = visibility::expandReference(stream->record);
    const auto again = visibility::decodeStream(visibility::encodeStream(*stream), "again");
    if (!again || visibility::expandReference(again->record) != ids) std::abort();
    return 0;
}
