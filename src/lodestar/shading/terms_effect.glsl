// SPDX-License-Identifier: Apache-2.0
// What the coarse terms do to the light of a surface.
#ifndef LS_TERMS_EFFECT_GLSL
#define LS_TERMS_EFFECT_GLSL

/// Share of the sky's light that comes to a surface. Where the sky is hidden, what hides it sends
/// back some of the light it gets: the albedo of walls that see the sky themselves.
float fromSkyThatIs(float visible) { return mix(0.3, 1.0, visible); }

/// What the procedural pattern multiplies the albedo by.
float veins(float pattern) { return mix(0.15, 1.0, smoothstep(0.3, 0.7, pattern)); }

#endif
