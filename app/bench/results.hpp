// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/bench.hpp"

/// What a bench leaves behind: its files, and its part of the folder's results.
namespace lodestar::app {

/// Writes FOLDER/NAME.json and NAME.csv and puts the rows and bars into FOLDER/results.json and
/// results.md, which hold the newest run of each bench there. Returns what NAME.json holds.
Result<Json> writeResult(const Bench&, BenchResult&, const std::filesystem::path& folder);

/// One row as it comes: the columns of its table, each with its name.
std::string rowText(const Bench&, const Json& row);
/// The tables and bars of a result as they are printed. `result` has rows and bars.
std::string resultText(const Bench&, const Json& result);

}  // namespace lodestar::app
