// SPDX-License-Identifier: Apache-2.0
// The effects, alone against their references, and in frames.
#include <random>

#include <glm/gtc/packing.hpp>

#include <lodestar/shared/octahedral.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/post/dof.hpp>
#include <lodestar/post/effective.hpp>
#include <lodestar/post/max_depth.hpp>
#include <lodestar/post/motion_blur.hpp>
#include <lodestar/post/post_reference.hpp>
#include <lodestar/post/ssao.hpp>
#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::post {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::ivec2;
using glm::vec3;
using Usage = vk::ImageUsageFlagBits;

vk::Extent2D extentOf(ivec2 size) {
    return {std::uint32_t(size.x), std::uint32_t(size.y)};
}

class PostTest : public GpuTest {
protected:
    /// `live` in the corner of a target of `whole`, whose rest is `rest`.
    template <typename T>
    static gpu::Image target(vk::Format format, ivec2 live, ivec2 whole, const std::vector<T>& in,
                             T rest) {
        std::vector<T> texels(std::size_t(whole.x) * whole.y, rest);
        for (int y = 0; y < live.y && !in.empty(); ++y)
            for (int x = 0; x < live.x; ++x)
                texels[std::size_t(y) * whole.x + x] = in[std::size_t(y) * live.x + x];
        gpu::Image made(device(), {.name = "test",
                                   .format = format,
                                   .extent = extentOf(whole),
                                   .usage = Usage::eSampled | Usage::eStorage |
                                            Usage::eTransferDst | Usage::eTransferSrc});
        gpu::uploadImage(device(), made, 0, std::as_bytes(std::span(texels)));
        return made;
    }
    static gpu::Image depths(ivec2 live, ivec2 whole, const std::vector<float>& z) {
        return target(vk::Format::eR32Sfloat, live, whole, z, NAN);
    }
    static gpu::Image colors(ivec2 live, ivec2 whole, const std::vector<vec3>& rgb) {
        std::vector<std::uint64_t> halves;
        for (const vec3& c : rgb) halves.push_back(glm::packHalf4x16(glm::vec4(c, 1)));
        return target(vk::Format::eR16G16B16A16Sfloat, live, whole, halves,
                      glm::packHalf4x16(glm::vec4(NAN)));
    }
    static std::vector<vec3> readColors(const gpu::Image& image, ivec2 live) {
        std::vector<vec3> rgb;
        for (const auto bits :
             gpu::as<std::uint64_t>(gpu::readImage(device(), part(image, extentOf(live)))))
            rgb.emplace_back(glm::unpackHalf4x16(bits));
        return rgb;
    }

    static constexpr glm::vec2 kClipScale{1.2f, -1.6f};
    static gpu::Buffer view(glm::vec2 jitter = {0, 0}) {
        gpu::Buffer buffer(device(), "view", sizeof(shared::ViewParams), gpu::Residence::mapped);
        *buffer.mapped<shared::ViewParams>() = {.clipScale = kClipScale, .jitter = jitter};
        return buffer;
    }

