// SPDX-License-Identifier: Apache-2.0
#include "app/tune.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/console.hpp"
#include "app/frame_options.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::kTerms;
using budget::Split;
using budget::Term;

constexpr std::array kRates{1.5f, 2.0f, 3.0f, 4.0f, 6.0f, 8.0f};  // at which each is measured
// A frame that holds the budget but for the clock's noise is not passed over.
constexpr double kOver = 1.02;
// The model may err by this much: what it puts so far over or under the budget is measured too.
constexpr double kDoubtful = 1.1;
constexpr int kFinalRounds = 5;
// In a few turns one split is faster than another by luck. What may hold the budget, the best
// pictures first, is measured in so many times the turns before one is taken.
constexpr double kMayHold = 1.05;
constexpr std::size_t kContenders = 6;
constexpr int kDecidingRounds = 4;

std::array<bool, kTerms> presentTerms(const frame::FrameSettings& settings) {
    return {settings.shadowTaps > 0, settings.skyViews > 0, settings.noiseOctaves > 0};
}

/// The times of some frames of one kind, pass by pass: a burst of the machine's falls on one or two
/// passes of a frame, and on others of the next.
class PassMedians {
public:
    void add(const gpu::FrameTimes& frame) {
        double rest = frame.gpuMs;
        std::map<std::string, double> sums;  // a pass may come twice
        for (const gpu::PassTime& pass : frame.passes) {
            sums[pass.name] += pass.ms;
            rest -= pass.ms;
        }
        sums[""] = rest;
        for (const auto& [name, ms] : sums) passes[name].push_back(ms);
    }
    double ms(const std::string& name) const {
        const auto found = passes.find(name);
        return found == passes.end() ? 0 : budget::median(found->second);
    }
    double frameMs() const {
        double sum = 0;
        for (const auto& [name, times] : passes) sum += budget::median(times);
        return sum;
    }

private:
    std::map<std::string, std::vector<double>> passes;
};

double mseOf(double psnrDb) {
    return std::isinf(psnrDb) ? 0 : 255.0 * 255 / std::pow(10, psnrDb / 10);
}

/// Full quality, each term coarse by itself at every rate, all of them together, and each at a rate
/// of its own.
std::vector<Split> splitsToMeasure(const std::array<bool, kTerms>& present, float repair) {
    std::vector<Split> splits{{}};
    // Of a scene with few terms several of these are the same.
    const auto add = [&](const budget::TermRates& rates, float share) {
        Split split{.repair = share};
        for (std::size_t i = 0; i < kTerms; ++i)
            if (present[i]) split.rates[i] = rates[i];
        if (std::find(splits.begin(), splits.end(), split) == splits.end()) splits.push_back(split);
    };
    for (const float share : {0.0f, repair}) {
        for (std::size_t i = 0; i < kTerms; ++i)
            for (const float rate : kRates) {
                budget::TermRates rates{1, 1, 1};
                rates[i] = rate;
                if (present[i]) add(rates, share);
            }
        for (const budget::TermRates& rates :
             {budget::TermRates{2, 2, 2}, budget::TermRates{5, 5, 5}, budget::TermRates{2, 3, 5},
              budget::TermRates{5, 2, 3}})
            add(rates, share);
    }
    return splits;
}

std::string ratesText(const Split& split, const budget::SplitModel& model) {
    std::string text;
    for (std::size_t i = 0; i < kTerms; ++i)
        if (model.has(Term(i)))
            text += fmt::format("{}{}={:.2f}", text.empty() ? "" : ",", budget::kTermNames[i],
                                split.rates[i]);
    return text;
}

std::string dbText(double db) {
    return std::isinf(db) ? "identical" : fmt::format("{:.1f} dB", db);
}

Json splitJson(const Split& split) {
    Json rates;
    for (std::size_t i = 0; i < kTerms; ++i)
        rates[std::string(budget::kTermNames[i])] = split.rates[i];
    return {{"rates", rates}, {"repair", split.repair}};
}

Result<float> numberIn(const Json& json, const char* key, double least, double most) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number())
        return fail(fmt::format("no number \"{}\"", key));
    const double value = found->get<double>();
    if (!(value >= least && value <= most))
        return fail(fmt::format("\"{}\" must be from {:g} to {:g}", key, least, most));
    return static_cast<float>(value);
}

Result<budget::Levers> leversIn(const Json& json) {
    if (!json.is_object() || !json.contains("rates") || !json.at("rates").is_object())
        return fail("no object \"rates\"");
    Split split;
    for (std::size_t i = 0; i < kTerms; ++i) {
        const std::string name(budget::kTermNames[i]);
        const auto rate = numberIn(json.at("rates"), name.c_str(), 1, 64);
        if (!rate) return tl::unexpected(rate.error());
        split.rates[i] = *rate;
    }
    const auto repair = numberIn(json, "repair", 0, 1);
    if (!repair) return tl::unexpected(repair.error());
    split.repair = *repair;
    const auto local = numberIn(json, "local_rate", 0, 1);
    if (!local) return tl::unexpected(local.error());
    budget::Levers levers = budget::leversOf(split);
    levers.localRate = *local;
    return levers;
}

}  // namespace

