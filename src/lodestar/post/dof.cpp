// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/gpu/linear_sampler.hpp>
#include <lodestar/post/dof.hpp>
#include <lodestar/post/effective.hpp>

namespace lodestar::post {
namespace {

constexpr std::uint32_t kLayers[] =
#include <lodestar/post/dof_layers.comp.inc>
    ;
constexpr std::uint32_t kDown[] =
#include <lodestar/post/dof_down.comp.inc>
    ;
constexpr std::uint32_t kBlur[] =
#include <lodestar/post/dof_blur.comp.inc>
    ;
constexpr std::uint32_t kResolve[] =
#include <lodestar/post/dof_resolve.comp.inc>
    ;
constexpr std::uint32_t kCombine[] =
#include <lodestar/post/dof_combine.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

// Where `dof_layers.comp` takes the picture from.
constexpr std::uint32_t kPixels = 0, kQuads = 1, kDownsampled = 2;

constexpr std::uint32_t kBlock = 2;  // pixels a side that one thread combines

constexpr float kCocFalloff = 1.44269504f / (2 * 0.3f * 0.3f);
/// σ from which on a blur is made of half the size [texels of what it is made of].
constexpr float kHalves = 1.3f;

vk::Extent2D half(vk::Extent2D size) {
    return {(size.width + 1) / 2, (size.height + 1) / 2};
}

gpu::Image image(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                 const char* name) {
    return {device,
            {.name = name,
             .format = format,
             .extent = extent,
             .usage = Usage::eSampled | Usage::eStorage}};
}

bool isMultiple(glm::vec2 rate, float of) {
    return std::fmod(rate.x, of) == 0 && std::fmod(rate.y, of) == 0;
}

/// Whether a texel of B has several quads of pixels and nothing else.
bool hasQuads(glm::vec2 rate) {
    return rate.x > 2 && rate.y > 2 && isMultiple(rate, 2);
}

gpu::Kernel makeLayers(const gpu::Device& device, const char* name, std::uint32_t source) {
    return {device,
            name,
            kLayers,
            {Slot::sampledImage, Slot::sampledImage, Slot::storageImage, Slot::storageImage},
            sizeof(shared::DofParams),
            {source}};
}

gpu::Kernel makeCombine(const gpu::Device& device, const char* name, std::uint32_t side) {
    return {device,
            name,
            kCombine,
            {Slot::sampledImage, Slot::sampledImage, Slot::storageImage},
            sizeof(shared::DofParams),
            {side}};
}

}  // namespace

Dof::Dof(const gpu::Device& device, vk::Extent2D room, std::optional<vk::Extent2D> full)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      linearSampler(gpu::makeLinearSampler(device)),
      layersOfPixels(makeLayers(device, "dof layers", kPixels)),
      layersOfQuads(makeLayers(device, "dof layers, of quads", kQuads)),
      layersOfDown(makeLayers(device, "dof layers, downsampled", kDownsampled)),
      down(device, "dof down", kDown, {Slot::sampledImage, Slot::sampledImage, Slot::storageImage},
           sizeof(shared::DofDownParams)),
      blur(device, "dof blur", kBlur, {Slot::sampledImage, Slot::storageImage},
           sizeof(shared::DofBlurParams)),
      resolve(device, "dof resolve", kResolve,
              {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::sampledImage,
               Slot::storageImage},
              sizeof(shared::DofParams)),
      combine(makeCombine(device, "dof combine", 1)),
      combineBlocks(makeCombine(device, "dof combine, of blocks", kBlock)),
      sharp(image(device, room, vk::Format::eR32G32B32A32Uint, "dof: layers")),
      cocs(image(device, room, vk::Format::eR32Sfloat, "dof: CoC")) {
    constexpr auto kPacked = vk::Format::eR32G32B32A32Uint;
    for (int i = 0; i < 3; ++i)  // small blurs leave all of them at the size of B
        levels.push_back({image(device, room, kPacked, "dof: across"),
                          image(device, room, kPacked, "dof: blurred")});
    for (int i = 0; full && i < 3; ++i) {
        full = half(*full);
        halves.push_back(image(device, *full, vk::Format::eR16G16B16A16Sfloat, "dof: halved"));
    }
}

/// Grid O halved until it is B, which ends up in the last of the images used.
void Dof::recordDown(gpu::Recorder& rec, const Inputs& in, const shared::DofParams& lens,
                     gpu::View color) const {
    gpu::View from = color;
    vk::Extent2D size{in.grid.fullSize.x, in.grid.fullSize.y};
    const auto times = static_cast<std::size_t>(std::lround(std::log2(in.grid.rate.x)));
    for (std::size_t i = 0; i < times; ++i) {
        const gpu::View to = halves[i];
        rec.dispatch(down, gpu::groups8x8(half(size)),
                     {{from, pointSampler}, {in.depth, pointSampler}, to},
                     shared::DofDownParams{
                         .lens = lens, .size = {size.width, size.height}, .first = i == 0});
        rec.barrier(Stage::compute, Stage::compute);
        from = to;
        size = half(size);
    }
}

/// Each of the blurred pictures is made of the one before, and of half its size where its blur
/// hides that: `careful`, as REF does and where B is O, well so, and the first is of the size of B.
Dof::Plan Dof::plan(float sigma, bool careful) {
    constexpr float kNone = 0.3f;     // a blur that gives the next texel under 1/200
    constexpr float kOfGrid = 0.25f;  // σ² of a texel's footprint and of the way back to grid O
    Plan plans;
    float had = kOfGrid;
    std::uint32_t texel = 1;  // of what is read, in texels of B
    for (std::size_t i = 0; i < plans.size(); ++i) {
        const float s = sigma * static_cast<float>(1 << i) / 4;
        Blur& blur = plans[i];
        const float halves = s / static_cast<float>(texel);
        blur.step = (careful ? i > 0 && halves >= 2 : halves >= kHalves) ? 2 : 1;
        const auto unit = static_cast<float>(texel);
        texel *= blur.step;
        blur.texel = texel;
        // Of texels that are larger the way back blurs too.
        const float back = static_cast<float>(texel * texel - 1) / 6;
        const float wanted = std::max(s * s - back - had, 0.0f);
        blur.sigma = std::max(std::sqrt(wanted) / unit, blur.step == 2 ? 0.5f : 0.0f);
        if (blur.sigma < kNone) blur.sigma = 0;
        had += blur.sigma * blur.sigma * unit * unit;
    }
    return plans;
}

std::array<gpu::View, 3> Dof::recordBlur(gpu::Recorder& rec, vk::Extent2D size, const Plan& x,
                                         const Plan& y) const {
    std::array<gpu::View, 3> made;
    gpu::View from = sharp;
    vk::Extent2D fromSize = size;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (x[i].sigma == 0 && y[i].sigma == 0) {
            made[i] = from;
            continue;
        }
        const vk::Extent2D across{gpu::groups(fromSize.width, x[i].step), fromSize.height};
        const vk::Extent2D to{across.width, gpu::groups(fromSize.height, y[i].step)};
        const auto along = [](vk::Extent2D wide, vk::Extent2D read, glm::uvec2 axis, Blur by) {
            const float square = by.sigma * by.sigma;  // 0: the texel alone
            return shared::DofBlurParams{
                .size = {wide.width, wide.height},
                .fromSize = {read.width, read.height},
                .axis = axis,
                .step = by.step,
                .reach = static_cast<std::uint32_t>(std::ceil(2.5f * by.sigma)),
                .falloff = square > 0 ? 1.44269504f / (2 * square) : 0};
        };
        rec.dispatch(blur, gpu::groups8x8(across), {{from, pointSampler}, levels[i].across},
                     along(across, fromSize, {1, 0}, x[i]));
        rec.barrier(Stage::compute, Stage::compute);
        rec.dispatch(blur, gpu::groups8x8(to),
                     {{levels[i].across, pointSampler}, levels[i].blurred},
                     along(to, across, {0, 1}, y[i]));
        rec.barrier(Stage::compute, Stage::compute);
        made[i] = from = levels[i].blurred;
        fromSize = to;
    }
    return made;
}

