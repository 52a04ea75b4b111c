// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace lodestar::scene::gltf {

using Json = nlohmann::json;

/// Ends an import. Thrown inside the importer only; importGltf() turns it into an Error.
struct Refusal {
    std::string message;  ///< "/accessors/3/count: …; what to do"
};

inline constexpr const char* kExportAgain = "export it again";

[[noreturn]] void refuse(const std::string& place, const std::string& what,
                         const std::string& remedy = kExportAgain);

/// Text of a file made fit for a line of a message: control characters dropped, at most 80 bytes.
std::string cleaned(std::string_view);

/// A value of the document together with its JSON path, so that every complaint names its place.
/// Accessors refuse what is not of the asked type.
class Place {
public:
    Place(const Json& json, std::string path) : value(&json), where(std::move(path)) {}

    const Json& json() const { return *value; }
    std::string path() const { return where.empty() ? "/" : where; }
    [[noreturn]] void refuse(const std::string& what,
                             const std::string& remedy = kExportAgain) const;

    const Place& object() const;  ///< itself, if it is an object
    const Place& array() const;   ///< itself, if it is an array
    bool isObject() const { return value->is_object(); }

    /// Member of an object; nothing if absent.
    std::optional<Place> find(const std::string& key) const;
    /// Member of an object that has to be there.
    Place get(const std::string& key) const;
    /// The object `name` of "extensions"; nothing if absent.
    std::optional<Place> extension(const std::string& name) const;
    /// Elements of the array member `key`; none if it is absent.
    std::vector<Place> elements(const std::string& key) const;
    std::size_t size() const { return value->size(); }
    Place operator[](std::size_t index) const;

    std::uint64_t whole(std::uint64_t most = kMostWhole) const;  ///< a non-negative integer
    double number() const;                                       ///< finite, also as a float
    bool boolean() const;
    const std::string& text() const;
    /// An array of exactly `count` numbers.
    std::vector<double> numbers(std::size_t count) const;
    /// A whole number below `count`, of which there are so many `things`.
    std::size_t index(std::size_t count, const char* things) const;

    static constexpr std::uint64_t kMostWhole = 1ull << 53;  ///< JSON numbers are exact up to here

private:
    const Json* value;
    std::string where;
};

}  // namespace lodestar::scene::gltf
