// SPDX-License-Identifier: Apache-2.0
#include "compare.hpp"

#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <lodestar/quality/metrics.hpp>

#include "image_io.hpp"
#include "report_json.hpp"

namespace lodestar::app {
namespace {

/// The window of SSIM is 11 × 11.
constexpr int kSsimSide = 11;

struct Comparison {
    int width = 0, height = 0;
    double psnrDb = 0;  ///< infinite when identical
    std::optional<double> ssim;
    double flipMean = 0;
    quality::ScalarImage flipMap;
};

Result<Comparison> compareFiles(const CompareOptions& options) {
    const Result<quality::RgbImage> reference = readImage(options.reference);
    if (!reference) return tl::unexpected(reference.error());
    const Result<quality::RgbImage> test = readImage(options.test);
    if (!test) return tl::unexpected(test.error());
    if (reference->width != test->width || reference->height != test->height)
        return fail(fmt::format("{} is {} x {} but {} is {} x {}; compare pictures of one size",
                                options.reference.string(), reference->width, reference->height,
                                options.test.string(), test->width, test->height));
    Comparison result;
    result.width = reference->width;
    result.height = reference->height;
    result.psnrDb = quality::psnr(*reference, *test);
    if (std::min(result.width, result.height) >= kSsimSide)
        result.ssim = quality::ssim(*reference, *test);
    result.flipMap = quality::flipMap(*reference, *test);
    double sum = 0;
    for (float error : result.flipMap.values) sum += error;
    result.flipMean = sum / double(result.flipMap.values.size());
    return result;
}

void print(const CompareOptions& options, const Comparison& result) {
    fmt::print("reference  {}\ntest       {}\nsize       {} x {}\n", options.reference.string(),
               options.test.string(), result.width, result.height);
    if (std::isinf(result.psnrDb))
        fmt::print("PSNR       identical\n");
    else
        fmt::print("PSNR       {:.2f} dB\n", result.psnrDb);
    if (result.ssim)
        fmt::print("SSIM       {:.4f}  (1 = identical)\n", *result.ssim);
    else
        fmt::print("SSIM       none: needs at least {0} x {0} pixels\n", kSsimSide);
    fmt::print("FLIP       {:.4f}  (0 = no visible difference, 1 = the largest)\n",
               result.flipMean);
    if (!options.out.empty()) fmt::print("error map  {}\n", options.out.string());
    if (!options.json.empty()) fmt::print("figures    {}\n", options.json.string());
}

Json toJson(const CompareOptions& options, const Comparison& result) {
    const QualityFigures figures{result.psnrDb, result.ssim.value_or(NAN), result.flipMean};
    Json json = toJson(Report{.quality = figures});
    json["reference"] = options.reference.string();
    json["test"] = options.test.string();
    json["width"] = result.width;
    json["height"] = result.height;
    for (const char* figure : {"psnr_db", "ssim"}) json[figure] = json["quality"][figure];
    json["flip_mean"] = result.flipMean;
    return json;
}

/// Nobody wants a picture to be replaced by its own error map.
Result<void> checkOutputs(const CompareOptions& options) {
    for (const std::filesystem::path& output : {options.out, options.json})
        for (const std::filesystem::path& input : {options.reference, options.test}) {
            std::error_code error;
            if (!output.empty() && std::filesystem::equivalent(output, input, error))
                return fail(fmt::format("{}: would overwrite a picture to compare; name another",
                                        output.string()));
        }
    return {};
}

Result<void> compare(const CompareOptions& options) {
    if (Result<void> allowed = checkOutputs(options); !allowed) return allowed;
    const Result<Comparison> result = compareFiles(options);
    if (!result) return tl::unexpected(result.error());
    if (!options.out.empty())
        if (Result<void> written = writePng(options.out, quality::falseColor(result->flipMap));
            !written)
            return written;
    if (!options.json.empty())
        if (Result<void> written = writeJson(options.json, toJson(options, *result)); !written)
            return written;
    print(options, *result);
    return {};
}

}  // namespace

int runCompare(const CompareOptions& options) {
    const Result<void> done = compare(options);
    if (done) return 0;
    fmt::print(stderr, "lodestar: error: {}\n", done.error().message);
    return 1;
}

void addCompare(CLI::App& app, int& exitCode) {
    const auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand(
        "compare", "PSNR, SSIM and FLIP of a picture against its reference (PNG or EXR)");
    command->add_option("REF", options->reference, "The reference picture")->required();
    command->add_option("TEST", options->test, "The picture to judge, of the same size")
        ->required();
    command->add_option("--out", options->out, "Write the FLIP error map to this PNG");
    command->add_option("--json", options->json, "Write the figures to this JSON file");
    command->callback([options, &exitCode] { exitCode = runCompare(*options); });
}

}  // namespace lodestar::app
