// SPDX-License-Identifier: Apache-2.0
// Every struct that C++ and GLSL share, one after another. C++ and GLSL.
#ifndef LS_PARAMS_TEST_H
#define LS_PARAMS_TEST_H
#include "lodestar/geometry/cull_params.h"
#include "lodestar/geometry/project_params.h"
#include "lodestar/geometry/show_lods_params.h"
#include "lodestar/geometry/tessellate_params.h"
#include "lodestar/gpu/prefix_sum_params.h"
#include "lodestar/gpu/texel_list_params.h"
#include "lodestar/post/dof_params.h"
#include "lodestar/post/max_depth_params.h"
#include "lodestar/post/motion_blur_params.h"
#include "lodestar/post/reduce_params.h"
#include "lodestar/post/ssao_params.h"
#include "lodestar/post/tonemap_params.h"
#include "lodestar/scale/spatial_params.h"
#include "lodestar/scale/temporal_params.h"
#include "lodestar/scene/deform_params.h"
#include "lodestar/scene/gpu_types.h"
#include "lodestar/shading/background_params.h"
#include "lodestar/shading/coarse_params.h"
#include "lodestar/shading/combine_params.h"
#include "lodestar/shading/layer_params.h"
#include "lodestar/shading/light_params.h"
#include "lodestar/shading/weigh_repair_params.h"
#include "lodestar/upsample/reconstruct_params.h"
#include "lodestar/upsample/refine_params.h"
#include "lodestar/upsample/upsample_params.h"
#include "lodestar/visibility/capture_compute_params.h"
#include "lodestar/visibility/capture_ms_params.h"
#include "lodestar/visibility/capture_ss_params.h"
#include "lodestar/visibility/compact_params.h"
#include "lodestar/visibility/expand_params.h"
#include "lodestar/visibility/fragments_params.h"
#include "lodestar/visibility/list_tiles_params.h"
#include "lodestar/visibility/motion_params.h"
#include "lodestar/visibility/peel_params.h"
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
    GpuDisplaced displaced;
    GpuDisplacedPair displacedPair;
    GpuRefined refined;
    TessellateParams tessellate;
    TessellateHeader tessellateHeader;
    GpuMaterial material;
    GpuTextureTransform textureTransform;
    GpuLight punctual;
    PrefixSumParams prefixSum;
    GpuMesh mesh;
    GpuLod lod;
    GpuChunk chunk;
    CullParams cull;
    CullList cullList;
    CullBeyond cullBeyond;
    CullCounts cullCounts;
    ScanParams scan;
    PhaseParams phase;
    EmitParams emit;
    HizParams hiz;
    CaptureParams capture;
    ViewParams view;
    CoarseParams coarse;
    GpuLightView lightView;
    LightParams light;
    ReconstructParams reconstruct;
    UpsampleParams upsample;
    RepairHeader repair;
    RepairSelectParams repairSelect;
    WeighRepairParams weighRepair;
    TexelListHeader texelListHeader;
    RefineParams refine;
    TonemapParams tonemap;
    ReduceParams reduce;
    CompactVisibilityParams compactVisibility;
    CaptureComputeParams captureCompute;
    CaptureArgsParams captureArgs;
    CaptureQueueCounts captureQueue;
    ProjectParams project;
    CaptureMsDrawParams captureMsDraw;
    CaptureMsParams captureMs;
    ExpandParams expand;
    FragmentsParams fragments;
    FragmentCounts fragmentCounts;
    FurtherPixel furtherPixel;
    RebuildParams rebuild;
    SampleGridParams sampleGrid;
    ListTilesParams listTiles;
    BackgroundParams background;
    SpatialParams spatial;
    CombineParams combine;
    CombineFromSParams combineFromS;
    MotionParams motion;
    DeformParams deform;
    DeformBoundsParams deformBounds;
    PeelParams peel;
    LayerParams layer;
    ShowLodsParams showLods;
    TemporalParams temporal;
    TemporalSourceParams temporalSource;
    TemporalShowParams temporalShow;
    EffectiveGrid effectiveGrid;
    SsaoParams ssao;
    MaxDepthParams maxDepth;
    DofParams dof;
    DofBlurParams dofBlur;
    DofDownParams dofDown;
    MotionBlurParams motionBlur;
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
    VISIT(a.planeScale) VISIT(a.size)
