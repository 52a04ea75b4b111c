// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/bench.hpp"
#include "app/bench/deferred.hpp"
#include "app/session.hpp"

/// What the visibility benches share.
namespace lodestar::app {

/// A size of the thesis's tables: qHD, FHD, UHD, 8K or 16K.
struct NamedSize {
    const char* name;
    std::uint32_t width, height;
    vk::Extent2D extent() const { return {width, height}; }
};

/// Up to and including `most`; or the size asked for alone; quick runs have a quarter of qHD.
std::vector<NamedSize> sizesUpTo(const BenchOptions&, const std::string& most);
bool isQuick(const BenchOptions&);

/// A scene on the device and its camera.
struct VisibilitySubject {
    Session session;
    scene::Camera camera;
    std::string name;  ///< of the scene, for rows
    std::uint64_t triangles = 0;
};
Result<VisibilitySubject> openSubject(const BenchCase&, const BenchOptions&);
/// The scenes of the three benches, or the one asked for: Sponza, many objects, ten million
/// triangles.
Result<std::vector<BenchCase>> visibilityCases(const BenchOptions&);

/// The thesis's tables, as app/bench/thesis.json.inc has them.
const Json& thesis();

Json visibilityRow(const char* measures, const VisibilitySubject&, const NamedSize&,
                   const std::string& method, std::uint32_t side);
double share(std::size_t part, std::size_t whole);

}  // namespace lodestar::app