    /// Guides of a floor, a wall and a ball before them, seen on grid B.
    struct Room {
        reference::Grid grid;
        std::vector<double> depth;
        std::vector<dvec3> normal;
    };
    static Room room(ivec2 full, double rate, bool sky = false) {
        Room r;
        r.grid.fullSize = full;
        r.grid.rate = dvec2(rate);
        r.grid.size = ivec2(glm::ceil(dvec2(full) / rate));
        r.grid.clipScale = dvec2(kClipScale);
        for (int y = 0; y < r.grid.size.y; ++y)
            for (int x = 0; x < r.grid.size.x; ++x) {
                const dvec3 ray = r.grid.viewPoint({x, y}, 1);
                double z = sky ? 0 : 8;
                dvec3 n(0, 0, 1);
                if (ray.y < 0 && -1.5 / ray.y < (sky ? 1e3 : 8)) {
                    z = -1.5 / ray.y;
                    n = {0, 1, 0};
                }
                const dvec3 centre(0.4, -0.9, -5);
                const double b = glm::dot(ray, centre), a = glm::dot(ray, ray);
                const double d = b * b - a * (glm::dot(centre, centre) - 0.49);
                if (d > 0) {
                    const double at = (b - std::sqrt(d)) / a;
                    z = at;
                    n = glm::normalize(ray * at - centre);
                }
                r.depth.push_back(float(z));
                r.normal.push_back(dvec3(shared::unpackNormal(shared::packNormal(vec3(n)))));
            }
        return r;
    }
    static std::vector<double> runSsao(const Room& r, const SsaoOptions& options) {
        const ivec2 size = r.grid.size, whole = size + ivec2(3, 5);
        std::vector<std::uint32_t> normals;
        for (const dvec3& n : r.normal) normals.push_back(shared::packNormal(vec3(n)));
        const gpu::Image depth =
            depths(size, whole, std::vector<float>(r.depth.begin(), r.depth.end()));
        const gpu::Image normal = target(vk::Format::eR32Uint, size, whole, normals, 0xffffffffu);
        const auto packed = [&] {
            return target(vk::Format::eR32G32B32A32Uint, size, whole, std::vector<glm::uvec4>{},
                          glm::uvec4(0xffffffffu));  // NaN
        };
        const gpu::Image scratch = packed(), result = packed();
        const gpu::Buffer eye = view();
        const Ssao pass(device());
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(
            rec,
            {eye, depth, normal,
             effectiveGrid(extentOf(size), extentOf(r.grid.fullSize), glm::vec2(r.grid.rate))},
            options, scratch, result);
        rec.submit();
        std::vector<double> made;
        for (const glm::uvec4& t :
             gpu::as<glm::uvec4>(gpu::readImage(device(), part(result, extentOf(size)))))
            made.push_back(glm::unpackHalf2x16(t.y).y);
        return made;
    }
};

TEST_F(PostTest, ssaoEqualsTheReferenceAndReadsNothingBesideItsGrid) {
    for (const auto& [full, rate] : {std::pair{ivec2(17, 33), 1.0},
                                     {ivec2(61, 40), 2.0},
                                     {ivec2(90, 71), 4.0},
                                     {ivec2(1, 1), 1.0}})
        for (const SsaoOptions& options :
             {SsaoOptions{.radius = 1}, SsaoOptions{.radius = 2.5f, .bias = 0, .samples = 30}}) {
            const Room r = room(full, rate, rate == 2.0);
            const auto wanted = reference::ssao(r.grid, r.depth, r.normal, options);
            const auto made = runSsao(r, options);
            std::size_t off = 0;
            double sum = 0;
            for (std::size_t i = 0; i < made.size(); ++i) {
                // A sample may round to the texel beside: one of 9 · samples.
                if (!(std::abs(made[i] - wanted[i]) < 2e-3)) ++off;
                ASSERT_NEAR(made[i], wanted[i], 0.08) << full.x << " " << i;
                sum += wanted[i];
            }
            EXPECT_LE(off, made.size() / 25) << full.x;
            if (full.x > 1) {
                EXPECT_GT(sum / double(made.size()), 0.004);
            }
        }
}

TEST_F(PostTest, aPlaneOccludesNothing) {
    Room r = room({40, 30}, 1);
    const dvec3 n = glm::normalize(dvec3(0.3, 0.5, 0.8));
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            const dvec3 ray = r.grid.viewPoint({x, y}, 1);
            r.depth[r.grid.index({x, y})] = float(glm::dot(n, dvec3(0, 0, -4)) / glm::dot(n, ray));
        }
    std::fill(r.normal.begin(), r.normal.end(), n);
    for (const double occlusion : runSsao(r, {.radius = 1})) EXPECT_EQ(occlusion, 0);
}

