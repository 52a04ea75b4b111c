// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/mipmaps.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestar::scene {
namespace {

double linearFromSrgb(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// The sRGB curve (IEC 61966-2-1) as tables. Encoding is exact: a table cell is narrower than the
/// narrowest code (1/3295), so its first code or the one after is right, and the threshold between
/// the two decides.
struct SrgbTables {
    static constexpr int kCells = 4096;
    std::array<float, 256> decode{};
    std::array<float, 256> threshold{};  // linear value where code + 1 begins
    std::array<std::uint8_t, kCells + 1> code{};

    SrgbTables() {
        for (int i = 0; i < 256; ++i) {
            const auto slot = static_cast<std::size_t>(i);
            decode[slot] = static_cast<float>(linearFromSrgb(i / 255.0));
            threshold[slot] =
                i == 255 ? 2.0f : static_cast<float>(linearFromSrgb((i + 0.5) / 255.0));
        }
        std::uint8_t c = 0;
        for (int i = 0; i <= kCells; ++i) {
            while (static_cast<float>(i) / kCells >= threshold[c]) ++c;
            code[static_cast<std::size_t>(i)] = c;
        }
    }
};

const SrgbTables& srgb() {
    static const SrgbTables tables;
    return tables;
}

/// Clamped to 0 … 1; NaN is 0.
float unit(float value) {
    return value > 0 ? std::min(value, 1.0f) : 0;
}

std::uint8_t encodeSrgb(float value, const SrgbTables& tables) {
    const float clamped = unit(value);
    const std::uint8_t code = tables.code[static_cast<std::size_t>(clamped * SrgbTables::kCells)];
    return static_cast<std::uint8_t>(code + (clamped >= tables.threshold[code] ? 1 : 0));
}

std::uint8_t encodeLinear(float value) {
    return static_cast<std::uint8_t>(unit(value) * 255.0f + 0.5f);
}

/// The source texels under one texel of the next level: `count` from `first`, with their shares.
struct Box {
    int first = 0, count = 1;
    std::array<float, 3> weight{1, 0, 0};
};

/// Exact box filter from n to m = max(1, n / 2) texels: two equal halves, or for an odd n three
/// texels of which the outer two are cut where the box ends.
std::vector<Box> boxes(int n) {
    const int m = std::max(1, n / 2);
    std::vector<Box> result(static_cast<std::size_t>(m));
    if (n == 1) return result;
    for (int i = 0; i < m; ++i) {
        Box& box = result[static_cast<std::size_t>(i)];
        box.first = 2 * i;
        box.count = n % 2 == 0 ? 2 : 3;
        if (n % 2 == 0)
            box.weight = {0.5f, 0.5f, 0};
        else
            box.weight = {float(m - i) / float(n), float(m) / float(n), float(i + 1) / float(n)};
    }
    return result;
}

/// Halves one axis after the other: a row of the source is first shrunk in x, then weighed into the
/// target row. `texel(x, y)` gives the linear colour at the source.
template <typename Fetch>
std::vector<glm::vec4> halved(int width, int height, const Fetch& texel) {
    const std::vector<Box> across = boxes(width), down = boxes(height);
    std::vector<glm::vec4> result(across.size() * down.size());
    for (std::size_t y = 0; y < down.size(); ++y) {
        glm::vec4* row = &result[y * across.size()];
        for (std::size_t x = 0; x < across.size(); ++x) {
            const Box& h = across[x];
            const Box& v = down[y];
            glm::vec4 sum(0);
            for (int j = 0; j < v.count; ++j) {
                glm::vec4 part(0);
                for (int i = 0; i < h.count; ++i)
                    part += h.weight[static_cast<std::size_t>(i)] * texel(h.first + i, v.first + j);
                sum += v.weight[static_cast<std::size_t>(j)] * part;
            }
            row[x] = sum;
        }
    }
    return result;
}

struct Decoder {
    const std::uint8_t* texels;
    int width;
    const std::array<float, 256>& color;
    const std::array<float, 256>& alpha;

    glm::vec4 operator()(int x, int y) const {
        const std::uint8_t* t =
            texels + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)) *
                         4;
        return {color[t[0]], color[t[1]], color[t[2]], alpha[t[3]]};
    }
};

