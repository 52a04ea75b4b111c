// SPDX-License-Identifier: Apache-2.0
// From a triangle id and a point of the screen back to the surface.
#ifndef LS_TRIANGLE_GLSL
#define LS_TRIANGLE_GLSL
#include "../scene/scene.glsl"

struct Triangle {
    GpuInstance instance;
    uint material;
    uvec3 vertices;      // numbers of its vertices
    vec3 p0, p1, p2;     // world positions
    vec3 n0, n1, n2;     // object-space normals
};

Triangle loadTriangle(uint id) {
    const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
    const GpuTriangle stored = loadStoredTriangle(cluster.triangles + (id & LS_TRIANGLE_MASK));
    const GpuVertex a = loadVertex(stored.a), b = loadVertex(stored.b), c = loadVertex(stored.c);
    Triangle t;
    t.instance = loadInstance(cluster.instance);
    t.material = cluster.material;
    t.vertices = uvec3(stored.a, stored.b, stored.c);
    t.p0 = transformPoint(t.instance, a.position);
    t.p1 = transformPoint(t.instance, b.position);
    t.p2 = transformPoint(t.instance, c.position);
    t.n0 = unpackNormal(a.normal);
    t.n1 = unpackNormal(b.normal);
    t.n2 = unpackNormal(c.normal);
    return t;
}

/// The outward face normal (counter-clockwise is the front), world, unit length.
vec3 faceNormal(Triangle t) {
    const vec3 n = cross(t.p1 - t.p0, t.p2 - t.p0);
    const vec3 outward = (t.instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -n : n;
    return outward * inversesqrt(max(dot(outward, outward), 1e-36));
}

/// Perspective-correct weights of the three vertices where the ray through a point of the screen
/// meets the triangle's plane, and how they change.
struct Barycentrics {
    vec3 at;      // sum 1
    vec3 dx, dy;  // per NDC unit
    float depth;  // linear view depth
};

/// Homogeneous edge functions (Olano & Greer 1997): clip-space vertices (x, y, w) are moved so that
/// the point `ndc` lies at the origin, and crossed. No division by a vertex's w, so triangles that
/// cross the near plane need no case of their own; moving first keeps thin, far triangles exact.
Barycentrics barycentricsAt(vec4 clip0, vec4 clip1, vec4 clip2, vec2 ndc) {
    const vec3 v0 = vec3(clip0.xy - ndc * clip0.w, clip0.w);
    const vec3 v1 = vec3(clip1.xy - ndc * clip1.w, clip1.w);
    const vec3 v2 = vec3(clip2.xy - ndc * clip2.w, clip2.w);
    const vec3 e0 = cross(v1, v2), e1 = cross(v2, v0), e2 = cross(v0, v1);
    const vec3 e = vec3(e0.z, e1.z, e2.z);
    const vec3 ex = vec3(e0.x, e1.x, e2.x), ey = vec3(e0.y, e1.y, e2.y);
    const float sum = e.x + e.y + e.z;
    // A triangle seen exactly edge-on has no area: any of its points serves.
    const float scale = abs(sum) > 1e-36 ? 1 / sum : 0;

    Barycentrics b;
    b.at = scale != 0 ? e * scale : vec3(1, 0, 0);
    b.dx = (ex - b.at * (ex.x + ex.y + ex.z)) * scale;
    b.dy = (ey - b.at * (ey.x + ey.y + ey.z)) * scale;
    b.depth = dot(b.at, vec3(v0.z, v1.z, v2.z));
    return b;
}

/// The interpolated vertex normal, world, unit length.
vec3 vertexNormal(Triangle t, vec3 weights) {
    const vec3 world =
        transformNormal(t.instance, t.n0 * weights.x + t.n1 * weights.y + t.n2 * weights.z);
    const float l = dot(world, world);
    return l > 1e-36 ? world * inversesqrt(l) : faceNormal(t);
}

#endif