TEST_F(PostTest, nearThingsLeaveNoHaloOnWhatIsFarBehindThem) {
    Room r = room({64, 48}, 1);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            r.depth[r.grid.index({x, y})] = x < 30 ? 2 : 20;  // a card before a wall
            r.normal[r.grid.index({x, y})] = {0, 0, 1};
        }
    for (const double occlusion : runSsao(r, {.radius = 3, .bias = 0})) EXPECT_EQ(occlusion, 0);
}

TEST_F(PostTest, maxDepthKeepsTheFarthestOfEachTexel) {
    const ivec2 full(21, 14), whole(24, 16);
    std::mt19937 engine(3);
    std::vector<float> z;
    std::vector<std::uint32_t> normals;
    for (int i = 0; i < full.x * full.y; ++i) {
        z.push_back(engine() % 40 == 0 ? 0 : 1 + float(engine() % 1000) / 100);
        normals.push_back(std::uint32_t(i));
    }
    const gpu::Image depth = depths(full, whole, z);
    const gpu::Image normal = target(vk::Format::eR32Uint, full, whole, normals, ~0u);
    for (std::uint32_t times = 1; times <= 3; ++times) {
        const int side = 1 << times;
        const ivec2 size = (full + side - 1) / side;
        const gpu::Image outDepth = depths(size, whole, {});
        const gpu::Image outNormal =
            target(vk::Format::eR32Uint, size, whole, std::vector<std::uint32_t>{}, ~0u);
        const MaxDepth pass(device(), extentOf(whole));
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec, {part(depth, extentOf(full)), part(normal, extentOf(full))}, times,
                    {outDepth, outNormal});
        rec.submit();
        const auto made = gpu::as<float>(gpu::readImage(device(), part(outDepth, extentOf(size))));
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                float most = 0;
                bool background = false;
                for (int v = y * side; v < std::min((y + 1) * side, full.y); ++v)
                    for (int u = x * side; u < std::min((x + 1) * side, full.x); ++u) {
                        most = std::max(most, z[std::size_t(v) * full.x + u]);
                        background |= z[std::size_t(v) * full.x + u] == 0;
                    }
                EXPECT_EQ(made[std::size_t(y) * size.x + x], background ? 0 : most);
            }
    }
}

class DofTest : public PostTest {
protected:
    /// A picture of grid O, blurred from a grid B that sees the middle of each of its texels.
    static std::vector<vec3> run(ivec2 full, int side, const std::vector<float>& z,
                                 const std::vector<vec3>& rgb, const DofOptions& options,
                                 bool bilateral = true) {
        const ivec2 size = (full + side - 1) / side, whole = full + ivec2(7, 3);
        std::vector<float> coarse;
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const ivec2 at = glm::min(ivec2(x, y) * side + side / 2, full - 1);
                coarse.push_back(z[std::size_t(at.y) * full.x + at.x]);
            }
        const gpu::Image depth = depths(full, whole, z), depthB = depths(size, whole, coarse);
        const gpu::Image color = colors(full, whole, rgb);
        const Dof pass(device(), extentOf(size + 2));
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec,
                    {depth, depthB, effectiveGrid(extentOf(size), extentOf(full), glm::vec2(side)),
                     bilateral},
                    options, color);
        rec.submit();
        return readColors(color, full);
    }
    static constexpr ivec2 kSize{96, 64};
    /// `left` on one half, `right` on the other.
    template <typename T>
    static std::vector<T> halves(T left, T right) {
        std::vector<T> all;
        for (int i = 0; i < kSize.x * kSize.y; ++i)
            all.push_back(i % kSize.x < kSize.x / 2 ? left : right);
        return all;
    }
    static std::vector<vec3> noise() {
        std::mt19937 engine(5);
        std::vector<vec3> all;
        for (int i = 0; i < kSize.x * kSize.y; ++i)
            all.emplace_back(float(engine() % 256) / 255, float(engine() % 256) / 255, 0.5f);
        return all;
    }
    static double spread(const std::vector<vec3>& rgb, int x0, int x1) {
        double sum = 0, squares = 0;
        int n = 0;
        for (int y = 12; y < kSize.y - 12; ++y)
            for (int x = x0; x < x1; ++x, ++n) {
                const double v = rgb[std::size_t(y) * kSize.x + x].x;
                sum += v;
                squares += v * v;
            }
        return squares / n - sum / n * (sum / n);
    }
    static constexpr DofOptions kLens{.focus = 5, .sharp = 0.5f, .full = 3, .radius = 0.1f};
};

