# SPDX-License-Identifier: Apache-2.0
# The parts that need Vulkan.
find_package(Vulkan REQUIRED)
include(shaders)

add_library(lodestar STATIC
    gpu/buffer.cpp
    gpu/device.cpp
    gpu/image.cpp
    gpu/kernel.cpp
    gpu/prefix_sum.cpp
    gpu/raster.cpp
    gpu/readback.cpp
    gpu/recorder.cpp
    scene/gpu_scene.cpp
    geometry/cull.cpp
    geometry/hiz.cpp
    geometry/show_lods.cpp
    visibility/capture_compute.cpp
    visibility/capture_ms.cpp
    visibility/capture_ss.cpp
    visibility/compact.cpp
    visibility/expand.cpp
    visibility/fragments.cpp
    visibility/motion.cpp
    visibility/rebuild.cpp
    visibility/sample_grid.cpp
    shading/coarse.cpp
    shading/combine.cpp
    upsample/pack_coarse.cpp
    upsample/refine.cpp
    upsample/repair.cpp
    upsample/upsample.cpp
    post/dof.cpp
    post/max_depth.cpp
    post/reduce.cpp
    post/ssao.cpp
    post/tonemap.cpp
    scale/spatial.cpp
    scale/temporal.cpp
    frame/capture_frame.cpp
    frame/frame.cpp
    frame/frame_samples.cpp
    frame/frame_setup.cpp
    frame/light_maps.cpp
    frame/motion_tracker.cpp
    frame/post_chain.cpp
)
add_library(lodestar::lodestar ALIAS lodestar)
target_link_libraries(lodestar
    PUBLIC lodestar_cpu Vulkan::Vulkan
    PRIVATE $<BUILD_INTERFACE:lodestar_flags>)
# vulkan_raii.hpp costs seconds a file; every Vulkan target reuses this one.
target_precompile_headers(lodestar PRIVATE gpu/vulkan.hpp)
lodestar_shaders(lodestar
    gpu/prefix_sum.comp
    geometry/compact.comp
    geometry/cull_chunks.comp
    geometry/cull_clusters.comp
    geometry/cull_instances.comp
    geometry/cull_triangles.comp
    geometry/emit.comp
    geometry/hiz.comp
    geometry/list_chunks.comp
    geometry/scan_blocks.comp
    geometry/scan_totals.comp
    geometry/show_lods.comp
    visibility/capture_args.comp
    visibility/capture_clip.comp
    visibility/capture_small.comp
    visibility/capture_split.comp
    visibility/capture_tile.comp
    visibility/capture_ms.comp
    visibility/capture_ms.frag
    visibility/capture_ss.vert
    visibility/capture_ss.frag
    visibility/compact.comp
    visibility/expand.comp
    visibility/fragments.comp
    visibility/merge.comp
    visibility/motion.comp
    visibility/rebuild.comp
    visibility/sample_grid.comp
    visibility/resolve.comp
    shading/coarse.comp
    shading/coarse_listed.comp
    shading/combine.comp
    shading/repair_terms.comp
    upsample/pack_coarse.comp
    upsample/refine.comp
    upsample/repair_compact.comp
    upsample/repair_cut.comp
    upsample/upsample.comp
    post/dof_blur.comp
    post/dof_combine.comp
    post/dof_down.comp
    post/dof_layers.comp
    post/dof_resolve.comp
    post/max_depth.comp
    post/reduce.comp
    post/ssao.comp
    post/ssao_blur.comp
    post/tonemap.comp
    scale/spatial.comp
    scale/temporal.comp
    scale/temporal_show.comp
    scale/temporal_source.comp
)
