// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/budget.hpp>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lodestar::budget {

double Budget::targetMs(double fullQualityMs) const {
    if (kind == Kind::absolute) return value;
    if (!(fullQualityMs > 0) || !std::isfinite(fullQualityMs))
        throw std::invalid_argument("Budget::targetMs: fullQualityMs must be a positive time");
    return value * fullQualityMs;
}

Result<Budget> parseBudget(std::string_view text) {
    const auto bad = [&](const char* why) {
        return fail(
            "budget '" + std::string(text) + "' " + why +
            ": give a time such as 16.6ms, or a share of the full-quality frame such as 40%");
    };
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [unit, status] = std::from_chars(text.data(), end, number);
    if (status == std::errc::result_out_of_range) return bad("is out of range");
    if (status != std::errc()) return bad("is not a number");
    if (!std::isfinite(number) || number <= 0) return bad("is not above zero");

    std::string_view suffix(unit, std::size_t(end - unit));
    while (!suffix.empty() && suffix.front() == ' ') suffix.remove_prefix(1);
    if (suffix == "ms" || suffix.empty()) return Budget{Budget::Kind::absolute, number};
    if (suffix == "%") return Budget{Budget::Kind::relative, number / 100};
    return bad("has an unknown unit");
}

}  // namespace lodestar::budget
