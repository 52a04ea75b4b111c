// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include <glm/vec4.hpp>

#include <lodestar/gpu/kernel.hpp>
#include <lodestar/gpu/raster.hpp>
#include <lodestar/gpu/tiles.hpp>

namespace lodestar::gpu {

/// Where work happens, for barriers between passes.
enum class Stage { compute, raster, indirect, transfer, host };

struct PassTime {
    std::string name;
    double ms = 0;
};

struct FrameTimes {
    double gpuMs = 0;   ///< first to last timestamp; wall time where the queue has no timestamps
    double wallMs = 0;  ///< submission to completion, on the CPU's clock
    std::vector<PassTime> passes;

    /// Adds what was done before this.
    void precede(const FrameTimes& before);
};

/// Workgroups of `local` threads that cover `size` threads.
inline std::uint32_t groups(std::uint32_t size, std::uint32_t local) {
    return (size + local - 1) / local;
}

/// Records one frame at a time: passes with a debug label and a GPU timestamp each, dispatches,
/// draws, barriers. One frame in flight: submit() waits.
class Recorder {
public:
    explicit Recorder(const Device&);

    void begin();
    /// Submits what was recorded since begin(), waits for it, and says what it cost.
    /// Throws vk::DeviceLostError and the like.
    FrameTimes submit();

    /// An open pass: from here to the end of the scope.
    class Pass {
    public:
        ~Pass();
        Pass(const Pass&) = delete;
        Pass& operator=(const Pass&) = delete;

    private:
        friend class Recorder;
        explicit Pass(Recorder& r) : recorder(&r) {}
        Recorder* recorder;
    };
    /// Every record() of a pass opens with this. Passes do not nest.
    [[nodiscard]] Pass pass(const std::string& name);

    /// Everything written by `from` becomes visible to `to`.
    void barrier(Stage from, Stage to);

    template <typename Params>
    void dispatch(const Kernel& kernel, vk::Extent3D groups, const std::vector<Binding>& bindings,
                  const Params& params) {
        bind(kernel, bindings, std::as_bytes(std::span(&params, 1)));
        commands.dispatch(groups.width, groups.height, groups.depth);
    }
    void dispatch(const Kernel& kernel, vk::Extent3D groups, const std::vector<Binding>& bindings) {
        bind(kernel, bindings, {});
        commands.dispatch(groups.width, groups.height, groups.depth);
    }

    /// The number of workgroups is three words at `offset` of `groups`, visible to indirect.
    template <typename Params>
    void dispatchIndirect(const Kernel& kernel, const Buffer& groups, std::uint64_t offset,
                          const std::vector<Binding>& bindings, const Params& params) {
        bind(kernel, bindings, std::as_bytes(std::span(&params, 1)));
        commands.dispatchIndirect(groups.vk(), offset);
    }
    void dispatchIndirect(const Kernel& kernel, const Buffer& groups, std::uint64_t offset,
                          const std::vector<Binding>& bindings) {
        bind(kernel, bindings, {});
        commands.dispatchIndirect(groups.vk(), offset);
    }
    template <typename Params>
    void dispatchIndirect(const Kernel& kernel, const Buffer& groups,
                          const std::vector<Binding>& bindings, const Params& params) {
        dispatchIndirect(kernel, groups, 0, bindings, params);
    }
    void dispatchIndirect(const Kernel& kernel, const Buffer& groups,
                          const std::vector<Binding>& bindings) {
        dispatchIndirect(kernel, groups, 0, bindings);
    }

    /// Over the 8×8 tiles of a grid, or over those of `tiles` alone, visible to indirect. The
    /// kernel has one binding more than `bindings`, a texel buffer, and its shader takes pixels
    /// from it with tiles.glsl.
    template <typename Params>
    void dispatchTiles(const Kernel& kernel, vk::Extent2D grid, const TileList* tiles,
                       std::vector<Binding> bindings, const Params& params) {
        bindings.emplace_back(tiles ? tiles->tiles : allTiles);
        if (tiles)
            dispatchIndirect(kernel, tiles->groups, bindings, params);
        else
            dispatch(kernel, {groups(grid.width, 8), groups(grid.height, 8), 1}, bindings, params);
    }

    struct Target {
        std::vector<View> colors;  ///< cleared to 0
        View depth;                ///< cleared to 0, the far end of reversed depth
        bool keep = false;         ///< do not clear: go on with what is there
    };
    void beginRendering(const Target&);
    void endRendering();
    /// One draw, a vk::DrawIndirectCommand at `offset` of `commands`.
    template <typename Params>
    void drawIndirect(const RasterPipeline& pipeline, const Buffer& draws, std::uint64_t offset,
                      const std::vector<Binding>& bindings, const Params& params) {
        bind(pipeline, bindings, std::as_bytes(std::span(&params, 1)));
        commands.drawIndirect(draws.vk(), offset, 1, sizeof(vk::DrawIndirectCommand));
    }

    void fill(const Buffer&, std::uint32_t value);
    /// All of an image of floats or fractions, which has eTransferDst among its usages.
    void clear(const View&, const glm::vec4& value);
    /// Writes a small struct (≤ 64 KiB) to the start of a buffer, as a transfer.
    template <typename Value>
    void update(const Buffer& buffer, const Value& value) {
        static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) % 4 == 0);
        commands.updateBuffer<Value>(buffer.vk(), 0, value);
    }
    /// To the start of `to`.
    void copy(const Buffer& from, const Buffer& to, std::uint64_t bytes,
              std::uint64_t fromOffset = 0);

    const vk::raii::CommandBuffer& vk() const { return commands; }
    const Device& device() const { return *owner; }

private:
    void bind(const Kernel&, const std::vector<Binding>&, std::span<const std::byte> params);
    void bind(const RasterPipeline&, const std::vector<Binding>&,
              std::span<const std::byte> params);
    void timestamp();
    void endPass();

    const Device* owner;
    vk::raii::CommandPool pool;
    vk::raii::CommandBuffer commands{nullptr};
    vk::raii::Fence fence;
    vk::raii::QueryPool queries{nullptr};
    TexelBuffer allTiles;  ///< says that there is no list
    std::vector<std::string> names;
    std::uint32_t queryCount = 0;
    bool passOpen = false;
    bool flushesLate = false;
};

/// 8×8 workgroups over an image.
inline vk::Extent3D groups8x8(vk::Extent2D extent) {
    return {groups(extent.width, 8), groups(extent.height, 8), 1};
}

}  // namespace lodestar::gpu
