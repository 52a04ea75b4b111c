// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include <lodestar/shared/result.hpp>

namespace lodestar::budget {

/// How long a frame may take: an absolute time, or a share of the full-quality frame, so that a
/// claim can be checked on any machine.
struct Budget {
    enum class Kind { absolute, relative };
    Kind kind = Kind::absolute;
    double value = 0;  ///< milliseconds, or a fraction of the full-quality frame (0.4 for "40%")

    /// The frame time to hold [ms]. Throws std::invalid_argument when the budget is relative and
    /// `fullQualityMs` is not a positive number.
    double targetMs(double fullQualityMs) const;
};

/// Reads "16.6ms", "16.6" (also milliseconds) or "40%".
Result<Budget> parseBudget(std::string_view text);

}  // namespace lodestar::budget