void Dof::record(gpu::Recorder& rec, const Inputs& in, const DofOptions& o, gpu::View color) const {
    require(o.focus > 0 && std::isfinite(o.focus), "DofOptions::focus must be > 0");
    require(o.sharp >= 0 && std::isfinite(o.full) && o.full > o.sharp,
            "DofOptions::full must be > sharp ≥ 0");
    require(o.degree >= 0 && std::isfinite(o.degree), "DofOptions::degree must be ≥ 0");
    require(o.radius > 0 && o.radius <= 0.1f, "DofOptions::radius must be 0 … 0.1");
    require(in.pixelAspect > 0 && std::isfinite(in.pixelAspect), "Dof: pixelAspect must be > 0");
    const float rate = in.grid.rate.x;
    const bool downsamples = !halves.empty() && rate != 1;
    require(!downsamples || rate == 2 || rate == 4 || rate == 8,
            "Dof: downsampled colours need a rate of 2, 4 or 8");
    shared::DofParams params{.grid = in.grid,
                             .focus = o.focus,
                             .sharp = o.sharp,
                             .slope = o.degree / (o.full - o.sharp),
                             .thesis = o.formula == CocFormula::thesis,
                             .cocFalloff = in.bilateral ? kCocFalloff : 0};
    const float sigma = o.radius * static_cast<float>(in.grid.fullSize.y) / 2;
    const bool careful = downsamples || rate <= 1;
    const Plan x = plan(sigma / (in.pixelAspect * in.grid.rate.x), careful),
               y = plan(sigma / in.grid.rate.y, careful);
    params.stepsX = {x[0].texel, x[1].texel, x[2].texel};
    params.stepsY = {y[0].texel, y[1].texel, y[2].texel};
    const vk::Extent2D size{in.grid.size.x, in.grid.size.y};
    const vk::Extent3D groups = gpu::groups8x8(size);
    const gpu::View blurred = levels[0].across;  // no longer needed by then
    {
        const auto pass = rec.pass("dof");
        gpu::View from = color;
        if (downsamples) {
            recordDown(rec, in, params, color);
            from = halves[static_cast<std::size_t>(std::lround(std::log2(rate))) - 1];
        }
        const gpu::Kernel& layers = downsamples              ? layersOfDown
                                    : hasQuads(in.grid.rate) ? layersOfQuads
                                                             : layersOfPixels;
        rec.dispatch(layers, groups,
                     {{from, linearSampler}, {in.depth, linearSampler}, cocs, sharp}, params);
        rec.barrier(Stage::compute, Stage::compute);
        const auto pictures = recordBlur(rec, size, x, y);
        rec.dispatch(resolve, groups,
                     {{cocs, pointSampler},
                      {pictures[0], pointSampler},
                      {pictures[1], pointSampler},
                      {pictures[2], pointSampler},
                      blurred},
                     params);
        rec.barrier(Stage::compute, Stage::compute);
    }
    const auto pass = rec.pass("dof combine");
    const bool blocks = isMultiple(in.grid.rate, 4);
    const std::uint32_t side = blocks ? kBlock : 1;
    rec.dispatch(blocks ? combineBlocks : combine,
                 gpu::groups8x8({gpu::groups(in.grid.fullSize.x, side),
                                 gpu::groups(in.grid.fullSize.y, side)}),
                 {{in.depth, pointSampler}, {blurred, pointSampler}, color}, params);
}

}  // namespace lodestar::post
