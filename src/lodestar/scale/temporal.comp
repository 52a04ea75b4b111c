// SPDX-License-Identifier: Apache-2.0
#version 460
#include "temporal_params.h"

// Joins this frame's samples with the history, one thread a pixel of the output.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D source;  // the picture of this frame
layout(binding = 1) uniform sampler2D motion;
layout(binding = 2) uniform sampler2D depth;
layout(binding = 3) uniform sampler2D terms;
layout(binding = 4) uniform usampler2D material;
layout(binding = 5) uniform sampler2D history;  // rgb, a: the weight of the samples in it
layout(binding = 6) uniform sampler2D guide;    // depth, instance and sun of what it shows; layer
layout(binding = 7, rgba16f) writeonly uniform image2D outHistory;
layout(binding = 8, rgba32f) writeonly uniform image2D outGuide;
layout(binding = 9) uniform sampler2D layer;  // share of blended surfaces
layout(push_constant, scalar) uniform Push { TemporalParams params; };

#include "edge_adaptive.glsl"

const float kDepthSlack = 0.01;     // relative, beyond the depths of the texels around
const float kTogether = 1;          // pixels: up to there an outline takes along what it covers
const float kApart = 0.5;           // pixels by which neighbours may move otherwise
const float kSunSlack = 0.15;       // change of the sun's share that is shading that moves
const float kShiny = 0.4;           // roughness below which reflections are seen to move
const float kEnough = 1;            // weight of samples that need no reconstruction beside them
const float kMovingMemory = 0.25;   // of the memory, where resampling blurs it
const float kLayerFades = 0.5;      // a frame: beside its edge it still passes for what is here
const float kTravelled = 2;         // added to the layer's share in the guide: it travels
const float kCovers = 0.03;         // relative, by which something nearer covers
const float kComes = 2;             // halvings of the memory, a pixel that something nearer moves by
const float kLeaves = 16;           // and where the history still shows it, so many more
const float kSlope = 1.5;           // of differences over two pixels: edges are steeper
const float kLatitude = 1;          // spans of colours that are allowed beyond them
const float kMovingFalloff = 0.75;   // of the kernel's, where few frames are left to fill it

/// What the texel and its four neighbours show: what a place in the history must be one of.
struct Around {
    vec4 motion[5];  // xy, depth a frame ago, instance
    vec2 carried;    // the motion by which the history is read
    float sunLow, sunHigh;
    vec3 low, high;
    vec4 gathered;  // rgb times weight, weight: by their distances to the pixel's centre
    vec2 offset;    // from there [pixels], times weight
};

