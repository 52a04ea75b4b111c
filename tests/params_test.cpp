// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include <lodestar/gpu/readback.hpp>
#include <lodestar/gpu/recorder.hpp>

#include "gpu_device.hpp"
#include "params_test.h"

namespace lodestar {
namespace {

constexpr std::uint32_t kCode[] =
#include <tests/params_test.comp.inc>
    ;

class ParamsTest : public GpuTest {};

/// Expects the words of fields to count up, as params_test.comp writes them.
struct Counter {
    std::uint32_t last = 0;

    void next(const char* field, std::uint32_t value) { EXPECT_EQ(value, ++last) << field; }
    void next(const char* field, std::int32_t value) {
        EXPECT_EQ(value, std::int32_t(++last)) << field;
    }
    void next(const char* field, float value) { EXPECT_EQ(value, float(++last)) << field; }
    template <glm::length_t N, typename T>
    void next(const char* field, const glm::vec<N, T>& v) {
        for (glm::length_t i = 0; i < N; ++i) next(field, v[i]);
    }
    void next(const char* field, const glm::mat4& m) {
        for (glm::length_t i = 0; i < 4; ++i) next(field, m[i]);
    }
};

TEST_F(ParamsTest, everyFieldLiesWhereTheGpuWritesIt) {
    const gpu::Kernel kernel(device(), "write all", kCode, {gpu::Slot::storageBuffer});
    constexpr std::size_t kBytes = sizeof(shared::AllParams);
    const gpu::Buffer buffer(device(), "all", kBytes);
    gpu::Recorder rec(device());
    rec.begin();
    rec.fill(buffer, 0xffffffffu);
    rec.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    rec.dispatch(kernel, {1, 1, 1}, {buffer});
    rec.submit();
    const auto all = gpu::as<shared::AllParams>(gpu::readBuffer(device(), buffer, kBytes)).front();

    Counter counter;
#define LS_CHECK(field) counter.next(#field, field);
    LS_VISIT_ALL(LS_CHECK, all)
    // Scalar layout has no padding here: were a field missing above, a word would be missing too.
    EXPECT_EQ(4 * counter.last, kBytes);
}

std::string textOf(const std::filesystem::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ParamsHeaders, everySharedStructIsInThisTest) {
    const std::filesystem::path root = LODESTAR_SOURCE_DIR;
    const std::string here = textOf(root / "tests" / "params_test.h");
    int structs = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(root / "src" / "lodestar")) {
        const std::string name = entry.path().filename().string();
        if (!name.ends_with("_params.h") && name != "gpu_types.h") continue;
        const std::string text = textOf(entry.path());
        const std::regex declaration("(?:^|\n)struct (\\w+) \\{");
        for (std::sregex_iterator m(text.begin(), text.end(), declaration), end; m != end; ++m) {
            const std::string type = (*m)[1];
            if (type == "GpuMaterialRecord") continue;  // C++ only
            EXPECT_NE(here.find("    " + type + " "), std::string::npos)
                << type << " of " << name << " is not in params_test.h";
            ++structs;
        }
    }
    EXPECT_GE(structs, 18);
}

}  // namespace
}  // namespace lodestar
