// SPDX-License-Identifier: Apache-2.0
#version 460
// Loads every attribute of a pixel, as shading from a G-buffer begins. The sum is stored so that no
// load is left out by the compiler.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kEmissive = 1;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform usampler2D normal;
layout(binding = 2) uniform usampler2D material;
layout(binding = 3) uniform sampler2D emissive;
layout(binding = 4, r32ui) writeonly uniform uimage2D outSum;

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, textureSize(depth, 0)))) return;
    const uvec4 words = texelFetch(material, pixel, 0);
    uint sum = floatBitsToUint(texelFetch(depth, pixel, 0).x) + texelFetch(normal, pixel, 0).x +
               words.x + words.y + words.z + words.w;
    if (kEmissive != 0) {
        const uvec3 light = floatBitsToUint(texelFetch(emissive, pixel, 0).rgb);
        sum += light.x + light.y + light.z;
    }
    imageStore(outSum, pixel, uvec4(sum));
}