const ivec2 kSteps[5] = ivec2[](ivec2(0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

ivec2 stepFrom(ivec2 texel, int i) {
    return clamp(texel + kSteps[i], ivec2(0), ivec2(params.live) - 1);
}

/// Whether anything there moves over the picture.
bool anyTravels(vec4 motion_[5]) {
    float most = 0;
    for (int i = 0; i < 5; ++i) {
        const vec2 travel = motion_[i].xy * vec2(params.size);
        most = max(most, dot(travel, travel));
    }
    return most > 1e-4;
}

float distanceOf(float depth) { return depth > 0 ? depth : 1e30; }

/// The motion of what lies nearest, of the five that move much alike. An outline goes with what it
/// is the outline of, whichever side of it this frame's sample fell on.
vec2 motionOfOutline(vec4 motion_[5]) {
    vec4 nearest = motion_[0];
    for (int i = 1; i < 5; ++i) {
        const vec2 apart = (motion_[i].xy - motion_[0].xy) * vec2(params.size);
        if (dot(apart, apart) < kTogether * kTogether &&
            distanceOf(motion_[i].z) < distanceOf(nearest.z) * (1 - kCovers))
            nearest = motion_[i];
    }
    return nearest.xy;
}

Around lookAround(vec4 motion_[5], ivec2 texel, vec2 off, vec2 step, float falloff) {
    Around a;
    a.motion = motion_;
    a.carried = motionOfOutline(motion_);
    a.sunLow = 1;
    a.sunHigh = 0;
    a.low = vec3(1);
    a.high = vec3(0);
    a.gathered = vec4(0);
    a.offset = vec2(0);
    for (int i = 0; i < 5; ++i) {
        const ivec2 at = stepFrom(texel, i);
        const float sun = texelFetch(terms, at, 0).x;
        a.sunLow = min(a.sunLow, sun);
        a.sunHigh = max(a.sunHigh, sun);
        const vec3 color = texelFetch(source, at, 0).rgb;
        a.low = min(a.low, color);
        a.high = max(a.high, color);
        const vec2 d = off + vec2(kSteps[i]) / step;
        const float w = exp2(-falloff * dot(d, d));
        a.gathered += w * vec4(color, 1);
        a.offset += w * d;
    }
    return a;
}

/// Whether a place of the history may be blended with what is seen now. It may where it shows a
/// surface that is around the pixel now: the same instance, as far as it then was. It may not where
/// it shows something nearer, which has uncovered the pixel. Something farther was seen between or
/// beside what is seen now: parts of a pixel, which is what is gathered here. A neighbour that moves
/// otherwise than the pixel was not beside it then.
bool mayBlend(vec4 then, Around a) {
    float near = 3e38, far = -3e38, nearest = 3e38;
    for (int i = 0; i < 5; ++i) {
        const vec2 apart = (a.motion[i].xy - a.carried) * vec2(params.size);
        const bool beside = dot(apart, apart) < kApart * kApart;
        const bool same = beside && a.motion[i].w == then.y;
        near = same ? min(near, a.motion[i].z) : near;
        far = same ? max(far, a.motion[i].z) : far;
        nearest = beside ? min(nearest, distanceOf(a.motion[i].z)) : nearest;
    }
    const float slack = kDepthSlack * then.x + (far - near);
    const bool seenNow = then.x >= near - slack && then.x <= far + slack;
    return seenNow || distanceOf(then.x) >= nearest * (1 - kDepthSlack);
}

/// Whether a place of the history shows the very surface that the pixel shows now, and not only one
/// beside it, which may well be in another light.
bool isOwn(vec4 then, vec4 moved) {
    return then.y == moved.w && abs(then.x - moved.z) <= kDepthSlack * then.x;
}

/// By how many pixels something nearer, beside the pixel, moves otherwise than what it shows.
float apartOf(Around a) {
    float apart = 0;
    for (int i = 1; i < 5; ++i)
        if (distanceOf(a.motion[i].z) < distanceOf(a.motion[0].z) * (1 - kCovers))
            apart = max(apart, length((a.motion[i].xy - a.carried) * vec2(params.size)));
    return apart;
}

/// Lagrange's quintic over 6×6 without its corners, in nine bilinear fetches; a place at a texel's
/// centre is that texel. History is resampled every frame: what a filter takes from fine detail it
/// takes as often as the history is old, and Catmull-Rom's takes twice as much.
vec4 sharpHistory(vec2 at, vec2 texelSize) {
    const vec2 base = floor(at - 0.5) + 0.5, f = at - base;
    const vec2 a = f + 2, b = f + 1, c = f - 1, d = f - 2, e = f - 3;
    const vec2 inner0 = -a * b * c * d * e / 12, inner1 = a * b * f * d * e / 12;
    const vec2 outer[4] = vec2[](-b * f * c * d * e / 120, a * f * c * d * e / 24,
                                 -a * b * f * c * e / 24, a * b * f * c * d / 120);
    const float steps[4] = float[](-2, -1, 2, 3);
    const vec2 inner = inner0 + inner1;
    const vec2 middle = base + inner1 / inner;
    float weights = inner.x * inner.y;
    vec4 sum = weights * textureLod(history, middle * texelSize, 0);
    for (int i = 0; i < 4; ++i) {
        const vec2 tap = base + steps[i];
        const vec2 w = inner.yx * outer[i];
        sum += w.x * textureLod(history, vec2(tap.x, middle.y) * texelSize, 0) +
               w.y * textureLod(history, vec2(middle.x, tap.y) * texelSize, 0);
        weights += w.x + w.y;
    }
    return sum / weights;
}

/// How the history changes along x and y [per pixel].
mat2x3 slopeOfHistory(vec2 at, vec2 texelSize) {
    const vec3 left = textureLod(history, (at - vec2(1, 0)) * texelSize, 0).rgb;
    const vec3 right = textureLod(history, (at + vec2(1, 0)) * texelSize, 0).rgb;
    const vec3 above = textureLod(history, (at - vec2(0, 1)) * texelSize, 0).rgb;
    const vec3 below = textureLod(history, (at + vec2(0, 1)) * texelSize, 0).rgb;
    return kSlope * 0.5 * mat2x3(right - left, below - above);
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const vec2 step = params.live / vec2(params.size);
    const vec2 at = (vec2(pixel) + 0.5) * step + params.jitter;
    const ivec2 texel = ivec2(clamp(at, vec2(0), params.live - 1));
    const vec2 off = (vec2(texel) + 0.5 - at) / step;
    // Where something beside the pixel moves, the pixel still holds of it what has moved on.
    vec4 motions[5];
    for (int i = 0; i < 5; ++i) motions[i] = texelFetch(motion, stepFrom(texel, i), 0);
    const bool travels = anyTravels(motions);
    // The place in the history, and which of the 2×2 texels about it show what is seen here.
    const vec4 moved = motions[0];
    const vec2 outSize = vec2(params.size);
    const Around around =
        lookAround(motions, texel, off, step, params.falloff * (travels ? kMovingFalloff : 1));
    const vec2 place = (vec2(pixel) + 0.5) + around.carried * outSize;
    const bool inPicture = all(greaterThanEqual(place, vec2(0))) && all(lessThan(place, outSize));
    const vec2 safe = clamp(place, vec2(0.5), outSize - 0.5);
    const float weight = around.gathered.w;
    const float sun = texelFetch(terms, texel, 0).x;

    const vec2 base = floor(safe - 0.5), f = safe - 0.5 - base;
    vec4 loose = vec4(0);
    float matched = 0, sunThen = 0, layerThen = 0;
    float own = 0;      // share that showed the very surface
    float covered = 0;  // share that showed something before it
    bool travelled = false;  // what has moved on may have left parts of itself
    bool all4 = true;
    for (int i = 0; i < 4; ++i) {
        const ivec2 corner = ivec2(i & 1, i >> 1);
        const ivec2 tap = min(ivec2(base) + corner, ivec2(params.size) - 1);
        const vec4 then = texelFetch(guide, tap, 0);
        const vec2 share = mix(1 - f, f, vec2(corner));
        const float w = share.x * share.y;
        if (w > 0.01 && params.known != 0) {
            travelled = travelled || then.w >= kTravelled;
            const float layered = mod(then.w, kTravelled);
            layerThen = max(layerThen, params.layered != 0 ? layered : 0);
        }
        // Where nothing moved at all nothing can have been uncovered.
        const bool same = params.moved == 0 || mayBlend(then, around);
        all4 = all4 && (same || w < 0.01);
        if (then.x > 0 && then.x < distanceOf(moved.z) * (1 - kCovers)) covered += w;
        if (same) {
            loose += w * texelFetch(history, tap, 0);
            matched += w;
        }
        if (isOwn(then, moved)) {
            sunThen += w * then.z;
            own += w;
        }
    }
    const bool kept =
        params.known != 0 && params.memory > 0 && inPicture && matched > 0.02;
    const vec4 sharp = sharpHistory(safe, 1 / outSize);
    // The samples as they would be at the pixel's centre: where they fell by chance evens out.
    vec3 gathered = around.gathered.rgb;
    if (kept && all4) gathered -= slopeOfHistory(safe, 1 / outSize) * around.offset;
    vec4 before = all4 ? sharp : loose / max(matched, 1e-3);
    before.rgb = clamp(before.rgb, vec3(0), vec3(1));
    sunThen /= max(own, 1e-3);

    // Only where shading moves over a surface that stays is its colour no longer right, and where
    // resampling and parts of pixels that were of something else have been carried along.
    const bool shadowMoved =
        params.moved != 0 && own > 0.02 &&
        (sunThen < around.sunLow - kSunSlack || sunThen > around.sunHigh + kSunSlack);
    const float roughness = unpackUnorm4x8(texelFetch(material, texel, 0).y).x;
    const bool reflectionMoved = params.moved != 0 && moved.w > 0 && roughness < kShiny;
    // Nor where blended surfaces show or did, which move otherwise than what is behind them: they
    // are not in the motion.
    const float layerNow = params.layered != 0 ? texelFetch(layer, texel, 0).x : 0;
    const float ofLayer = params.moved != 0 ? max(layerNow, layerThen) : 0;
    const bool layerMoved = ofLayer > 0.004;
    if (travels || travelled || shadowMoved || reflectionMoved || layerMoved) {
        const float beyond = shadowMoved || layerMoved ? 0 : kLatitude;
        const vec3 latitude = beyond * (around.high - around.low);
        before.rgb = clamp(before.rgb, around.low - latitude, around.high + latitude);
    }

    const float memory = params.memory * (travels ? kMovingMemory : 1) * (1 - ofLayer) *
                         exp2(-apartOf(around) * (kComes + kLeaves * covered));
    // Until samples have gathered, this frame's own reconstruction stands for those to come.
    const float old = kept ? min(max(before.a, 0), memory) : 0;
    const float ahead = max(kEnough - old, 0);
    const vec3 sum = (kept ? before.rgb * old : vec3(0)) + gathered +
                     (ahead > 0 ? edgeAdaptiveAt(at) * ahead : vec3(0));
    const vec4 joined = vec4(sum / (old + weight + ahead), old + weight);
    imageStore(outHistory, pixel, joined);
    const float layerLeft = max(layerNow, kLayerFades * layerThen);
    imageStore(outGuide, pixel, vec4(texelFetch(depth, texel, 0).x, moved.w, sun,
                                     layerLeft + (travels ? kTravelled : 0)));
}