#define LS_VISIT_VIEWS_4(VISIT, a, i) \
    LS_VISIT_VIEW(VISIT, a[i]) LS_VISIT_VIEW(VISIT, a[i + 1]) \
    LS_VISIT_VIEW(VISIT, a[i + 2]) LS_VISIT_VIEW(VISIT, a[i + 3])
#define LS_VISIT_4(VISIT, a, i) VISIT(a[i]) VISIT(a[i + 1]) VISIT(a[i + 2]) VISIT(a[i + 3])
#define LS_VISIT_LIST(VISIT, a) \
    LS_VISIT_3(VISIT, a.groups) VISIT(a.count) LS_VISIT_3(VISIT, a.blocks) VISIT(a.dropped) \
    LS_VISIT_3(VISIT, a.words) VISIT(a.unused)
#define LS_VISIT_RECONSTRUCT(VISIT, r) \
    VISIT(r.size) VISIT(r.inverseRate) VISIT(r.depthFalloff) VISIT(r.normalFalloff) \
    VISIT(r.unlikeAbove) VISIT(r.spreadAbove)
#define LS_VISIT_GRID(VISIT, g) VISIT(g.size) VISIT(g.fullSize) VISIT(g.rate)
#define LS_VISIT_LENS(VISIT, l) \
    LS_VISIT_GRID(VISIT, l.grid) VISIT(l.focus) VISIT(l.sharp) VISIT(l.slope) \
    VISIT(l.thesis) VISIT(l.cocFalloff) VISIT(l.stepsX) VISIT(l.stepsY)
