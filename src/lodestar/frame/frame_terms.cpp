// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <algorithm>
#include <cmath>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/upsample/upsample_params.h>
#include <lodestar/gpu/readback.hpp>

// The expensive terms: on which grids they are evaluated, and how they come to grid O.

namespace lodestar::frame {
namespace {

using gpu::Stage;

/// Terms that share a grid S.
struct RateGroup {
    float rate;
    shading::Coarse::Mask terms;
};

/// Of the terms that there are, the coarsest first. Without any: the constants they are then.
std::vector<RateGroup> rateGroups(const budget::Levers& levers, float supersample,
                                  shading::Coarse::Mask present) {
    if (present == 0) return {{1, 0}};
    std::vector<RateGroup> groups;
    for (std::size_t i = 0; i < budget::kTerms; ++i) {
        const float rate = levers.rate(budget::Term(i)) * supersample;
        const shading::Coarse::Mask bit = 1u << i;
        if ((present & bit) == 0) continue;
        const auto same = std::find_if(groups.begin(), groups.end(), [&](const RateGroup& group) {
            return std::abs(group.rate - rate) < 1e-3f;
        });
        if (same != groups.end())
            same->terms |= bit;
        else
            groups.push_back({rate, bit});
    }
    std::sort(groups.begin(), groups.end(),
              [](const RateGroup& a, const RateGroup& b) { return a.rate > b.rate; });
    return groups;
}

}  // namespace

/// Whether nothing ever changes the image of terms: there are none, and no effect writes its own.
bool Frame::termsAreConstant() const {
    return coarse.present() == 0 && !options.post.ssao;
}

/// Whether the image of terms is wanted all over grid O, beside what shading reads of it.
bool Frame::keepsTerms() const {
    return options.keepTerms || options.post.ssao || joining != scale::TemporalMode::off;
}

std::optional<upsample::Upsample::Inputs> Frame::evaluateTerms(const budget::Levers& levers) {
    listHolds = refines = false;
    if (termsAreConstant()) return {};
    const bool repairing = levers.repair > 0;
    if (repairing) upsample::RepairSelect::clear(rec, repairList);
    shading::Coarse::Mask written = 0, toRepair = 0;
    const std::vector<RateGroup> groups =
        rateGroups(levers, static_cast<float>(options.supersample), coarse.present());
    for (const RateGroup& group : groups) {
        // The first group fills the image, the others replace their channels.
        const auto mask = written == 0 ? shading::Coarse::Mask(shared::LS_ALL_TERMS) : group.terms;
        if (written != 0) rec.barrier(Stage::compute, Stage::compute);
        written |= group.terms;
        if (group.rate == 1) {
            coarse.recordFull(rec, *scene, termInputs(), mask, termImage);
            continue;
        }
        // The coarsest grid misses most: it says which pixels are repaired, for all the terms.
        const bool lists = repairing && toRepair == 0;
        toRepair |= group.terms;
        evaluateOnGridS(group.terms, group.rate, levers.localRate);
        const upsample::Upsample::Inputs onS{
            coarseImage, depth(),      surfaces.normal, shading::coarseExtent(live, group.rate),
            group.rate,  &coveredTiles};
        if (groups.size() == 1 && !keepsTerms()) return onS;
        rec.barrier(Stage::compute, Stage::compute);
        upsample.record(rec, onS, options.sigmas, termImage,
                        {.channels = mask,
                         .repair = lists ? &repairList : nullptr,
                         .leastWeight = options.leastWeight});
    }
    if (repairing && toRepair != 0) repairTerms(toRepair, toRepair, levers.repair);
    return {};
}

shading::Coarse::Inputs Frame::termInputs() const {
    return {.ids = ids(),
            .sunMap = lightMaps.sunMap(),
            .skyMaps = lightMaps.skyMaps(),
            .view = viewBuffer,
            .light = lightBuffer,
            .packing = options.packing,
            .tiles = &coveredTiles};
}

/// Evaluates terms of those listed pixels that want it most for `missed`.
void Frame::repairTerms(shading::Coarse::Mask missed, shading::Coarse::Mask evaluated,
                        float share) {
    listHolds = true;
    rec.barrier(Stage::compute, Stage::compute);
    weighRepair.record(rec, {viewBuffer, lightBuffer, material()}, missed, repairList);
    repairSelect.record(rec, repairList, share);
    coarse.recordRepair(rec, *scene, termInputs(), evaluated, repairList, termImage);
}

/// Shades with the terms of grid S, and anew the pixels where that missed what they show.
void Frame::combineFromS(const upsample::Upsample::Inputs& termsOnS, float repair) {
    const shading::Combine::Inputs inputs = combineInputs();
    if (repair > 0) upsample::RepairSelect::clear(rec, repairList);
    combine.recordFromS(
        rec, inputs, termsOnS, options.sigmas,
        {.repair = repair > 0 ? &repairList : nullptr, .leastWeight = options.leastWeight},
        radiance());
    if (repair == 0) return;
    // Nothing has filled the image: absent terms are written too.
    repairTerms(coarse.present(), shared::LS_ALL_TERMS, repair);
    rec.barrier(Stage::compute, Stage::compute);
    combine.recordRepaired(rec, inputs, repairList, radiance());
}

/// Every texel of S, or with a local rate every second one and, where the terms vary, the others.
void Frame::evaluateOnGridS(shading::Coarse::Mask terms, float rate, float localRate) {
    const shading::Coarse::Inputs inputs = termInputs();
    coarse.record(rec, *scene, inputs, terms, rate, termTexels, coarseImage, localRate > 0 ? 2 : 1);
    if (localRate == 0) return;
    refines = true;
    rec.barrier(Stage::compute, Stage::compute);
    refine.record(rec, {surfaces.depth, surfaces.normal, shading::coarseExtent(live, rate), rate},
                  options.sigmas, localRate, coarseImage, termTexels);
    coarse.recordListed(rec, *scene, inputs, terms, rate, termTexels, coarseImage);
}

std::uint32_t Frame::refinedTexels() const {
    if (!refines) return 0;
    return gpu::as<shared::TexelListHeader>(
               gpu::readBuffer(*device, termTexels.header, sizeof(shared::TexelListHeader)))
        .front()
        .listed;
}

std::uint32_t Frame::repairedPixels() const {
    if (!listHolds) return 0;
    return gpu::as<shared::RepairHeader>(
               gpu::readBuffer(*device, repairList.header, sizeof(shared::RepairHeader)))
        .front()
        .kept;
}

}  // namespace lodestar::frame