double psnrOfMse(double mse) {
    return 10 * std::log10(255.0 * 255 / mse);
}

std::vector<budget::SplitSample> measureSplits(const gpu::Device& device, frame::Frame& frame,
                                               const std::vector<scene::Camera>& cameras,
                                               const std::vector<Split>& splits,
                                               const TuneOptions& options, const char* what) {
    std::vector<budget::SplitSample> samples;
    for (const Split& split : splits) samples.push_back({.split = split});
    const double weight = 1 / static_cast<double>(cameras.size());
    const auto rounds = static_cast<std::size_t>(options.rounds);
    Progress bar(what, splits.size() * cameras.size() * rounds);
    std::size_t done = 0;
    for (const scene::Camera& camera : cameras) {
        frame.render(camera, {});
        const quality::RgbImage reference = readDisplay(device, frame);
        std::vector<PassMedians> times(splits.size());
        // In turn, so that whatever else the machine does falls on all alike.
        for (std::size_t round = 0; round < rounds; ++round)
            for (std::size_t i = 0; i < splits.size(); ++i) {
                budget::Levers levers = budget::leversOf(splits[i]);
                levers.localRate = options.localRate;
                times[i].add(frame.render(camera, levers));
                bar.update(++done);
                if (round > 0) continue;
                samples[i].mse +=
                    weight * mseOf(quality::psnr(reference, readDisplay(device, frame)));
            }
        for (std::size_t i = 0; i < splits.size(); ++i) {
            samples[i].ms += weight * times[i].frameMs();
            samples[i].termsMs += weight * (times[i].ms("terms") + times[i].ms("repair"));
        }
    }
    return samples;
}

Result<TermSamples> measureTerms(const gpu::Device& device, frame::Frame& frame,
                                 const std::vector<scene::Camera>& cameras,
                                 const TuneOptions& options) {
    const auto present = presentTerms(frame.settings());
    if (std::find(present.begin(), present.end(), true) == present.end())
        return fail("the shading has no expensive term to resize: see --terms");
    auto samples = measureSplits(device, frame, cameras, splitsToMeasure(present, options.repair),
                                 options, "measuring each term");
    const budget::SplitModel model(samples, present);
    return TermSamples{std::move(samples), model};
}

Tuning chooseSplit(const gpu::Device& device, frame::Frame& frame,
                   const std::vector<scene::Camera>& cameras, const TuneOptions& options,
                   const TermSamples& terms) {
    // What full quality takes all samples know better than the one of it.
    const double expectedMs = options.budget.targetMs(terms.model.fullMs());
    Tuning tuning{0, 0, terms.samples, terms.model, {}, 0, {}};
    // The model is a model: its favourites are rendered, and the pictures decide. Full quality is
    // one of them where the budget is above it.
    for (const double part : {1.0, kDoubtful, 1 / kDoubtful})
        for (const auto& one :
             budget::bestSplits(terms.model, part * expectedMs, options.finalists)) {
            const bool known = std::any_of(
                tuning.finalists.begin(), tuning.finalists.end(),
                [&](const Finalist& other) { return other.predicted.split == one.split; });
            if (!known) tuning.finalists.push_back({one});
        }
    // A machine's speed changes: what a share of full quality is, is measured among them.
    const auto measure = [&](const std::vector<std::size_t>& which, int rounds, const char* what) {
        std::vector<Split> splits{{}};
        for (const std::size_t i : which) splits.push_back(tuning.finalists[i].predicted.split);
        TuneOptions patient = options;
        patient.rounds = rounds;
        const auto measured = measureSplits(device, frame, cameras, splits, patient, what);
        for (std::size_t i = 0; i < which.size(); ++i) {
            tuning.finalists[which[i]].ms = measured[i + 1].ms;
            tuning.finalists[which[i]].psnrDb = psnrOfMse(measured[i + 1].mse);
        }
        tuning.fullMs = measured.front().ms;
        tuning.targetMs = options.budget.targetMs(tuning.fullMs);
    };
    // The best pictures of those within `part` of the budget; past it the fastest come first.
    const auto sortFor = [&](std::vector<std::size_t>& which, double part) {
        const auto holds = [&](const Finalist& f) { return f.ms <= part * tuning.targetMs; };
        std::stable_sort(which.begin(), which.end(), [&](std::size_t left, std::size_t right) {
            const Finalist &a = tuning.finalists[left], &b = tuning.finalists[right];
            if (holds(a) != holds(b)) return holds(a);
            return holds(a) ? a.psnrDb > b.psnrDb : a.ms < b.ms;
        });
    };
    std::vector<std::size_t> contenders(tuning.finalists.size());
    std::iota(contenders.begin(), contenders.end(), std::size_t{0});
    const int rounds = std::max(options.rounds, kFinalRounds);
    measure(contenders, rounds, "measuring the best splits");
    sortFor(contenders, kOver);
    const std::size_t safe = contenders.front();
    sortFor(contenders, kMayHold);
    contenders.resize(std::min(contenders.size(), kContenders));
    if (std::find(contenders.begin(), contenders.end(), safe) == contenders.end())
        contenders.push_back(safe);
    if (contenders.size() > 1)
        measure(contenders, kDecidingRounds * rounds, "deciding between them");
    sortFor(contenders, kOver);
    tuning.chosen = contenders.front();
    tuning.levers = budget::leversOf(tuning.choice().predicted.split);
    tuning.levers.localRate = options.localRate;
    return tuning;
}