TEST_F(DofTest, whatIsInFocusStaysAsItIs) {
    const auto rgb = noise();
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(5.0f, 5.4f), rgb, kLens);
        for (std::size_t i = 0; i < made.size(); ++i)
            ASSERT_NEAR(made[i].x, rgb[i].x, 1e-3) << side;
    }
}

TEST_F(DofTest, evenColorsStayEvenUpToTheEdgeOfTheLivePart) {
    const std::vector<vec3> grey(std::size_t(kSize.x) * kSize.y, vec3(0.5f, 2, 30));
    for (const int side : {1, 2, 4, 8})
        for (const auto& z : {halves(9.0f, 9.0f), halves(1.0f, 1.0f), halves(0.0f, 6.5f),
                              halves(2.0f, 7.0f), halves(4.1f, 0.0f)})
            for (const vec3& c : run(kSize, side, z, grey, kLens)) {
                ASSERT_NEAR(c.x, 0.5, 0.01) << side;
                ASSERT_NEAR(c.z, 30, 0.6) << side;
            }
}

TEST_F(DofTest, bothSidesOfTheFocusBlurAndTheThesisFormulaSparesTheNearOne) {
    const auto rgb = noise();
    const double before = spread(rgb, 8, 40);
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(1.5f, 9.0f), rgb, kLens);
        EXPECT_LT(spread(made, 8, 36), 0.1 * before) << side;
        EXPECT_LT(spread(made, 60, 88), 0.1 * before) << side;
        DofOptions thesis = kLens;
        thesis.formula = CocFormula::thesis;
        const auto printed = run(kSize, side, halves(1.5f, 9.0f), rgb, thesis);
        for (int x = 0; x < kSize.x / 2; ++x)
            ASSERT_NEAR(printed[std::size_t(30 * kSize.x + x)].x,
                        rgb[std::size_t(30 * kSize.x + x)].x, 1e-3);
        EXPECT_LT(spread(printed, 60, 88), 0.1 * before);
    }
}

TEST_F(DofTest, blurGrowsWithTheCircleOfConfusion) {
    const auto rgb = noise();
    double last = 1;
    for (const float z : {5.2f, 6.2f, 7.0f, 8.0f}) {
        const double now = spread(run(kSize, 2, halves(z, z), rgb, kLens), 8, 88);
        EXPECT_LT(now, last) << z;
        last = now;
    }
}

TEST_F(DofTest, noFocusLeaksIntoTheBlurBehindIt) {
    // Sharp and white before a black wall far behind.
    const int middle = kSize.x / 2;
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(5.0f, 12.0f), halves(vec3(1), vec3(0)), kLens);
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                const float v = made[std::size_t(y * kSize.x + x)].x;
                ASSERT_TRUE(x < middle ? v == 1 : v < 0.06) << side << " " << x << " " << v;
            }
    }
}

TEST_F(DofTest, theForegroundBleedsOverItsEdge) {
    // White and near before black in focus: its edge is soft, to both sides.
    const int middle = kSize.x / 2;
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(1.5f, 5.0f), halves(vec3(1), vec3(0)), kLens);
        const auto at = [&](int x) { return made[std::size_t(32 * kSize.x + x)].x; };
        EXPECT_GT(at(middle + 1), 0.25) << side;
        EXPECT_LT(at(middle - 2), 0.8) << side;
        EXPECT_GT(at(middle - 14), 0.97) << side;
        EXPECT_LT(at(middle + 14), 0.03) << side;
        for (int x = middle - 14; x < middle + 14; ++x) {
            EXPECT_LE(at(x + 1), at(x) + 0.01) << side;
            EXPECT_LT(at(x) - at(x + 1), 0.25) << side << " " << x;  // no step at the edge
        }
    }
}

