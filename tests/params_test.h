// SPDX-License-Identifier: Apache-2.0
// Every struct that C++ and GLSL share, one after another. C++ and GLSL.
#ifndef LS_PARAMS_TEST_H
#define LS_PARAMS_TEST_H
#include "lodestar/geometry/cull_params.h"
#include "lodestar/gpu/prefix_sum_params.h"
#include "lodestar/post/tonemap_params.h"
#include "lodestar/scale/spatial_params.h"
#include "lodestar/scene/gpu_types.h"
#include "lodestar/shading/coarse_params.h"
#include "lodestar/shading/combine_params.h"
#include "lodestar/shading/light_params.h"
#include "lodestar/upsample/upsample_params.h"
#include "lodestar/visibility/capture_compute_params.h"
#include "lodestar/visibility/capture_ms_params.h"
#include "lodestar/visibility/capture_ss_params.h"
#include "lodestar/visibility/compact_params.h"
#include "lodestar/visibility/expand_params.h"
#include "lodestar/visibility/fragments_params.h"
#include "lodestar/visibility/rebuild_params.h"
#include "lodestar/visibility/sample_grid_params.h"
#include "lodestar/visibility/view_params.h"
LS_NAMESPACE_BEGIN

struct AllParams {
    GpuVertex vertex;
    GpuVertexAttributes attributes;
    GpuTriangle triangle;
    GpuMeshlet meshlet;
    GpuCluster cluster;
    GpuInstance instance;
    GpuMaterial material;
    GpuTextureTransform textureTransform;
    GpuLight punctual;
    PrefixSumParams prefixSum;
    CullClustersParams cullClusters;
    CompactParams compact;
    CullTrianglesParams cullTriangles;
    VisibleCounts visible;
    CaptureParams capture;
    ViewParams view;
    CoarseParams coarse;
    GpuLightView lightView;
    LightParams light;
    UpsampleParams upsample;
    RepairHeader repair;
    RepairSelectParams repairSelect;
    TonemapParams tonemap;
    CompactVisibilityParams compactVisibility;
    CaptureComputeParams captureCompute;
    CaptureQueueCounts captureQueue;
    CaptureLarge captureLarge;
    CaptureMsDrawParams captureMsDraw;
    CaptureMsParams captureMs;
    ExpandParams expand;
    FragmentsParams fragments;
    RebuildParams rebuild;
    SampleGridParams sampleGrid;
    SpatialParams spatial;
    CombineParams combine;
};

LS_NAMESPACE_END

// Calls VISIT for every field, in the order of declaration. An array is visited entry by entry.
// clang-format off
#define LS_VISIT_3(VISIT, a) VISIT(a[0]) VISIT(a[1]) VISIT(a[2])
#define LS_VISIT_5(VISIT, a) LS_VISIT_3(VISIT, a) VISIT(a[3]) VISIT(a[4])
#define LS_VISIT_BINS_4(VISIT, a, i) \
    VISIT(a[i]) VISIT(a[i + 1]) VISIT(a[i + 2]) VISIT(a[i + 3])
#define LS_VISIT_BINS_16(VISIT, a, i) \
    LS_VISIT_BINS_4(VISIT, a, i) LS_VISIT_BINS_4(VISIT, a, i + 4) \
    LS_VISIT_BINS_4(VISIT, a, i + 8) LS_VISIT_BINS_4(VISIT, a, i + 12)
#define LS_VISIT_VIEW(VISIT, a) \
    VISIT(a.u) VISIT(a.v) VISIT(a.depth) VISIT(a.toLight) VISIT(a.weight) VISIT(a.bias) \
    VISIT(a.planeScale)
#define LS_VISIT_VIEWS_4(VISIT, a, i) \
    LS_VISIT_VIEW(VISIT, a[i]) LS_VISIT_VIEW(VISIT, a[i + 1]) \
    LS_VISIT_VIEW(VISIT, a[i + 2]) LS_VISIT_VIEW(VISIT, a[i + 3])
