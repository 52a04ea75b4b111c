// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/import_gltf_place.hpp>

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace lodestar::scene::gltf {

void refuse(const std::string& place, const std::string& what, const std::string& remedy) {
    throw Refusal{fmt::format("{}: {}; {}", place, what, remedy)};
}

std::string cleaned(std::string_view text) {
    constexpr std::size_t kMost = 80;
    std::string line;
    for (const char c : text.substr(0, kMost)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte != 0x7f) line += c;
    }
    // A cut through a UTF-8 sequence would leave the line invalid: drop the partial character.
    if (text.size() > kMost) {
        while (!line.empty() && (static_cast<unsigned char>(line.back()) & 0xc0) == 0x80)
            line.pop_back();
        if (!line.empty() && static_cast<unsigned char>(line.back()) >= 0xc0) line.pop_back();
        line += "...";
    }
    return line;
}

void Place::refuse(const std::string& what, const std::string& remedy) const {
    gltf::refuse(path(), what, remedy);
}

const Place& Place::object() const {
    if (!value->is_object()) refuse("is not an object");
    return *this;
}

const Place& Place::array() const {
    if (!value->is_array()) refuse("is not an array");
    return *this;
}

std::optional<Place> Place::find(const std::string& key) const {
    object();
    const auto member = value->find(key);
    if (member == value->end()) return std::nullopt;
    return Place(*member, where + '/' + cleaned(key));
}

Place Place::get(const std::string& key) const {
    std::optional<Place> member = find(key);
    if (!member) refuse("has no " + key);
    return *std::move(member);
}

std::optional<Place> Place::extension(const std::string& name) const {
    const std::optional<Place> extensions = find("extensions");
    if (!extensions || !extensions->isObject()) return std::nullopt;
    std::optional<Place> found = extensions->find(name);
    if (found) found->object();
    return found;
}

std::vector<Place> Place::elements(const std::string& key) const {
    std::vector<Place> all;
    if (const std::optional<Place> member = find(key)) {
        member->array();
        all.reserve(member->size());
        for (std::size_t i = 0; i < member->size(); ++i) all.push_back((*member)[i]);
    }
    return all;
}

Place Place::operator[](std::size_t index) const {
    return Place(array().value->at(index), where + '/' + std::to_string(index));
}

std::uint64_t Place::whole(std::uint64_t most) const {
    if (!value->is_number_unsigned()) refuse("is not a whole number of 0 or more");
    const auto number = value->get<std::uint64_t>();
    if (number > most) refuse(fmt::format("{} is over {}", number, most));
    return number;
}

double Place::number() const {
    if (!value->is_number()) refuse("is not a number");
    const auto number = value->get<double>();
    if (!std::isfinite(number) || std::abs(number) > std::numeric_limits<float>::max())
        refuse("is too large for a float");
    return number;
}

bool Place::boolean() const {
    if (!value->is_boolean()) refuse("is neither true nor false");
    return value->get<bool>();
}

const std::string& Place::text() const {
    if (!value->is_string()) refuse("is not a string");
    return value->get_ref<const std::string&>();
}

std::vector<double> Place::numbers(std::size_t count) const {
    if (array().size() != count) refuse(fmt::format("has {} numbers instead of {}", size(), count));
    std::vector<double> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back((*this)[i].number());
    return all;
}

std::size_t Place::index(std::size_t count, const char* things) const {
    const std::uint64_t number = whole(std::numeric_limits<std::uint64_t>::max());
    if (number >= count)
        refuse(fmt::format("{} is not below the number of {} ({})", number, things, count));
    return static_cast<std::size_t>(number);
}

}  // namespace lodestar::scene::gltf
