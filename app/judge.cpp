// SPDX-License-Identifier: Apache-2.0
#include "app/judge.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/geometry/cull_params.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/console.hpp"

namespace lodestar::app {

QualityFigures qualityOf(const quality::RgbImage& reference, const quality::RgbImage& test) {
    const bool forSsim = reference.width >= 11 && reference.height >= 11;
    return {quality::psnr(reference, test), forSsim ? quality::ssim(reference, test) : NAN,
            quality::flip(reference, test)};
}

RunQuality judgeRun(const Session& session, frame::Frame& frame, const Run& run) {
    assert(!run.samples.empty());
    RunQuality quality;
    std::vector<double> psnr, ssim, flip;
    Progress bar("comparing with full quality", run.samples.size());
    for (const Sample& sample : run.samples) {
        if (session.gpuScene->animated()) session.gpuScene->animate(sample.seconds);
        frame.render(sample.camera, {});
        quality.lastReference = readDisplay(*session.device, frame);
        const QualityFigures figures = qualityOf(quality.lastReference, sample.picture);
        quality.frames.push_back(figures);
        psnr.push_back(figures.psnrDb);
        ssim.push_back(figures.ssim);
        flip.push_back(figures.flip);
        bar.update(quality.frames.size());
    }
    quality.median = {budget::median(psnr), budget::median(ssim), budget::median(flip)};
    quality.worstPsnrDb = *std::min_element(psnr.begin(), psnr.end());
    return quality;
}

Json countsOf(const Session& session, const frame::Frame& frame) {
    const gpu::Device& device = *session.device;
    const scene::GpuScene& scene = *session.gpuScene;
    const geometry::DrawList& list = frame.drawList();
    const auto counts = gpu::as<shared::CullCounts>(
        gpu::readBuffer(device, list.counts, sizeof(shared::CullCounts)))[0];
    const auto of = [&](std::uint32_t first, std::uint32_t second) {
        return counts.lists[first].count + counts.lists[second].count;
    };
    const std::uint32_t visible = of(shared::LS_LIST_CLUSTERS, shared::LS_LIST_CLUSTERS_2);
    const std::uint32_t triangles = of(shared::LS_LIST_TRIANGLES, shared::LS_LIST_TRIANGLES_2);
    std::uint64_t dropped = 0;
    for (const shared::CullList& one : counts.lists) dropped += one.dropped;

    // Triangles by level: each id's cluster says its level.
    std::vector<std::uint64_t> perLod(scene.lodCount());
    std::uint64_t refined = 0;  // finer than their meshes
    std::uint64_t listed = 0;   // triangles of the visible meshlets, before each is tested
    if (visible > 0) {
        const auto clusters = gpu::as<shared::GpuCluster>(
            gpu::readBuffer(device, scene.clusters.buffer(),
                            sizeof(shared::GpuCluster) * (std::size_t{visible} + list.table)));
        for (std::size_t c = list.table; c < list.table + visible; ++c)
            listed += clusters[c].triangleCount;
        for (const auto id :
             gpu::as<std::uint32_t>(gpu::readBuffer(device, list.ids.buffer(), 4ull * triangles)))
            if (const std::uint32_t lod = clusters[id >> shared::LS_TRIANGLE_BITS].lod;
                lod == shared::LS_LOD_REFINED)
                ++refined;
            else
                ++perLod[lod];
    }
    return {{"instances_total", scene.instanceCount()},
            {"instances_visible", counts.instances + counts.instancesFound},
            {"instances_hidden", counts.instancesHidden - counts.instancesFound},
            {"chunks_total", scene.chunkCount()},
            {"chunks_visible", counts.lists[shared::LS_LIST_INSTANCES].count / shared::LS_CHUNK},
            {"clusters_total", scene.clusterCount()},
            {"clusters_visible", visible},
            {"triangles_total", scene.triangleCount()},
            {"triangles_listed", listed},
            {"triangles_visible", triangles},
            {"repaired_pixels", frame.repairedPixels()},
            {"blended_fragments", frame.blendedFragments()},
            {"refined_texels", frame.refinedTexels()},
            {"triangles_per_lod", perLod},
            {"triangles_refined", refined},
            {"refinement_coarsened", frame.refinementCoarsened()},
            {"dropped", dropped}};  // over the capacity of the lists: missing in the picture
}

Result<void> validationVerdict(const gpu::Device& device) {
    const auto messages = device.validationMessages();
    if (messages.empty()) return {};
    return fail(fmt::format("the validation layers said {} things, first: {}", messages.size(),
                            printable(messages.front())));
}

}  // namespace lodestar::app
