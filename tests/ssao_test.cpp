// SPDX-License-Identifier: Apache-2.0
// Ambient occlusion and the depths it is made of, against their references.
#include <random>

#include <glm/gtc/packing.hpp>

#include <lodestar/shared/octahedral.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/post/effective.hpp>
#include <lodestar/post/max_depth.hpp>
#include <lodestar/post/post_reference.hpp>
#include <lodestar/post/ssao.hpp>

#include "post_fixture.hpp"

namespace lodestar::post {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::ivec2;
using glm::vec3;
using Usage = vk::ImageUsageFlagBits;

class SsaoTest : public PostTest {
protected:
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

TEST_F(SsaoTest, ssaoEqualsTheReferenceAndReadsNothingBesideItsGrid) {
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

TEST_F(SsaoTest, aPlaneOccludesNothing) {
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

TEST_F(SsaoTest, nearThingsLeaveNoHaloOnWhatIsFarBehindThem) {
    Room r = room({64, 48}, 1);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            r.depth[r.grid.index({x, y})] = x < 30 ? 2 : 20;  // a card before a wall
            r.normal[r.grid.index({x, y})] = {0, 0, 1};
        }
    for (const double occlusion : runSsao(r, {.radius = 3, .bias = 0})) EXPECT_EQ(occlusion, 0);
}

TEST_F(SsaoTest, maxDepthKeepsTheFarthestOfEachTexel) {
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

}  // namespace
}  // namespace lodestar::post