TEST_F(DofTest, refusesOptionsOutOfRange) {
    const auto rgb = noise();
    const auto z = halves(1.0f, 2.0f);
    const auto with = [&](auto change) {
        DofOptions o = kLens;
        change(o);
        run(kSize, 1, z, rgb, o);
    };
    EXPECT_THROW(with([](auto& o) { o.focus = 0; }), std::invalid_argument);
    EXPECT_THROW(with([](auto& o) { o.full = o.sharp; }), std::invalid_argument);
    EXPECT_THROW(with([](auto& o) { o.radius = 0.2f; }), std::invalid_argument);
    EXPECT_THROW(with([](auto& o) { o.degree = NAN; }), std::invalid_argument);
}

class MotionBlurTest : public PostTest {
protected:
    static constexpr ivec2 kSize{128, 40};
    static constexpr int kEdge = 64;
    /// What lies left and right of the edge: colour, depth, and pixels moved since the last frame.
    struct Side {
        float color, depth, moved;
    };
    static std::vector<float> run(int side, const Side& left, const Side& right,
                                  float shutter = 1) {
        std::vector<vec3> rgb;
        std::vector<float> z;
        std::vector<glm::vec4> motion;
        for (int i = 0; i < kSize.x * kSize.y; ++i) {
            const Side& here = i % kSize.x < kEdge ? left : right;
            rgb.emplace_back(here.color);
            z.push_back(here.depth);
            motion.emplace_back(here.moved / float(kSize.x), 0, here.depth, 1);
        }
        const ivec2 size = (kSize + side - 1) / side, whole = kSize + ivec2(9, 5);
        const gpu::Image color = colors(kSize, whole, rgb), depth = depths(kSize, whole, z);
        const gpu::Image moved =
            target(vk::Format::eR32G32B32A32Sfloat, kSize, whole, motion, glm::vec4(NAN));
        const MotionBlur pass(device(), extentOf(size + 3));
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec,
                    {depth, moved, effectiveGrid(extentOf(size), extentOf(kSize), glm::vec2(side))},
                    shutter, color);
        rec.submit();
        std::vector<float> columns(kSize.x, 0.0f);  // means: taps are offset from row to row
        const auto made = readColors(color, kSize);
        for (int x = 0; x < kSize.x; ++x)
            for (int y = 0; y < kSize.y; ++y)
                columns[x] += made[std::size_t(y * kSize.x + x)].x / float(kSize.y);
        return columns;
    }
};

TEST_F(MotionBlurTest, whatDoesNotMoveStaysAsItIs) {
    for (const int side : {1, 2, 4}) {
        const auto still = run(side, {1, 3, 0}, {0, 9, 0});
        const auto shut = run(side, {1, 3, 20}, {0, 9, 20}, 0);
        for (int x = 0; x < kSize.x; ++x) {
            ASSERT_EQ(still[x] > 0.5f, x < kEdge);
            ASSERT_NEAR(std::abs(still[x] - 0.5f), 0.5, 1e-4);
            ASSERT_NEAR(shut[x], still[x], 1e-4);
        }
    }
}

TEST_F(MotionBlurTest, anEdgeThatMovesBecomesARampAsLongAsItsWay) {
    for (const int side : {1, 2}) {
        // Half of the shutter's time: 20 pixels moved leave a streak of 10.
        for (const float shutter : {1.0f, 0.5f}) {
            const float reach = 10 * shutter;
            const auto made = run(side, {1, 5, 20}, {0, 5, 20}, shutter);
            for (int x = 0; x < kSize.x; ++x) {
                const float wanted =
                    std::clamp(0.5f - (float(x) + 0.5f - kEdge) / (2 * reach), 0.0f, 1.0f);
                ASSERT_NEAR(made[x], wanted, 0.12) << side << " " << x;
            }
        }
    }
}

