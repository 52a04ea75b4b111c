// SPDX-License-Identifier: Apache-2.0
#include "app/bench/published.hpp"

#include <stdexcept>

namespace lodestar::app {
namespace {

constexpr char kText[] =
#include <app/bench/published.json.inc>
    ;

}  // namespace

const Json& published(const std::string& key) {
    static const Json all = Json::parse(kText);
    const auto found = all.find(key);
    if (found == all.end()) throw std::invalid_argument("published: no figures '" + key + "'");
    return *found;
}

}  // namespace lodestar::app
