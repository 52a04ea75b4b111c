// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestar/scene/camera.hpp>
#include <lodestar/shared/result.hpp>
#include <lodestar/visibility/record.hpp>

/// Captured visibility as a file (.lvis): rebuilt later, elsewhere, at another size, given the same
/// scene. docs/visibility.md describes the format.
namespace lodestar::visibility {

inline constexpr std::uint32_t kStreamVersion = 1;

struct Stream {
    Record record;                  ///< ids are those of scene::GpuScene
    scene::Camera camera;           ///< of the capture
    float aspect = 1;               ///< width / height of the captured picture
    float seconds = 0;              ///< of the animation
    std::string scene;              ///< as the capture named it, for people; at most 1023 bytes
    std::uint64_t sceneHash = 0;    ///< hashOf(scene)
    std::uint64_t clusterHash = 0;  ///< of the clusters that ids count, as the capture cut them
};

/// Everything of a scene that visibility and its rebuilt attributes depend on.
std::uint64_t hashOf(const scene::Scene&);
std::uint64_t hashOf(std::span<const std::byte>, std::uint64_t seed = 0);

struct EncodeOptions {
    int level = 12;          ///< of zstd
    bool predictIds = true;  ///< code ids by their neighbours; off to measure what that buys
};
/// Throws std::invalid_argument for a record that breaks its own rules, or a scene name too long.
std::vector<std::byte> encodeStream(const Stream&, const EncodeOptions& = {});

struct DecodeOptions {
    bool checksum = true;  ///< fuzzers turn it off to get past it
    /// What the record may take in memory; larger ones are refused.
    std::uint64_t maxBytes = 2ull << 30;
};
/// Trusts nothing: every count, offset, id and mask is checked, and memory grows with what the
/// bytes hold, not with what they claim. `name` stands for the file in messages.
Result<Stream> decodeStream(std::span<const std::byte>, const std::string& name,
                            const DecodeOptions& = {});

}  // namespace lodestar::visibility