TEST_F(MotionBlurTest, aNearThingThatMovesBlursOverWhatIsBehindToBothSides) {
    for (const int side : {1, 2, 4}) {
        const auto made = run(side, {1, 2, 20}, {0, 9, 0});
        EXPECT_LT(made[kEdge - 3], 0.9) << side;
        EXPECT_GT(made[kEdge + 3], 0.1) << side;
        EXPECT_GT(made[kEdge - 16], 0.99) << side;
        EXPECT_LT(made[kEdge + 16], 0.01) << side;
    }
}

TEST_F(MotionBlurTest, whatMovesBehindLeavesAStillEdgeSharp) {
    for (const int side : {1, 2, 4}) {
        const auto made = run(side, {1, 2, 0}, {0, 9, 20});
        for (int x = 0; x < kEdge; ++x) ASSERT_NEAR(made[x], 1, 2e-3) << side << " " << x;
    }
}

TEST_F(MotionBlurTest, evenColorsStayEvenUpToTheEdgeOfTheLivePart) {
    for (const int side : {1, 2, 4, 8})
        for (const float moved : {3.0f, -40.0f, 500.0f})
            for (const float v : run(side, {2, 5, moved}, {2, 3, -moved}))
                ASSERT_NEAR(v, 2, 0.01) << side;
}

// In frames.

class PostFrameTest : public GpuTest {
protected:
    PostFrameTest() : source(*scene::buildBuiltin("columns")) {}
    void SetUp() override {
        GpuTest::SetUp();
        if (testing::Test::IsSkipped()) return;
        onGpu.emplace(device(), source);
        camera = scene::frame(onGpu->bounds(), 1.5f);
    }
    static frame::FrameSettings settings(bool ssao, bool dof) {
        frame::FrameSettings s{.size = {144, 96}, .shadowMapSize = 128, .skyMapSize = 64};
        s.post.ssao = ssao;
        s.post.occlusion = {.radius = 6, .strength = 4};
        if (dof) s.post.dof = DofOptions{.sharp = 0.2f, .full = 2, .radius = 0.1f};
        return s;
    }
    static std::vector<vec3> radianceOf(const frame::Frame& frame) {
        std::vector<vec3> rgb;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device(), frame.radiance())))
            rgb.emplace_back(glm::unpackHalf4x16(bits));
        return rgb;
    }
    static double distance(const std::vector<vec3>& a, const std::vector<vec3>& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            sum += glm::distance(glm::min(a[i], vec3(4)), glm::min(b[i], vec3(4)));
        return sum / double(a.size());
    }

    scene::Scene source;
    std::optional<scene::GpuScene> onGpu;
    scene::Camera camera;
};

TEST_F(PostFrameTest, coarseGridsGiveNearlyWhatTheFinestDoes) {
    for (const auto& [ssao, dof] : {std::pair{true, false}, {false, true}}) {
        frame::Frame plain(device(), *onGpu, settings(false, false));
        plain.render(camera, {});
        const auto without = radianceOf(plain);
        frame::Frame frame(device(), *onGpu, settings(ssao, dof));
        frame.render(camera, {});
        const auto fine = radianceOf(frame);
        const double effect = distance(without, fine);
        EXPECT_GT(effect, 5e-4) << ssao;
        for (const std::uint32_t rate : {4u, 16u}) {
            frame.render(camera, {.postRates = {rate, rate, rate}});
            EXPECT_LT(distance(radianceOf(frame), fine), (rate == 4 ? 0.5 : 0.8) * effect)
                << ssao << " " << rate;
        }
        EXPECT_THROW(frame.render(camera, {.postRates = {2, 2, 2}}), std::invalid_argument);
    }
}

TEST_F(PostFrameTest, ssaoOnlyTakesLightAway) {
    frame::Frame plain(device(), *onGpu, settings(false, false));
    plain.render(camera, {});
    const auto without = radianceOf(plain);
    frame::Frame frame(device(), *onGpu, settings(true, false));
    frame.render(camera, {.postRates = {4, 4, 4}});
    const auto with = radianceOf(frame);
    for (std::size_t i = 0; i < with.size(); ++i) ASSERT_LE(with[i].y, without[i].y * 1.001f);
}