Decoder decoder(const std::uint8_t* texels, int width, ColorSpace space) {
    static const std::array<float, 256> linear = [] {
        std::array<float, 256> table{};
        for (std::size_t i = 0; i < 256; ++i) table[i] = static_cast<float>(i) / 255.0f;
        return table;
    }();
    return {texels, width, space == ColorSpace::srgb ? srgb().decode : linear, linear};
}

void encode(const std::vector<glm::vec4>& colors, ColorSpace space, std::uint8_t* out) {
    const SrgbTables& tables = srgb();
    for (const glm::vec4& c : colors) {
        for (int i = 0; i < 3; ++i)
            *out++ = space == ColorSpace::srgb ? encodeSrgb(c[i], tables) : encodeLinear(c[i]);
        *out++ = encodeLinear(c.a);
    }
}

int wrapped(int i, int n, Wrap wrap) {
    if (wrap == Wrap::clampToEdge) return std::clamp(i, 0, n - 1);
    const int period = wrap == Wrap::repeat ? n : 2 * n;
    const int m = ((i % period) + period) % period;
    return m < n ? m : period - 1 - m;
}

/// The two source texels a target texel lies between, and the share of the second.
struct Pair {
    int a = 0, b = 0;
    float share = 0;
};

std::vector<Pair> pairs(int from, int to, Wrap wrap, bool nearest) {
    std::vector<Pair> result;
    for (int i = 0; i < to; ++i) {
        const double at = (i + 0.5) * from / to;
        if (nearest) {
            const int texel = std::min(static_cast<int>(at), from - 1);
            result.push_back({texel, texel, 0});
            continue;
        }
        const int left = static_cast<int>(std::floor(at - 0.5));
        result.push_back({wrapped(left, from, wrap), wrapped(left + 1, from, wrap),
                          static_cast<float>(at - 0.5 - left)});
    }
    return result;
}

}  // namespace

float linearFromCode(std::uint8_t code, ColorSpace space) {
    return space == ColorSpace::srgb ? srgb().decode[code] : static_cast<float>(code) / 255.0f;
}

std::uint8_t codeFromLinear(float value, ColorSpace space) {
    return space == ColorSpace::srgb ? encodeSrgb(value, srgb()) : encodeLinear(value);
}

void writeMips(const std::uint8_t* base, int width, int height, ColorSpace space,
               const std::vector<std::uint8_t*>& levels) {
    std::vector<glm::vec4> colors;
    for (std::uint8_t* level : levels) {
        if (colors.empty()) {
            colors = halved(width, height, decoder(base, width, space));
        } else {
            colors = halved(width, height, [&](int x, int y) -> const glm::vec4& {
                return colors[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x)];
            });
        }
        encode(colors, space, level);
        width = std::max(1, width / 2);
        height = std::max(1, height / 2);
    }
}

std::vector<std::uint8_t> resized(const Image& image, int width, int height, ColorSpace space,
                                  Wrap wrapU, Wrap wrapV, bool nearest) {
    const Decoder texel = decoder(image.rgba.data(), image.width, space);
    const std::vector<Pair> across = pairs(image.width, width, wrapU, nearest);
    const std::vector<Pair> down = pairs(image.height, height, wrapV, nearest);
    std::vector<std::uint8_t> result(across.size() * down.size() * 4);
    std::vector<glm::vec4> row(across.size());
    for (std::size_t y = 0; y < down.size(); ++y) {
        const Pair& v = down[y];
        for (std::size_t x = 0; x < across.size(); ++x) {
            const Pair& h = across[x];
            row[x] = glm::mix(glm::mix(texel(h.a, v.a), texel(h.b, v.a), h.share),
                              glm::mix(texel(h.a, v.b), texel(h.b, v.b), h.share), v.share);
        }
        encode(row, space, &result[y * across.size() * 4]);
    }
    return result;
}

}  // namespace lodestar::scene
