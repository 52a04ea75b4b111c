// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <lodestar/scene/procedural_parts.hpp>
#include <lodestar/scene/procedural_scenes.hpp>
#include <lodestar/scene/procedural_textures.hpp>

namespace lodestar::scene::procedural {
namespace {

using glm::dvec3;
using std::numbers::pi;

// Plan, in metres: the nave between x = ±4 runs along z, with an aisle to each side.
constexpr int kBays = 10;
constexpr double kBay = 4, kEnd = 0.5 * kBays * kBay;  // from z = −kEnd to kEnd
constexpr double kNave = 4, kAisle = 8;                // x of the two rows of columns on a side
constexpr double kSpring = 4.8;                        // where the arches begin: top of a column
constexpr double kVault = 6.8;                         // where the vault begins: top of the arcade
constexpr double kWall = 0.35;                         // half of the arcade's thickness
constexpr double kArch = 1.5;                          // radius of an arch

struct Materials {
    std::uint32_t floor, stone, brick, mosaic, turf, lattice, plaster, wood, bronze, cloth, glow;
    std::array<std::uint32_t, 5> shown;  // of the pieces on the pedestals
};

std::uint32_t textured(SceneBuilder& builder, std::string name, Surfacing images) {
    Material material = plain(std::move(name), glm::vec3(1), 1, 1);
    material.baseColorTexture = builder.add(std::move(images.baseColor), ColorSpace::srgb);
    material.normalTexture = builder.add(std::move(images.normal), ColorSpace::linear);
    material.metallicRoughnessTexture =
        builder.add(std::move(images.metallicRoughness), ColorSpace::linear);
    return builder.add(std::move(material));
}

Materials addMaterials(SceneBuilder& builder) {
    Materials m{};
    m.floor = textured(builder, "floor", checkerFloor());
    m.stone = textured(builder, "stone", stone());
    m.brick = textured(builder, "brick", bricks());
    m.mosaic = textured(builder, "mosaic", mosaic());
    Material ground = plain("turf", glm::vec3(1), 0, 0.95f);
    ground.baseColorTexture = builder.add(turf(), ColorSpace::srgb);
    m.turf = builder.add(ground);
    Material bars = plain("lattice", glm::vec3(1), 0, 0.6f);
    bars.baseColorTexture = builder.add(lattice(), ColorSpace::srgb);
    bars.alphaMode = AlphaMode::mask;
    bars.doubleSided = true;
    m.lattice = builder.add(bars);
    m.plaster = builder.add(plain("plaster", {0.72f, 0.66f, 0.55f}, 0, 0.85f));
    m.wood = builder.add(plain("wood", {0.20f, 0.11f, 0.055f}, 0, 0.7f));
    m.bronze = builder.add(plain("bronze", {0.55f, 0.36f, 0.18f}, 1, 0.35f));
    Material cloth = plain("cloth", {0.42f, 0.03f, 0.03f}, 0, 0.9f);
    cloth.doubleSided = true;
    m.cloth = builder.add(cloth);
    Material glow = plain("glow", {0.9f, 0.8f, 0.6f}, 0, 0.5f);
    glow.emissive = {8, 5.2f, 2.4f};
    m.glow = builder.add(glow);
    m.shown = {builder.add(plain("gold", {1.0f, 0.71f, 0.29f}, 1, 0.18f)),
               builder.add(plain("copper", {0.93f, 0.53f, 0.38f}, 1, 0.32f)),
               builder.add(plain("chrome", {0.80f, 0.81f, 0.83f}, 1, 0.06f)),
               builder.add(plain("jade", {0.07f, 0.34f, 0.17f}, 0, 0.25f)),
               builder.add(plain("clay", {0.52f, 0.20f, 0.10f}, 0, 0.95f))};
    return m;
}

/// A half-round moulding of the given outer radius, between two heights.
Mesh moulding(double radius, double bottom, double top, std::uint32_t around) {
    const double half = 0.5 * (top - bottom);
    return patch(lathe([=](double v) {
                     return glm::dvec2(radius - half + half * std::sin(pi * v),
                                       bottom + half + half * std::cos(pi * v));
                 }),
                 around, 6, {3, 0.25f});
}

/// A fluted column, kSpring high, standing on the origin.
Mesh column() {
    constexpr int kFlutes = 20;
    constexpr double kFoot = 0.52, kNeck = 4.25;
    Mesh mesh = box({-0.55, 0, -0.55}, {0.55, 0.2, 0.55}, 2);
    append(mesh, moulding(0.53, 0.2, 0.38, 32));
    append(mesh, moulding(0.45, 0.38, kFoot, 32));
    const Surface shaft = [](double u, double v) {
        const double radius = 0.34 + 0.06 * v * (1.6 - 0.6 * v);  // swells towards the foot
        const double flute = radius * (1 - 0.07 * std::abs(std::sin(kFlutes * pi * u)));
        return lathe([&](double w) { return glm::dvec2(flute, glm::mix(kNeck, kFoot, w)); })(u, v);
    };
    append(mesh, patch(shaft, 5 * kFlutes, 6, {2, 3}));
    append(mesh, moulding(0.39, kNeck, kNeck + 0.09, 32));
    append(mesh, patch(lathe([](double v) {  // the cushion under the slab
                           const double rise = std::cos(0.5 * pi * v);
                           return glm::dvec2(0.35 + 0.19 * rise * rise, 4.64 - 0.30 * v);
                       }),
                       40, 6, {3, 0.25f}));
    append(mesh, box({-0.58, 4.64, -0.58}, {0.58, kSpring, 0.58}, 2));
    return mesh;
}

/// One bay of an arcade in the plane x = 0, its arch about the origin of z, from kSpring to kVault.
Mesh archBay() {
    const auto onArch = [](double u) {
        return glm::dvec2(-std::cos(pi * u), std::sin(pi * u));  // z to the right, y up
    };
    // From the arch out to the edge of the bay, along the same angle: its corners are at 45°.
    const Surface face = [&](double u, double v) {
        const glm::dvec2 d = onArch(u);
        const double edge = (kVault - kSpring) / std::max(std::abs(d.x), std::abs(d.y));
        const glm::dvec2 p = glm::mix(edge, kArch, v) * d;
        return dvec3(kWall, kSpring + p.y, -p.x);
    };
    const Surface back = [&](double u, double v) {
        return face(1 - u, v) - dvec3(2 * kWall, 0, 0);
    };
    const Surface soffit = [&](double u, double v) {
        const glm::dvec2 d = kArch * onArch(u);
        return dvec3(glm::mix(kWall, -kWall, v), kSpring + d.y, -d.x);
    };
    Mesh mesh = patch(face, 32, 3, {1, 1});
    append(mesh, patch(back, 32, 3, {1, 1}));
    for (const double z : {-2.0, 1.5})  // what rests on the columns
        append(mesh, patch(rectangle({kWall, kSpring, z}, {-2 * kWall, 0, 0}, {0, 0, 0.5}), 1, 1,
                           {1, 1}));
    projectUv(mesh, 2);
    append(mesh, patch(soffit, 32, 1, {2.5f, 0.35f}));
    // A string course along the top, on the side of the nave and of the aisle.
    for (const double side : {-1.0, 1.0}) {
        const double x = side * (kWall + 0.06);
        append(mesh, box({x - 0.06, kVault - 0.22, -2}, {x + 0.06, kVault - 0.06, 2}, 2));
    }
    return mesh;
}

/// The coffered barrel over the nave, seen from below, with a plain skin above it.
Mesh vault() {
    const auto barrel = [](double radius, double u, double v) {
        return dvec3(radius * std::cos(pi * u), kVault + radius * std::sin(pi * u),
                     glm::mix(-kEnd, kEnd, v));
    };
    const Surface coffers = [&](double u, double v) {
        const auto recess = [](double cells, double t) {
            const double p = std::abs(t * cells - std::floor(t * cells) - 0.5);  // 0 in the middle
            return glm::smoothstep(0.42, 0.18, p);  // a bevel of about two quads
        };
        return barrel(kNave + 0.3 * recess(8, u) * recess(2 * kBays, v), u, v);
    };
    Mesh mesh = patch(coffers, 80, 200, {6, 20});
    append(mesh, patch(inside([&](double u, double v) { return barrel(kNave + 0.5, u, v); }), 24, 1,
                       {6, 20}));
    for (const double end : {1.0, 0.0}) {  // the ring between the two at either end
        const Surface ring = [&, end](double u, double v) {
            return barrel(kNave + 0.5 * (1 - v), u, end);
        };
        append(mesh, patch(end > 0 ? inside(ring) : ring, 24, 1, {6, 0.25f}));
    }
    return mesh;
}

/// The half-round end of the nave with its half dome, seen from within, and a skin around it.
Mesh apse() {
    const auto wall = [](double radius) {
        return Surface([radius](double u, double v) {
            const double a = pi * u;
            return dvec3(radius * std::cos(a), kVault * (1 - v), -kEnd - radius * std::sin(a));
        });
    };
    const auto dome = [](double radius) {
        return Surface([radius](double u, double v) {
            const double a = pi * u, rise = 0.5 * pi * (1 - v);
            return dvec3(radius * std::cos(a) * std::cos(rise), kVault + radius * std::sin(rise),
                         -kEnd - radius * std::sin(a) * std::cos(rise));
        });
    };
    Mesh mesh;
    append(mesh, patch(inside(wall(kNave)), 40, 12, {6, 4}));
    append(mesh, patch(inside(dome(kNave)), 40, 16, {6, 4}));
    append(mesh, patch(wall(kNave + 0.4), 24, 1, {6, 4}));
    append(mesh, patch(dome(kNave + 0.4), 24, 8, {6, 4}));
    return mesh;
}

/// A balustrade along one bay: thin bars between two rails.
Mesh railing() {
    Mesh mesh;
    for (const double height : {0.12, 0.95})
        append(mesh, patch(rod({0, height, -1.5}, {0, height, 1.5}, height > 0.5 ? 0.03 : 0.015),
                           10, 1, {1, 12}));
    for (int i = 0; i < 25; ++i) {
        const double z = -1.5 + 0.125 * i;
        append(mesh, patch(rod({0, 0, z}, {0, 0.95, z}, i % 8 == 0 ? 0.02 : 0.008), 6, 1, {1, 4}));
        if (i % 8 == 4) {
            Mesh knob = patch(sphere(0.03), 10, 6, {1, 1});
            for (Vertex& vertex : knob.vertices) vertex.position += glm::vec3(0, 0.5f, float(z));
            append(mesh, knob);
        }
    }
    return mesh;
}

constexpr double kLampRadius = 0.7, kLampHeight = 3.6;
constexpr int kBulbs = 8;

/// A hoop on thin cables from the crown of the vault.
Mesh lampHoop() {
    const double top = kVault + kNave + 0.2, knot = kLampHeight + 1.1;
    Mesh mesh = patch(lathe([](double v) {
                          const double a = 2 * pi * v;
                          return glm::dvec2(kLampRadius + 0.03 * std::sin(a),
                                            kLampHeight + 0.03 * std::cos(a));
                      }),
                      40, 8, {12, 1});
    append(mesh, patch(rod({0, knot, 0}, {0, top, 0}, 0.012), 6, 1, {1, 20}));
    for (int i = 0; i < 4; ++i) {
        const double a = 0.5 * pi * i;
        append(mesh, patch(rod({kLampRadius * std::cos(a), kLampHeight, kLampRadius * std::sin(a)},
                               {0, knot, 0}, 0.006),
                           6, 1, {1, 8}));
    }
    return mesh;
}

Mesh lampBulbs() {
    const Mesh bulb = patch(sphere(0.07), 12, 8, {1, 1});
    Mesh mesh;
    for (int i = 0; i < kBulbs; ++i) {
        const double a = 2 * pi * (i + 0.5) / kBulbs;
        Mesh placed = bulb;
        for (Vertex& vertex : placed.vertices)
            vertex.position +=
                glm::vec3(kLampRadius * std::cos(a), kLampHeight + 0.09, kLampRadius * std::sin(a));
        append(mesh, placed);
    }
    return mesh;
}

/// A hanging 0.9 m wide and 2.2 m long, in folds that grow downwards.
Mesh banner() {
    return patch(
        [](double u, double v) {
            return dvec3(0.9 * (u - 0.5), -2.2 * v,
                         (0.02 + 0.07 * v) * std::sin(5 * pi * u + 2 * v));
        },
        36, 12, {1, 2});
}

Mesh vase() {
    return patch(lathe([](double v) {
                     const double body = std::sin(pi * std::pow(std::max(v, 0.0), 1.4));
                     return glm::dvec2(0.10 + 0.24 * body * body + 0.05 * std::exp(-30 * v),
                                       0.95 * (1 - v));
                 }),
                 48, 32, {3, 2});
}

void placeArchitecture(SceneBuilder& builder, const Materials& m) {
    const std::uint32_t shaft = builder.add("column", column(), m.stone);
    const std::uint32_t arch = builder.add("arch", archBay(), m.stone);
    const std::uint32_t bars = builder.add("railing", railing(), m.bronze);
    for (int i = 0; i < kBays; ++i) {
        const auto z = static_cast<float>((i + 0.5) * kBay - kEnd);
        for (const double x : {-kNave, kNave, kAisle}) builder.place(shaft, {x, 0, z});
        if (i + 1 == kBays) break;
        for (const double x : {-kNave, kNave}) builder.place(arch, {x, 0, z + 0.5 * kBay});
        builder.place(bars, {kAisle, 0, z + 0.5 * kBay});
    }
    // Half bays at both ends of the arcades: solid piers up to the vault.
    Mesh piers;
    for (const double x : {-kNave, kNave})
        for (const double z : {-kEnd, kEnd - 1.42})
            append(piers, box({x - kWall, 0, z}, {x + kWall, kVault, z + 1.42}, 2));
    for (const double x : {-kNave, kNave})  // and what the last columns carry
        for (const double z : {-kEnd + 1.42, kEnd - 2})
            append(piers, box({x - kWall, kSpring, z}, {x + kWall, kVault, z + 0.58}, 2));
    builder.place(builder.add("piers", piers, m.stone));
    builder.place(builder.add("vault", vault(), m.plaster));
    builder.place(builder.add("apse", apse(), m.mosaic));

    Mesh brick = box({-kAisle - 0.8, 0, -kEnd}, {-kAisle - 0.4, 5.6, kEnd}, 2);
    append(brick, box({-kAisle - 0.4, 0, -kEnd - 0.4}, {-kNave - kWall, 5.6, -kEnd}, 2));
    builder.place(builder.add("outer wall", brick, m.brick));
    Mesh slabs = box({-kAisle - 0.8, 5.6, -kEnd - 0.4}, {-kNave - kWall, 5.85, kEnd}, 2);
    append(slabs, box({kAisle - 0.3, kSpring, -kEnd}, {kAisle + 0.3, kSpring + 0.35, kEnd}, 2));
    builder.place(builder.add("aisle roof and beam", slabs, m.plaster));
    const std::uint32_t rafter = builder.add(
        "rafter",
        box({kNave + kWall, kSpring + 0.35, -0.07}, {kAisle + 0.7, kSpring + 0.55, 0.07}, 2),
        m.wood);
    for (int i = 0; i < 5 * kBays; ++i)
        builder.place(rafter, {0, 0, static_cast<float>((i + 0.5) * kBay / 5 - kEnd)});
}

void placeGround(SceneBuilder& builder, const Materials& m) {
    const double west = -kAisle - 0.8, east = kAisle + 0.8, north = -kEnd - kNave;
    builder.place(
        builder.add("floor",
                    patch(rectangle({west, 0, north}, {east - west, 0, 0}, {0, 0, kEnd - north}),
                          18, 44, {float((east - west) / 2), float((kEnd - north) / 2)}),
                    m.floor));
    Mesh steps = box({west - 0.4, -0.40, north - 0.8}, {east + 0.4, -0.20, kEnd + 0.4}, 2);
    append(steps, box({west, -0.20, north - 0.4}, {east, -0.002, kEnd}, 2));
    builder.place(builder.add("steps", steps, m.stone));
    Mesh turf = patch(lathe([](double v) { return glm::dvec2(26 * v, -0.4); }), 64, 12, {1, 1});
    projectUv(turf, 3);
    builder.place(builder.add("turf", std::move(turf), m.turf), {0, 0, -2});
}

void placeFurniture(SceneBuilder& builder, const Materials& m) {
    const std::uint32_t hoop = builder.add("lamp", lampHoop(), m.bronze);
    const std::uint32_t bulbs = builder.add("bulbs", lampBulbs(), m.glow);
    for (int i = 0; i < 4; ++i) {
        const glm::vec3 at(0, 0, static_cast<float>((2 * i + 2) * kBay - kEnd));
        builder.place(hoop, at);
        builder.place(bulbs, at);
    }
    const std::uint32_t cloth = builder.add("banner", banner(), m.cloth);
    for (int i = 1; i < kBays; i += 3)
        for (const float side : {-1.0f, 1.0f})
            builder.place(cloth, {side * (kNave - kWall - 0.22f), 6.5f, (i + 0.5) * kBay - kEnd},
                          -side * 0.5f * std::numbers::pi_v<float>);
    const Surface screen = rectangle({-1.5, 2.2, 0}, {3, 0, 0}, {0, -2.2, 0});
    const std::uint32_t lattices =
        builder.add("lattice", patch(screen, 1, 1, {3, 2.2f}), m.lattice);
    for (const int bay : {1, 4, 7})
        builder.place(lattices, {-kNave, 0, (bay + 1) * kBay - kEnd},
                      0.5f * std::numbers::pi_v<float>);

    Mesh block = box({-0.4, 0, -0.4}, {0.4, 0.95, 0.4}, 1);
    append(block, box({-0.47, 0.95, -0.47}, {0.47, 1.05, 0.47}, 1));
    const std::uint32_t pedestal = builder.add("pedestal", std::move(block), m.stone);
    const Mesh pieces[3] = {patch(torusKnot(0.45, 0.1), 16, 160, {2, 20}), vase(),
                            patch(sphere(0.4), 48, 24, {2, 1})};
    const float lift[3] = {0.47f, 0, 0.4f};
    for (int i = 0; i < kBays - 1; ++i) {
        const auto kind = static_cast<std::size_t>(i % 3);
        const glm::vec3 at(-6.6, 0, (i + 1) * kBay - kEnd);
        builder.place(pedestal, at);
        builder.place(builder.add("piece", pieces[kind], m.shown[static_cast<std::size_t>(i) % 5]),
                      at + glm::vec3(0, 1.05f + lift[kind], 0));
    }
    // The knot before the apse, at the end of the view along the hall.
    builder.place(pedestal, {0, 0, -kEnd - 0.5}, 0, 1.6f);
    builder.place(builder.add("knot", pieces[0], m.shown[0]), {0, 1.68f + 0.95f, -kEnd - 0.5}, 0.4f,
                  2);
}

}  // namespace

Scene buildColumns() {
    SceneBuilder builder("builtin:columns");
    const Materials materials = addMaterials(builder);
    placeArchitecture(builder, materials);
    placeGround(builder, materials);
    placeFurniture(builder, materials);
    builder.addCamera("nave", {-1.4f, 1.7f, 19.0f}, {0.5f, 3.1f, -4.0f}, 1.0f);
    builder.addCamera("arcade", {6.6f, 1.6f, 16.5f}, {-3.0f, 2.2f, -2.0f}, 0.95f);
    builder.addCamera("aisle", {-5.5f, 1.75f, 15.6f}, {-6.0f, 1.6f, 0.0f}, 0.9f);
    builder.addCamera("railing", {9.6f, 1.3f, 9.5f}, {3.0f, 1.6f, 0.0f}, 0.9f);
    return std::move(builder).finish();
}

}  // namespace lodestar::scene::procedural