TEST_F(PostFrameTest, theSameFrameGivesTheSameBytesAtAnyScaleItComesFrom) {
    frame::FrameSettings s = settings(true, true);
    s.maxScale = 1.5f;
    const budget::Levers levers{.postRates = {4, 16, 4}};
    frame::Frame large(device(), *onGpu, s);
    budget::Levers scaled = levers;
    scaled.renderScale = 1.5f;
    large.render(camera, scaled);  // what the unused part then holds
    scaled.renderScale = 0.5f;
    large.render(camera, scaled);
    const auto first = gpu::readImage(device(), large.radiance());
    large.render(camera, scaled);
    EXPECT_EQ(gpu::readImage(device(), large.radiance()), first);
    s.size = vk::Extent2D{72, 48};
    s.maxScale = 1;
    frame::Frame alone(device(), *onGpu, s);
    alone.render(camera, levers);
    EXPECT_EQ(gpu::readImage(device(), alone.radiance()), first);
}

TEST_F(PostFrameTest, recordsGiveTheirRepresentativesToTheEffects) {
    frame::CaptureFrame capture(device(), *onGpu, {.base = {72, 48}, .side = 2});
    capture.capture(camera);
    frame::Frame frame(device(), *onGpu, settings(true, true));
    frame.rebuild(capture.compact(), camera, {});
    const auto fine = radianceOf(frame);
    frame.rebuild(capture.compact(), camera, {.postRates = {4, 4, 4}});
    const auto coarse = radianceOf(frame);
    frame::Frame plain(device(), *onGpu, settings(false, false));
    plain.rebuild(capture.compact(), camera, {});
    EXPECT_LT(distance(coarse, fine), 0.5 * distance(fine, radianceOf(plain)));

    frame::FrameSettings s = settings(true, true);
    s.captureSide = 2;
    frame::Frame smooth(device(), *onGpu, s);
    smooth.render(camera, {.postRates = {4, 4, 4}});
    EXPECT_LT(distance(radianceOf(smooth), fine), distance(fine, radianceOf(plain)));
}

TEST_F(PostFrameTest, motionBlurFollowsTheCameraAndForgetsCuts) {
    frame::FrameSettings s = settings(false, false);
    frame::Frame plain(device(), *onGpu, s);
    s.post.shutter = 1;
    frame::Frame frame(device(), *onGpu, s);
    const scene::Camera moved = scene::orbited(camera, camera.at, 0.03f);
    plain.render(moved, {});
    const auto sharp = radianceOf(plain);
    frame.render(camera, {});
    frame.render(moved, {.postRates = {4, 4, 4}});
    EXPECT_GT(distance(radianceOf(frame), sharp), 5e-4);
    frame.render(moved, {});  // still now
    EXPECT_LT(distance(radianceOf(frame), sharp), 1e-4);
    frame.render(camera, {});
    frame.reset();
    frame.render(moved, {});
    EXPECT_LT(distance(radianceOf(frame), sharp), 1e-4);
    s.captureSide = 2;
    EXPECT_THROW(frame::Frame(device(), *onGpu, s), std::invalid_argument);
}

TEST_F(PostFrameTest, downsampledInputsAreThereToCompareWith) {
    frame::Frame frame(device(), *onGpu, settings(true, true));
    frame.render(camera, {});
    const auto fine = radianceOf(frame);
    frame::FrameSettings s = settings(true, true);
    s.post.downsampled = true;
    s.post.bilateral = false;
    frame::Frame reference(device(), *onGpu, s);
    for (const std::uint32_t rate : {1u, 4u, 16u, 64u}) {
        reference.render(camera, {.postRates = {rate, rate, rate}});
        EXPECT_LT(distance(radianceOf(reference), fine), 0.05) << rate;
    }
    s.supersample = 2;
    EXPECT_THROW(frame::Frame(device(), *onGpu, s), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::post
