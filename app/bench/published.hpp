// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/report_json.hpp"

namespace lodestar::app {

/// A figure or table of a source, as published.json has it: the numbers as printed there. Throws
/// std::invalid_argument when there is none called `key`.
const Json& published(const std::string& key);

}  // namespace lodestar::app