Result<Tuning> tune(const gpu::Device& device, frame::Frame& frame,
                    const std::vector<scene::Camera>& cameras, const TuneOptions& options) {
    const auto terms = measureTerms(device, frame, cameras, options);
    if (!terms) return tl::unexpected(terms.error());
    return chooseSplit(device, frame, cameras, options, *terms);
}

void printTuning(const Tuning& tuning) {
    using Align = Table::Align;
    std::vector<Table::Column> columns{{"term"}, {"cost", Align::right}, {"share", Align::right}};
    for (const float rate : kRates)
        columns.push_back({fmt::format("r = {:g}", rate), Align::right});
    Table terms(columns);
    const budget::SplitModel& model = tuning.model;
    for (std::size_t i = 0; i < kTerms; ++i) {
        if (!model.has(Term(i))) continue;
        std::vector<std::string> cells{
            std::string(budget::kTermNames[i]), formatMs(model.termMs(Term(i))),
            fmt::format("{:.0f} %", 100 * model.termMs(Term(i)) / tuning.fullMs)};
        for (const float rate : kRates) {
            Split split;
            split.rates[i] = rate;
            cells.push_back(dbText(psnrOfMse(model.mse(split))));
        }
        terms.row(std::move(cells));
    }
    fmt::print("{}", terms.text());
    fmt::print("  full quality {}, of it fixed {}; each grid S {}\n\n", formatMs(tuning.fullMs),
               formatMs(model.fixedMs()), formatMs(model.gridMs()));
    Table finalists({{""},
                     {"split"},
                     {"repair", Align::right},
                     {"predicted", Align::right},
                     {"", Align::right},
                     {"measured", Align::right},
                     {"", Align::right}});
    for (std::size_t i = 0; i < tuning.finalists.size(); ++i) {
        const Finalist& f = tuning.finalists[i];
        finalists.row({i == tuning.chosen ? ">" : "", ratesText(f.predicted.split, model),
                       fmt::format("{:g}", f.predicted.split.repair), formatMs(f.predicted.ms),
                       dbText(psnrOfMse(f.predicted.mse)), formatMs(f.ms), dbText(f.psnrDb)});
    }
    fmt::print("{}", finalists.text());
    fmt::print(
        "budget {}: {} at {}{}\n", formatMs(tuning.targetMs), formatMs(tuning.choice().ms),
        dbText(tuning.choice().psnrDb),
        tuning.choice().ms > kOver * tuning.targetMs ? ", the fastest there is: MISSED" : "");
}

Json tuningJson(const Tuning& tuning) {
    Json json = splitJson(tuning.choice().predicted.split);
    json["local_rate"] = tuning.levers.localRate;
    json["full_ms"] = tuning.fullMs;
    json["budget_ms"] = tuning.targetMs;
    json["achieved_ms"] = tuning.choice().ms;
    json["psnr_db"] = std::isinf(tuning.choice().psnrDb) ? Json() : Json(tuning.choice().psnrDb);
    json["fixed_ms"] = tuning.model.fixedMs();
    json["grid_ms"] = tuning.model.gridMs();
    Json terms;
    for (std::size_t i = 0; i < kTerms; ++i)
        if (tuning.model.has(Term(i)))
            terms[std::string(budget::kTermNames[i])] = tuning.model.termMs(Term(i));
    json["term_ms"] = terms;
    json["finalists"] = Json::array();
    for (const Finalist& f : tuning.finalists) {
        Json one = splitJson(f.predicted.split);
        one["predicted_ms"] = f.predicted.ms;
        one["predicted_mse"] = f.predicted.mse;
        one["ms"] = f.ms;
        one["psnr_db"] = std::isinf(f.psnrDb) ? Json() : Json(f.psnrDb);
        json["finalists"].push_back(one);
    }
    json["samples"] = Json::array();
    for (const budget::SplitSample& sample : tuning.samples) {
        Json one = splitJson(sample.split);
        one["ms"] = sample.ms;
        one["mse"] = sample.mse;
        json["samples"].push_back(one);
    }
    return json;
}

Result<budget::Levers> readSettings(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        return fail(fmt::format("{}: cannot be read: give a file that lodestar calibrate wrote",
                                printable(file.string())));
    const Json json = Json::parse(in, nullptr, false);
    if (json.is_discarded())
        return fail(fmt::format("{}: is not JSON: give a file that lodestar calibrate wrote",
                                printable(file.string())));
    auto levers = leversIn(json);
    if (!levers)
        return fail(fmt::format("{}: {}: give a file that lodestar calibrate wrote",
                                printable(file.string()), levers.error().message));
    return levers;
}

}  // namespace lodestar::app
