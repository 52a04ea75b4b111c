// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <variant>

#include <lodestar/geometry/cull.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/visibility/capture_compute.hpp>
#include <lodestar/visibility/capture_ms.hpp>
#include <lodestar/visibility/capture_ss.hpp>
#include <lodestar/visibility/compact.hpp>

namespace lodestar::frame {

/// Who captures visibility. All give an id for every sample of grid C.
enum class CaptureBackend { automatic, supersample, multisample, compute };
inline constexpr std::array<std::string_view, 4> kCaptureBackendNames{"auto", "ss", "ms",
                                                                      "compute"};

struct CaptureSettings {
    vk::Extent2D base{1280, 720};  ///< grid B
    std::uint32_t side = 1;        ///< s: 1, 2, 4 or 8, that is 1 … 64 samples a pixel
    CaptureBackend backend = CaptureBackend::automatic;
    /// What exists only during a capture (a band of grid C and its depths) stays below this.
    std::uint64_t transientBytes = 280ull << 20;
    std::uint32_t words = 0;     ///< first size of the pool of lists; 0 = chosen
    std::uint32_t bandRows = 0;  ///< rows of grid B a band; 0 = as many as fit
    /// With levels of detail, whose errors are in pixels of grid B, ids hold for this frame alone.
    /// Without, for the scene: what a stream needs.
    std::optional<geometry::LodChoice> lod = std::nullopt;
};

/// The rule of CaptureBackend::automatic: on a GPU compute; on a CPU compute where a triangle of
/// the view covers few samples, supersampling elsewhere (docs/visibility.md has the measurements
/// behind it). Culls for the view and waits.
CaptureBackend chooseBackend(const gpu::Device&, const scene::GpuScene&, const CaptureSettings&,
                             const scene::Camera&);
/// The same when `listed` triangles are known to be drawn.
CaptureBackend chooseBackend(const gpu::Device&, const CaptureSettings&, std::uint64_t listed);

/// Captures a frame's visibility into a compact record: culls, captures and compacts band by band,
/// so that grid C is never in memory whole. Deterministic; with the compute backend to the byte
/// between runs, bands and thread counts. The raster pipeline rounds a vertex's place in the band:
/// where bands begin elsewhere, of 33 million samples of Sponza about a hundred show another
/// triangle.
class CaptureFrame {
public:
    /// CaptureBackend::automatic is decided here, for the scene's triangles as if all were in view;
    /// chooseBackend knows better. Throws std::invalid_argument for settings out of range (grid C
    /// has at most 16384 samples a side), gpu::DeviceError for a backend that the device cannot
    /// run.
    CaptureFrame(const gpu::Device&, const scene::GpuScene&, const CaptureSettings&);

    /// Adds the capture of a frame; the record is then visible to compute. After submit() look at
    /// record().overflowed(), or use capture().
    void record(gpu::Recorder&, const scene::Camera&);
    /// Records, submits and waits. A frame whose lists overflow the pool is captured again with a
    /// larger one: `recaptured` says so.
    struct Done {
        gpu::FrameTimes times;         ///< of the capture that counts
        std::uint32_t recaptured = 0;  ///< words of the pool that was too small; 0 = it was not
    };
    Done capture(const scene::Camera&);
    /// Makes the pool of lists fit what the last frame needed, with some room.
    void grow();

    const visibility::CompactRecord& compact() const { return out; }
    CaptureBackend backend() const { return used; }
    vk::Extent2D gridC() const;
    std::uint32_t bands() const { return out.bands; }
    /// Rows of grid B in each band but the last.
    std::uint32_t rowsOfBand() const { return bandRows; }
    /// What exists only during a capture [bytes].
    std::uint64_t transientBytes() const { return transient; }
    const geometry::DrawList& drawList() const { return draws; }

private:
    struct Supersample {
        visibility::CaptureSs pass;
        gpu::Image ids, depth;
    };
    struct Multisample {
        visibility::CaptureMs pass;
        visibility::CaptureMs::Scratch scratch;
    };
    struct Compute {
        visibility::CaptureCompute pass;
        visibility::CaptureCompute::Scratch scratch;
    };
    using Backend = std::variant<Supersample, Multisample, Compute>;
    /// What exists only during a capture, for one band.
    struct Working {
        Backend backend;
        visibility::Compact::Scratch compact;
    };
    Backend makeBackend() const;
    Working makeWorking();
    geometry::SampledPicture pictureOf(const visibility::Band&,
                                       const glm::mat4& clipFromWorld) const;
    void listTriangles(gpu::Recorder&, const visibility::Band&, const glm::mat4& clipFromWorld,
                       glm::vec3 eye);
    void recordBand(gpu::Recorder&, const visibility::Band&, const glm::mat4& clipFromWorld,
                    glm::vec3 eye);

    const gpu::Device* device;
    const scene::GpuScene* scene;
    CaptureSettings settings;
    CaptureBackend used;
    std::uint32_t bandRows;
    std::uint64_t transient = 0;

    geometry::Cull cull;
    geometry::DrawList draws;
    Working working;
    visibility::Compact compactPass;
    visibility::CompactRecord out;
    gpu::Recorder rec;
};

}  // namespace lodestar::frame
