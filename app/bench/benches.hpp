// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/bench.hpp"

/// The benches themselves, one file each; bench.cpp lists them.
namespace lodestar::app {

/// Cost and quality of shading at r = 1 … 4, and of attributes from visibility or a G-buffer.
Bench shadingRateBench();
/// The scenes of Yang et al. 2008, Figures 2 to 4.
Bench framebufferLodBench();
/// Figure 1 of the same: what the widths of the range filters do.
Bench sigmaBench();
/// Figure 5: a frame time held while view, coverage and load change, with and without control.
Bench framerateControlBench();
/// Flicker of a slow orbit, coarse against full quality.
Bench shadingFlickerBench();
/// The automatic choice of what is resized against splits made by hand.
Bench splitBench();
/// Cost and quality of the scaling filters at S = 0.5 … 2, and of the frame at those scales.
Bench scalingFiltersBench();
/// Quality over time of joined pictures, against full quality and against none joined.
Bench temporalBench();
/// Figures 8 to 11 of the thesis: effects at effective resolution, against its REF.
Bench ssaoBench();
Bench dofBench();
/// Motion blur at S = 1 and 0.71.
Bench motionBlurBench();
/// How well a budget is held along a camera path.
Bench budgetHoldBench();
/// Tables 1 and 2 of the thesis: attributes and shading rebuilt from visibility, against REF.
Bench visibilityQualityBench();
/// Table 3: bytes.
Bench visibilityMemoryBench();
/// Table 4: times.
Bench visibilityTimeBench();

/// Culling and levels of detail, each alone and together: the source's chart of six modes.
Bench geometryLodBench();
/// What culling costs by the number of instances, with the visible ones fixed.
Bench cullingScaleBench();
/// Quality and triangles by the error allowed.
Bench lodQualityBench();
/// Whether a change of level shows.
Bench lodPopsBench();
#ifdef LODESTAR_OSG
/// The same instances drawn by OpenSceneGraph; only in a build with LODESTAR_OSG.
Bench sceneGraphBench();
#endif

}  // namespace lodestar::app
