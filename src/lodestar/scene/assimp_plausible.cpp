// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/assimp_plausible.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace lodestar::scene {
namespace {

constexpr std::string_view kBlank = " \t\r\n\v\f";

/// Takes the next line, or the next word, off the front of `text`; empty at its end.
std::string_view takeLine(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    return line;
}

std::string_view takeWord(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(kBlank));
    text.remove_prefix(word.size());
    return word;
}

/// The number a word begins with (also "3.0"); nothing if it is none or negative.
std::optional<std::uint64_t> count(std::string_view word) {
    std::uint64_t value = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    return status == std::errc() ? std::optional(value) : std::nullopt;
}

struct PlyProperty {
    std::size_t countBytes = 0;  // of a list's length; 0 for a plain value
    std::size_t bytes = 0;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

std::size_t plyBytes(std::string_view type) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 16> kTypes{{{"char", 1},
                                                                               {"uchar", 1},
                                                                               {"int8", 1},
                                                                               {"uint8", 1},
                                                                               {"short", 2},
                                                                               {"ushort", 2},
                                                                               {"int16", 2},
                                                                               {"uint16", 2},
                                                                               {"int", 4},
                                                                               {"uint", 4},
                                                                               {"int32", 4},
                                                                               {"uint32", 4},
                                                                               {"float", 4},
                                                                               {"float32", 4},
                                                                               {"double", 8},
                                                                               {"float64", 8}}};
    for (const auto& [name, bytes] : kTypes)
        if (name == type) return bytes;
    return 0;
}

/// Walks over the rows of a PLY file's body.
class PlyBody {
public:
    enum class Format { ascii, little, big };

    PlyBody(std::string_view rest, Format format) : rest(rest), format(format) {}

    /// Whether the body holds one row of `element`.
    bool take(const PlyElement& element) {
        for (const PlyProperty& property : element.properties) {
            std::uint64_t values = 1;
            if (property.countBytes > 0) {
                const std::optional<std::uint64_t> length = takeCount(property.countBytes);
                if (!length) return false;
                values = *length;
            }
            if (!skip(values, property.bytes)) return false;
        }
        return true;
    }

    std::size_t bytesLeft() const { return rest.size(); }

private:
    std::optional<std::uint64_t> takeCount(std::size_t bytes) {
        if (format == Format::ascii) return count(takeWord(rest));
        if (rest.size() < bytes) return {};
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i) {
            const std::size_t at = format == Format::little ? bytes - 1 - i : i;
            value = value << 8 | static_cast<std::uint8_t>(rest[at]);
        }
        rest.remove_prefix(bytes);
        return value;
    }

    bool skip(std::uint64_t values, std::size_t bytes) {
        if (values > rest.size()) return false;
        if (format == Format::ascii) {
            for (std::uint64_t i = 0; i < values; ++i)
                if (takeWord(rest).empty()) return false;
            return true;
        }
        if (values * bytes > rest.size()) return false;
        rest.remove_prefix(values * bytes);
        return true;
    }

    std::string_view rest;
    Format format;
};

std::optional<std::string> plyProblem(std::string_view text) {
    PlyBody::Format format = PlyBody::Format::ascii;
    std::vector<PlyElement> elements;
    for (std::string_view header = "-"; header != "end_header";) {
        if (text.empty()) return "its header has no end_header";
        std::string_view line = takeLine(text);
        header = takeWord(line);
        if (header == "format") {
            const std::string_view name = takeWord(line);
            if (name == "binary_little_endian")
                format = PlyBody::Format::little;
            else if (name == "binary_big_endian")
                format = PlyBody::Format::big;
            else if (name != "ascii")
                return fmt::format("its format '{}' is unknown", name);
        } else if (header == "element") {
            PlyElement& element = elements.emplace_back();
            element.name = takeWord(line);
            const std::optional<std::uint64_t> rows = count(takeWord(line));
            // assimp would take a digit there for the count.
            if (!rows || element.name.find_first_of("0123456789") == 0)
                return fmt::format("element '{}' has no name or no count", element.name);
            element.count = *rows;
        } else if (header == "property") {
            if (elements.empty()) return "it has a property before any element";
            PlyProperty property;
            std::string_view type = takeWord(line);
            if (type == "list") {
                property.countBytes = plyBytes(takeWord(line));
                type = takeWord(line);
                if (property.countBytes == 0) return "it has a list with an unknown type of count";
            }
            property.bytes = plyBytes(type);
            if (property.bytes == 0)
                return fmt::format("it has a property of unknown type '{}'", type);
            elements.back().properties.push_back(property);
        } else if (!elements.empty() && header != "comment" && header != "obj_info" &&
                   header != "end_header" && !header.empty()) {
            // assimp would lose the properties after it and read the body out of step.
            return fmt::format("its header has an unknown line '{}'", header);
        }
    }
    PlyBody body(text, format);
    for (const PlyElement& element : elements) {
        // A row without properties would take no bytes, and any number of them would fit.
        if (element.count > body.bytesLeft() || (element.properties.empty() && element.count > 0))
            return fmt::format("element '{}' cannot have {} rows in {} bytes", element.name,
                               element.count, body.bytesLeft());
        for (std::uint64_t row = 0; row < element.count; ++row)
            if (!body.take(element))
                return fmt::format("row {} of element '{}' goes beyond the end of the file", row,
                                   element.name);
    }
    return {};
}

/// A line with anything but a comment on it; empty at the end of the file.
std::string_view takeOffLine(std::string_view& text) {
    while (!text.empty()) {
        std::string_view line = takeLine(text);
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(kBlank) != line.npos) return line;
    }
    return {};
}

std::optional<std::string> offProblem(std::string_view text) {
    const std::size_t bytes = text.size();
    std::string_view counts = takeOffLine(text);
    std::optional<std::uint64_t> vertices = count(takeWord(counts));
    while (!vertices && !text.empty()) {  // "OFF", "NOFF", … alone or before the counts
        if (std::string_view same = counts; takeWord(same).empty()) counts = takeOffLine(text);
        vertices = count(takeWord(counts));
    }
    const std::optional<std::uint64_t> faces = count(takeWord(counts));
    if (!vertices || !faces || *vertices > bytes || *faces > bytes)
        return fmt::format("it cannot have the vertices and faces it says in {} bytes", bytes);
    for (std::uint64_t i = 0; i < *vertices; ++i) takeOffLine(text);
    for (std::uint64_t i = 0; i < *faces; ++i) {
        std::string_view line = takeOffLine(text);
        if (line.empty()) return fmt::format("face {} goes beyond the end of the file", i);
        const std::size_t length = line.size();
        const std::optional<std::uint64_t> corners = count(takeWord(line));
        if (!corners || *corners > length)
            return fmt::format("face {} cannot have the corners it says", i);
        // assimp would quietly take vertex 0 in the place of one there is not.
        for (std::uint64_t k = 0; k < *corners; ++k)
            if (count(takeWord(line)).value_or(*vertices) >= *vertices)
                return fmt::format("face {} has a corner that is none of the {} vertices", i,
                                   *vertices);
    }
    return {};
}

}  // namespace

std::optional<std::string> implausibleCounts(std::string_view bytes, std::string_view extension) {
    if (extension == ".ply") return plyProblem(bytes);
    if (extension == ".off") return offProblem(bytes);
    return {};
}

}  // namespace lodestar::scene
