// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace lodestar {

/// What is wrong with something from outside (a file, a stream, an option): one line saying what,
/// where (byte, JSON path, line) and what to do.
struct Error {
    std::string message;
};

/// A value, or why there is none. Loaders return this; they never throw past themselves.
template <typename T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string message) {
    return tl::unexpected<Error>(Error{std::move(message)});
}

}  // namespace lodestar