#define LS_VISIT_ALL(VISIT, p) \
    VISIT(p.vertex.position) VISIT(p.vertex.normal) \
    VISIT(p.attributes.uv) VISIT(p.attributes.tangent) VISIT(p.attributes.color) \
    VISIT(p.triangle.a) VISIT(p.triangle.b) VISIT(p.triangle.c) VISIT(p.triangle.unused) \
    VISIT(p.meshlet.centre) VISIT(p.meshlet.radius) VISIT(p.meshlet.coneAxis) \
    VISIT(p.meshlet.coneCutoff) \
    VISIT(p.cluster.instance) VISIT(p.cluster.meshlet) VISIT(p.cluster.triangles) \
    VISIT(p.cluster.material) VISIT(p.cluster.triangleCount) \
    VISIT(p.cluster.unused0) VISIT(p.cluster.unused1) VISIT(p.cluster.unused2) \
    VISIT(p.instance.row0) VISIT(p.instance.row1) VISIT(p.instance.row2) \
    VISIT(p.instance.maxScale) VISIT(p.instance.flags) VISIT(p.instance.unused0) \
    VISIT(p.instance.unused1) \
    VISIT(p.material.baseColor) VISIT(p.material.emissive) VISIT(p.material.flags) \
    VISIT(p.material.metallic) VISIT(p.material.roughness) VISIT(p.material.normalScale) \
    VISIT(p.material.occlusionStrength) VISIT(p.material.baseColorTexture) \
    VISIT(p.material.normalTexture) VISIT(p.material.metallicRoughnessTexture) \
    VISIT(p.material.occlusionTexture) VISIT(p.material.emissiveTexture) \
    VISIT(p.material.alphaCutoff) VISIT(p.material.unused0) VISIT(p.material.unused1) \
    VISIT(p.textureTransform.uRow) VISIT(p.textureTransform.vRow) \
    VISIT(p.punctual.position) VISIT(p.punctual.range) VISIT(p.punctual.color) \
    VISIT(p.punctual.kind) VISIT(p.punctual.direction) VISIT(p.punctual.coneScale) \
    VISIT(p.punctual.coneOffset) \
    VISIT(p.prefixSum.count) VISIT(p.prefixSum.source) VISIT(p.prefixSum.blockTotals) \
    LS_VISIT_5(VISIT, p.cullClusters.planes) VISIT(p.cullClusters.eye) \
    VISIT(p.cullClusters.clusterCount) VISIT(p.cullClusters.useCones) \
    LS_VISIT_5(VISIT, p.compact.binStarts) \
    VISIT(p.cullTriangles.clipFromWorld) VISIT(p.cullTriangles.size) \
    LS_VISIT_5(VISIT, p.cullTriangles.binStarts) \
    LS_VISIT_3(VISIT, p.visible.groups) VISIT(p.visible.clusters) \
    LS_VISIT_5(VISIT, p.visible.binStarts) \
    VISIT(p.capture.clipFromWorld) \
    VISIT(p.view.clipFromWorld) VISIT(p.view.viewFromWorld) VISIT(p.view.eye) \
    VISIT(p.view.clipScale) \
    VISIT(p.coarse.size) VISIT(p.coarse.fullSize) VISIT(p.coarse.rate) \
    VISIT(p.coarse.terms) \
    LS_VISIT_VIEW(VISIT, p.lightView) \
    VISIT(p.light.toSun) VISIT(p.light.sunIlluminance) \
    LS_VISIT_5(VISIT, p.light.irradiance) VISIT(p.light.irradiance[5]) \
    VISIT(p.light.irradiance[6]) VISIT(p.light.irradiance[7]) VISIT(p.light.irradiance[8]) \
    VISIT(p.light.shadowTaps) VISIT(p.light.skyViewCount) VISIT(p.light.skyTaps) \
    VISIT(p.light.noiseOctaves) VISIT(p.light.noiseFrequency) \
    VISIT(p.light.lightCount) VISIT(p.light.skyLevels) VISIT(p.light.exposure) \
    VISIT(p.light.perLux) \
    LS_VISIT_VIEWS_4(VISIT, p.light.views, 0) LS_VISIT_VIEWS_4(VISIT, p.light.views, 4) \
    LS_VISIT_VIEWS_4(VISIT, p.light.views, 8) \
    LS_VISIT_VIEWS_4(VISIT, p.light.views, 12) LS_VISIT_VIEW(VISIT, p.light.views[16]) \
    VISIT(p.upsample.size) VISIT(p.upsample.fullSize) VISIT(p.upsample.inverseRate) VISIT(p.upsample.depthFalloff) \
    VISIT(p.upsample.normalFalloff) VISIT(p.upsample.terms) VISIT(p.upsample.repairAbove) VISIT(p.upsample.repairSpread) \
    LS_VISIT_3(VISIT, p.repair.groups) VISIT(p.repair.listed) VISIT(p.repair.kept) \
    VISIT(p.repair.cut) LS_VISIT_BINS_16(VISIT, p.repair.bins, 0) \
    LS_VISIT_BINS_16(VISIT, p.repair.bins, 16) LS_VISIT_BINS_16(VISIT, p.repair.bins, 32) \
    LS_VISIT_BINS_16(VISIT, p.repair.bins, 48) VISIT(p.repairSelect.most) \
    VISIT(p.tonemap.exposure) VISIT(p.tonemap.size) \
    VISIT(p.compactVisibility.width) VISIT(p.compactVisibility.firstRow) \
    VISIT(p.compactVisibility.rows) VISIT(p.compactVisibility.band) \
    VISIT(p.compactVisibility.capacity) \
    VISIT(p.captureCompute.clipFromWorld) VISIT(p.captureCompute.size) \
    VISIT(p.captureCompute.firstRow) VISIT(p.captureCompute.rows) \
    LS_VISIT_5(VISIT, p.captureCompute.binStarts) \
    LS_VISIT_3(VISIT, p.captureQueue.groups) VISIT(p.captureQueue.first) \
    VISIT(p.captureQueue.count) VISIT(p.captureQueue.clipped) VISIT(p.captureQueue.large) \
    VISIT(p.captureQueue.jobs) \
    VISIT(p.captureLarge.v0) VISIT(p.captureLarge.v1) VISIT(p.captureLarge.v2) \
    VISIT(p.captureLarge.depth) VISIT(p.captureLarge.id) \
    VISIT(p.captureMsDraw.clipFromWorld) VISIT(p.captureMsDraw.size) \
    VISIT(p.captureMsDraw.firstRow) \
    VISIT(p.captureMs.shift) VISIT(p.captureMs.size) \
    VISIT(p.expand.clipFromWorld) VISIT(p.expand.base) VISIT(p.expand.size) \
    VISIT(p.expand.maskedFrom) \
    VISIT(p.fragments.clipFromWorld) VISIT(p.fragments.eye) VISIT(p.fragments.base) \
    VISIT(p.fragments.capacity) \
    VISIT(p.rebuild.pixelNdc) VISIT(p.rebuild.size) \
    VISIT(p.sampleGrid.size) VISIT(p.sampleGrid.fullSize) VISIT(p.sampleGrid.rate) \
    VISIT(p.spatial.step) VISIT(p.spatial.texelSize) VISIT(p.spatial.last) \
    VISIT(p.spatial.live) VISIT(p.spatial.size) VISIT(p.spatial.amount) VISIT(p.spatial.seed) \
    VISIT(p.combine.size)
// clang-format on

#endif
