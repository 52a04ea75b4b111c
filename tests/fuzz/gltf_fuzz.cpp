// SPDX-License-Identifier: Apache-2.0
// libFuzzer target of the glTF importer. Build and run (clang):
//   cmake --preset asan -B build/fuzz -DLODESTAR_FUZZ=ON \
//         -DLODESTAR_SANITIZE=address,undefined,fuzzer-no-link
//   cmake --build build/fuzz --target gltf_fuzz
//   build/fuzz/tests/gltf_fuzz -max_len=65536 -timeout=20 CORPUS SEEDS
// Good seeds: the small .glb and .gltf files of the scenes folder's tests/ and malformed/.
#include <cstdlib>

#include <lodestar/scene/import_gltf.hpp>

using namespace lodestar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Result<scene::Scene> loaded = scene::importGltfFromMemory({data, size}, "fuzz");
    if (!loaded) {
        if (loaded.error().message.find('\n') != std::string::npos) std::abort();
        return 0;
    }
    // What any user of a scene does next.
    for (const scene::Mesh& mesh : loaded->meshes) {
        if (mesh.material >= loaded->materials.size()) std::abort();
        for (const std::uint32_t index : mesh.indices)
            if (index >= mesh.vertices.size()) std::abort();
    }
    for (const float seconds : {0.0f, 0.7f})
        scene::worldBounds(*loaded, scene::worldFromNode(*loaded, seconds));
    return 0;
}