#define LS_VISIT_ALL(VISIT, p) \
    VISIT(p.vertex.position) VISIT(p.vertex.normal) \
    VISIT(p.attributes.uv) VISIT(p.attributes.tangent) VISIT(p.attributes.color) \
    VISIT(p.triangle.a) VISIT(p.triangle.b) VISIT(p.triangle.c) VISIT(p.triangle.own) \
    VISIT(p.meshlet.centre) VISIT(p.meshlet.radius) VISIT(p.meshlet.coneAxis) \
    VISIT(p.meshlet.coneCutoff) VISIT(p.meshlet.triangles) VISIT(p.meshlet.vertices) \
    VISIT(p.meshlet.material) VISIT(p.meshlet.counts) \
    VISIT(p.cluster.instance) VISIT(p.cluster.meshlet) VISIT(p.cluster.triangles) \
    VISIT(p.cluster.material) VISIT(p.cluster.triangleCount) \
    VISIT(p.cluster.lod) VISIT(p.cluster.bin) VISIT(p.cluster.unused) \
    VISIT(p.instance.row0) VISIT(p.instance.row1) VISIT(p.instance.row2) \
    VISIT(p.instance.maxScale) VISIT(p.instance.flags) VISIT(p.instance.mesh) \
    VISIT(p.instance.displaced) \
    VISIT(p.displaced.amplitude) VISIT(p.displaced.wavelength) VISIT(p.displaced.octaves) \
    VISIT(p.displaced.instance) VISIT(p.displaced.firstPair) \
    VISIT(p.displaced.firstMeshlet) VISIT(p.displaced.meshletCount) VISIT(p.displaced.unused) \
    VISIT(p.displacedPair.displaced) VISIT(p.displacedPair.meshlet) \
    VISIT(p.refined.firstMeshlet) VISIT(p.refined.meshletCount) \
    LS_VISIT_5(VISIT, p.tessellate.planes) VISIT(p.tessellate.eye) VISIT(p.tessellate.reach) \
    VISIT(p.tessellate.pairs) VISIT(p.tessellate.capacity) \
    VISIT(p.tessellate.total) VISIT(p.tessellate.firstVertex) VISIT(p.tessellate.firstTriangle) \
    VISIT(p.tessellate.firstMeshlet) VISIT(p.tessellate.firstListed) \
    VISIT(p.tessellate.secondUvs) \
    LS_VISIT_3(VISIT, p.tessellateHeader.groups) VISIT(p.tessellateHeader.unused) \
    LS_VISIT_3(VISIT, p.tessellateHeader.within) VISIT(p.tessellateHeader.within[3]) \
    VISIT(p.tessellateHeader.within[4]) VISIT(p.tessellateHeader.within[5]) \
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
    VISIT(p.mesh.centre) VISIT(p.mesh.radius) VISIT(p.mesh.firstLod) VISIT(p.mesh.lodCount) \
    VISIT(p.mesh.bin) VISIT(p.mesh.unused) \
    VISIT(p.lod.firstMeshlet) VISIT(p.lod.meshletCount) VISIT(p.lod.error) VISIT(p.lod.unused) \
    VISIT(p.chunk.centre) VISIT(p.chunk.radius) VISIT(p.chunk.first) VISIT(p.chunk.count) \
    VISIT(p.chunk.unused0) VISIT(p.chunk.unused1) \
    VISIT(p.cull.clipFromWorld) VISIT(p.cull.hizFromWorld0) VISIT(p.cull.hizFromWorld1) \
    LS_VISIT_5(VISIT, p.cull.planes) VISIT(p.cull.eye) VISIT(p.cull.mode) VISIT(p.cull.lodEye) \
    VISIT(p.cull.lodScale) VISIT(p.cull.distances0) VISIT(p.cull.distances1) \
    VISIT(p.cull.size) VISIT(p.cull.lodMode) VISIT(p.cull.lodParallel) VISIT(p.cull.useCones) \
    VISIT(p.cull.chunkCount) VISIT(p.cull.hizValid) VISIT(p.cull.hizLevels) \
    VISIT(p.cull.hizSize) VISIT(p.cull.listAll) VISIT(p.cull.reliefReach) \
    LS_VISIT_4(VISIT, p.cull.hizOffsets, 0) LS_VISIT_4(VISIT, p.cull.hizOffsets, 4) \
    LS_VISIT_4(VISIT, p.cull.hizOffsets, 8) LS_VISIT_4(VISIT, p.cull.hizOffsets, 12) \
    LS_VISIT_LIST(VISIT, p.cullList) \
    LS_VISIT_3(VISIT, p.cullBeyond.groups) \
    LS_VISIT_LIST(VISIT, p.cullCounts.lists[0]) LS_VISIT_LIST(VISIT, p.cullCounts.lists[1]) \
    LS_VISIT_LIST(VISIT, p.cullCounts.lists[2]) LS_VISIT_LIST(VISIT, p.cullCounts.lists[3]) \
    LS_VISIT_LIST(VISIT, p.cullCounts.lists[4]) LS_VISIT_LIST(VISIT, p.cullCounts.lists[5]) \
    LS_VISIT_LIST(VISIT, p.cullCounts.lists[6]) LS_VISIT_LIST(VISIT, p.cullCounts.lists[7]) \
    VISIT(p.cullCounts.instances) VISIT(p.cullCounts.instancesHidden) \
    VISIT(p.cullCounts.instancesFound) VISIT(p.cullCounts.clustersHidden) \
    LS_VISIT_3(VISIT, p.cullCounts.beyond[0].groups) \
    LS_VISIT_3(VISIT, p.cullCounts.beyond[1].groups) \
    VISIT(p.cullCounts.projected[0]) VISIT(p.cullCounts.projected[1]) \
    VISIT(p.project.clipFromWorld) VISIT(p.project.size) VISIT(p.project.firstRow) \
    VISIT(p.project.rows) VISIT(p.project.phase) VISIT(p.project.table) VISIT(p.project.capacity) \
    VISIT(p.scan.source) VISIT(p.scan.result) VISIT(p.scan.times) VISIT(p.scan.capacity) \
    VISIT(p.scan.before) VISIT(p.scan.totals) \
    VISIT(p.phase.phase) VISIT(p.phase.table) \
    VISIT(p.emit.phase.phase) VISIT(p.emit.phase.table) VISIT(p.emit.totals) \
    VISIT(p.emit.capacity) \
    VISIT(p.hiz.from) VISIT(p.hiz.to) VISIT(p.hiz.fromOffset) VISIT(p.hiz.toOffset) VISIT(p.hiz.scale) \
    VISIT(p.capture.clipFromWorld) VISIT(p.capture.textureScale) \
    VISIT(p.view.clipFromWorld) VISIT(p.view.viewFromWorld) VISIT(p.view.eye) \
    VISIT(p.view.clipScale) VISIT(p.view.jitter) \
    VISIT(p.coarse.size) VISIT(p.coarse.fullSize) VISIT(p.coarse.rate) \
    VISIT(p.coarse.terms) VISIT(p.coarse.yang) VISIT(p.coarse.step) \
    LS_VISIT_VIEW(VISIT, p.lightView) \
    VISIT(p.light.toSun) VISIT(p.light.sunIlluminance) \
    LS_VISIT_5(VISIT, p.light.irradiance) VISIT(p.light.irradiance[5]) \
    VISIT(p.light.irradiance[6]) VISIT(p.light.irradiance[7]) VISIT(p.light.irradiance[8]) \
    VISIT(p.light.shadowTaps) VISIT(p.light.skyViewCount) VISIT(p.light.skyTaps) \
    VISIT(p.light.noiseOctaves) VISIT(p.light.noiseWarps) VISIT(p.light.noiseFrequency) \
    VISIT(p.light.lightCount) VISIT(p.light.skyLevels) VISIT(p.light.exposure) \
    VISIT(p.light.perLux) VISIT(p.light.backdrop) \
    LS_VISIT_VIEWS_4(VISIT, p.light.views, 0) LS_VISIT_VIEWS_4(VISIT, p.light.views, 4) \
    LS_VISIT_VIEWS_4(VISIT, p.light.views, 8) \
    LS_VISIT_VIEWS_4(VISIT, p.light.views, 12) LS_VISIT_VIEW(VISIT, p.light.views[16]) \
    LS_VISIT_RECONSTRUCT(VISIT, p.reconstruct) LS_VISIT_RECONSTRUCT(VISIT, p.upsample.from) VISIT(p.upsample.fullSize) \
    VISIT(p.upsample.terms) \
    LS_VISIT_3(VISIT, p.repair.groups) VISIT(p.repair.listed) VISIT(p.repair.kept) \
    VISIT(p.repair.cut) VISIT(p.repair.partOf) LS_VISIT_BINS_16(VISIT, p.repair.bins, 0) \
    LS_VISIT_BINS_16(VISIT, p.repair.bins, 16) LS_VISIT_BINS_16(VISIT, p.repair.bins, 32) \
    LS_VISIT_BINS_16(VISIT, p.repair.bins, 48) VISIT(p.repairSelect.most) \
    VISIT(p.weighRepair.fullSize) VISIT(p.weighRepair.terms) \
    LS_VISIT_3(VISIT, p.texelListHeader.groups) VISIT(p.texelListHeader.listed) \
    VISIT(p.refine.size) VISIT(p.refine.rate) VISIT(p.refine.spread) \
    VISIT(p.refine.depthFalloff) VISIT(p.refine.normalFalloff) VISIT(p.refine.unlike) \
    VISIT(p.tonemap.exposure) VISIT(p.tonemap.size) VISIT(p.reduce.factor) \
    VISIT(p.reduce.filterId) \
    VISIT(p.compactVisibility.width) VISIT(p.compactVisibility.firstRow) \
    VISIT(p.compactVisibility.rows) VISIT(p.compactVisibility.band) \
    VISIT(p.compactVisibility.capacity) \
    VISIT(p.captureCompute.clipFromWorld) VISIT(p.captureCompute.size) \
    VISIT(p.captureCompute.firstRow) VISIT(p.captureCompute.rows) \
    VISIT(p.captureCompute.table) \
    VISIT(p.captureCompute.textureScale) \
    VISIT(p.captureArgs.firstDraw) VISIT(p.captureArgs.projected) \
    LS_VISIT_3(VISIT, p.captureQueue.groups) VISIT(p.captureQueue.first) \
    LS_VISIT_3(VISIT, p.captureQueue.slowGroups) VISIT(p.captureQueue.count) VISIT(p.captureQueue.projected) \
    LS_VISIT_3(VISIT, p.captureQueue.clipGroups) VISIT(p.captureQueue.clipped) \
    LS_VISIT_3(VISIT, p.captureQueue.splitGroups) VISIT(p.captureQueue.large) \
    LS_VISIT_3(VISIT, p.captureQueue.tileGroups) VISIT(p.captureQueue.tiles) \
    VISIT(p.captureQueue.jobs) \
    VISIT(p.captureMsDraw.clipFromWorld) VISIT(p.captureMsDraw.size) \
    VISIT(p.captureMsDraw.firstRow) \
    VISIT(p.captureMs.shift) VISIT(p.captureMs.size) \
    VISIT(p.expand.clipFromWorld) VISIT(p.expand.base) VISIT(p.expand.size) \
    VISIT(p.expand.maskedFrom) \
    VISIT(p.fragments.base) VISIT(p.fragments.capacity) \
    VISIT(p.fragmentCounts.mixed) VISIT(p.fragmentCounts.pixels) \
    VISIT(p.fragmentCounts.further) \
    VISIT(p.furtherPixel.pixel) VISIT(p.furtherPixel.first) VISIT(p.furtherPixel.count) \
    VISIT(p.rebuild.pixelNdc) VISIT(p.rebuild.size) VISIT(p.rebuild.textureScale) \
    VISIT(p.sampleGrid.size) VISIT(p.sampleGrid.fullSize) VISIT(p.sampleGrid.rate) \
    VISIT(p.spatial.step) VISIT(p.spatial.texelSize) VISIT(p.spatial.last) \
    VISIT(p.spatial.live) VISIT(p.spatial.size) VISIT(p.spatial.amount) VISIT(p.spatial.seed) \
    VISIT(p.combine.size) \
    VISIT(p.combineFromS.size) LS_VISIT_RECONSTRUCT(VISIT, p.combineFromS.from) VISIT(p.listTiles.size) VISIT(p.background.size) \
    VISIT(p.motion.previousClipFromWorld) VISIT(p.motion.size) \
    VISIT(p.motion.firstDeformed) \
    VISIT(p.deform.firstVertex) VISIT(p.deform.vertexCount) VISIT(p.deform.firstRest) \
    VISIT(p.deform.joints) VISIT(p.deform.firstInfluence) VISIT(p.deform.firstJoint) \
    VISIT(p.deform.deltas) VISIT(p.deform.deltaRows) VISIT(p.deform.firstActive) \
    VISIT(p.deform.activeCount) VISIT(p.deformBounds.firstMeshlet) \
    VISIT(p.deformBounds.meshletCount) \
    VISIT(p.peel.clipFromWorld) VISIT(p.peel.textureScale) VISIT(p.peel.toOpaque) \
    VISIT(p.peel.opaqueSize) \
    VISIT(p.layer.size) VISIT(p.layer.fullSize) VISIT(p.layer.capacity) VISIT(p.showLods.scale) \
    VISIT(p.temporal.texelSize) VISIT(p.temporal.last) VISIT(p.temporal.live) \
    VISIT(p.temporal.jitter) VISIT(p.temporal.size) VISIT(p.temporal.falloff) \
    VISIT(p.temporal.memory) VISIT(p.temporal.known) VISIT(p.temporal.moved) VISIT(p.temporal.layered) \
    VISIT(p.temporalSource.texelSize) VISIT(p.temporalSource.last) \
    VISIT(p.temporalSource.live) VISIT(p.temporalSource.jitter) \
    VISIT(p.temporalSource.lastBefore) VISIT(p.temporalSource.liveBefore) \
    VISIT(p.temporalSource.jitterBefore) VISIT(p.temporalSource.size) \
    VISIT(p.temporalSource.k) VISIT(p.temporalSource.known) VISIT(p.temporalSource.layered) \
    VISIT(p.temporalShow.size) VISIT(p.temporalShow.sharpness) \
    LS_VISIT_GRID(VISIT, p.effectiveGrid) LS_VISIT_GRID(VISIT, p.ssao.grid) VISIT(p.ssao.radius) VISIT(p.ssao.bias) \
    VISIT(p.ssao.strength) VISIT(p.ssao.samples) VISIT(p.maxDepth.size) \
    LS_VISIT_LENS(VISIT, p.dof) \
    VISIT(p.dofBlur.size) VISIT(p.dofBlur.fromSize) VISIT(p.dofBlur.axis) \
    VISIT(p.dofBlur.step) VISIT(p.dofBlur.reach) VISIT(p.dofBlur.falloff) \
    LS_VISIT_LENS(VISIT, p.dofDown.lens) VISIT(p.dofDown.size) VISIT(p.dofDown.first) \
    LS_VISIT_GRID(VISIT, p.motionBlur.grid) VISIT(p.motionBlur.tiles) \
    VISIT(p.motionBlur.shutter) VISIT(p.motionBlur.longest)
// clang-format on

#endif
