// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/import_gltf_document.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

namespace lodestar::scene::gltf {

namespace {

constexpr std::uint32_t kMagic = 0x46546c67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinChunk = 0x004e4942;
// Deeper JSON than any exporter writes; recursive code downstream is safe up to here.
constexpr int kMaxDepth = 256;
// A tightly packed mesh (Draco) takes about 200 times its bytes while it is unpacked.
constexpr std::uint64_t kBaseBudget = 256ull << 20;
constexpr std::uint64_t kBudgetPerByte = 256;

struct Container {
    std::string_view json;
    std::optional<Bytes> bin;
    bool binary = false;
};

std::uint32_t readWord(Bytes bytes, std::size_t offset) {
    std::uint32_t word = 0;
    for (int i = 0; i < 4; ++i) word |= std::uint32_t{bytes[offset + i]} << (8 * i);
    return word;
}

std::string_view asText(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Container splitGlb(Bytes file) {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    const std::string remedy = "the file is damaged or cut short: fetch or export it again";
    if (file.size() < kHeader) refuse("byte 0", "the GLB header is cut short", remedy);
    const std::uint32_t version = readWord(file, 4), length = readWord(file, 8);
    if (version != 2)
        refuse("byte 4", fmt::format("GLB version {} instead of 2", version),
               "convert it to glTF 2.0");
    if (length > file.size() || length < kHeader + kChunkHeader)
        refuse("byte 8",
               fmt::format("a GLB length of {} in a file of {} bytes", length, file.size()),
               remedy);
    Container container;
    container.binary = true;
    std::size_t chunks = 0;
    for (std::size_t at = kHeader; at < length; ++chunks) {
        if (length - at < kChunkHeader)
            refuse(fmt::format("byte {}", at), "a GLB chunk header is cut short", remedy);
        const std::uint32_t size = readWord(file, at), type = readWord(file, at + 4);
        const std::string place = fmt::format("byte {}", at);
        if (size > length - at - kChunkHeader)
            refuse(place,
                   fmt::format("a GLB chunk of {} bytes where {} are left", size,
                               length - at - kChunkHeader),
                   remedy);
        if (size % 4 != 0)
            refuse(place, fmt::format("a GLB chunk length of {} is no multiple of 4", size),
                   remedy);
        const Bytes data = file.subspan(at + kChunkHeader, size);
        if (chunks == 0) {
            if (type != kJsonChunk) refuse(place, "the first GLB chunk is not JSON", remedy);
            container.json = asText(data);
        } else if (type == kJsonChunk) {
            refuse(place, "a second JSON chunk", remedy);
        } else if (type == kBinChunk) {
            if (chunks != 1) refuse(place, "a BIN chunk that is not the second chunk", remedy);
            container.bin = data;
        }
        at += kChunkHeader + size;
    }
    return container;
}

void checkDepth(std::string_view text) {
    int depth = 0;
    bool inString = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (inString) {
            if (c == '\\') ++i;
            if (c == '"') inString = false;
        } else if (c == '"') {
            inString = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kMaxDepth)
                refuse(fmt::format("byte {}", i),
                       fmt::format("JSON nested over {} deep", kMaxDepth));
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
}

Json parseJson(std::string_view text) {
    checkDepth(text);
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& error) {
        refuse(fmt::format("byte {} of the JSON", error.byte), "not valid JSON",
               "give a glTF 2.0 file (.gltf or .glb)");
    } catch (const Json::exception&) {  // a number beyond double
        refuse("the JSON", "holds a number that is too large");
    }
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string percentDecoded(std::string_view text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool escape = text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 &&
                            hexDigit(text[i + 2]) >= 0;
        if (escape) {
            decoded += static_cast<char>(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2]));
            i += 2;
        } else {
            decoded += text[i];
        }
    }
    return decoded;
}

bool isDataUri(std::string_view uri) {
    return uri.starts_with("data:");
}

std::vector<std::uint8_t> decodeBase64(const Place& uri, std::string_view text) {
    static const std::array<std::int8_t, 256> values = [] {
        std::array<std::int8_t, 256> table;
        table.fill(-1);
        const std::string_view letters =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (std::size_t i = 0; i < letters.size(); ++i)
            table[static_cast<unsigned char>(letters[i])] = static_cast<std::int8_t>(i);
        return table;
    }();
    for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
    if (text.size() % 4 == 1) uri.refuse("has base64 of an impossible length");
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0) uri.refuse("holds a character that is not base64");
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes.push_back(static_cast<std::uint8_t>(bits >> held));
        }
    }
    return bytes;
}

std::vector<std::uint8_t> decodeDataUri(const Place& uri) {
    const std::string_view text = uri.text();
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) uri.refuse("is a data URI without data");
    const std::string_view data = text.substr(comma + 1);
    if (text.substr(0, comma).ends_with(";base64")) return decodeBase64(uri, data);
    const std::string plain = percentDecoded(data);
    return {plain.begin(), plain.end()};
}

/// The path a relative URI names, as written; refuses all that is not below the folder.
std::filesystem::path relativePath(const Place& uri) {
    const std::string& text = uri.text();
    const std::string remedy = "keep the files beside the scene and name them by relative paths";
    const std::size_t colon = text.find(':');
    if (text.empty() || (colon != std::string::npos && colon < text.find('/')))
        uri.refuse(fmt::format("'{}' is not a relative path", cleaned(text)), remedy);
    const std::string decoded = percentDecoded(text);
    // A backslash or a drive letter would be a separator or a root on some systems.
    const bool odd = decoded.find('\0') != std::string::npos ||
                     decoded.find('\\') != std::string::npos ||
                     decoded.find(':') != std::string::npos || decoded.starts_with('/');
    const std::filesystem::path path =
        std::filesystem::path(std::u8string(decoded.begin(), decoded.end())).lexically_normal();
    if (odd || path.empty() || path.has_root_path() || *path.begin() == "..")
        uri.refuse(fmt::format("'{}' leads out of the scene's folder", cleaned(text)), remedy);
    return path;
}

std::vector<std::uint8_t> loadBuffer(Document& document, const Place& buffer, bool first,
                                     const Container& container) {
    const std::uint64_t length = buffer.get("byteLength").whole();
    if (length == 0) buffer.get("byteLength").refuse("is 0");
    if (const std::optional<Place> uri = buffer.find("uri")) {
        checkUri(*uri);
        return readUri(document, *uri, length, length);
    }
    const std::optional<Bytes>& bin = container.bin;
    if (!first || !bin) {
        // Whoever embeds a .gltf may hand it buffers; a .glb has nobody to ask.
        const std::optional<Place> packed = buffer.extension("EXT_meshopt_compression");
        if (first && container.binary && !packed)
            buffer.refuse("the GLB has no BIN chunk to take it from");
        return {};
    }
    if (length > bin->size())
        buffer.get("byteLength")
            .refuse(
                fmt::format("{} is over the {} bytes of the GLB's BIN chunk", length, bin->size()));
    return {bin->begin(), bin->begin() + static_cast<std::ptrdiff_t>(length)};
}

}  // namespace

void Document::spend(std::uint64_t bytes, const std::string& place) {
    if (bytes > budget)
        refuse(place, "the scene unpacks to far more than the file's size justifies",
               "split it, or export it without the repetition");
    budget -= bytes;
}

void Document::addFileBytes(std::uint64_t bytes) {
    fileBytes += bytes;
    budget += kBudgetPerByte * bytes;
}

std::vector<std::uint8_t> readFile(const std::filesystem::path& path, std::uint64_t most,
                                   const std::string& place) {
    std::error_code error;
    // Devices and pipes have no size and may never end.
    if (!std::filesystem::is_regular_file(path, error))
        refuse(place, "there is no such file", "put it where the scene looks for it");
    const std::uint64_t size =
        std::min<std::uint64_t>(std::filesystem::file_size(path, error), most);
    std::ifstream stream(path, std::ios::binary);
    if (error || !stream) refuse(place, "the file can't be opened", "check its permissions");
    std::vector<std::uint8_t> bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::uint64_t>(stream.gcount()) != size)
        refuse(place, "the file can't be read to its end", "check the disk");
    return bytes;
}

void checkUri(const Place& uri) {
    if (isDataUri(uri.text()))
        decodeDataUri(uri);
    else
        relativePath(uri);
}

std::vector<std::uint8_t> readUri(Document& document, const Place& uri, std::uint64_t least,
                                  std::uint64_t most) {
    std::vector<std::uint8_t> bytes;
    std::string name = "the data URI";
    if (isDataUri(uri.text())) {
        bytes = decodeDataUri(uri);  // part of the file already counted
    } else {
        const std::filesystem::path relative = relativePath(uri);
        name = '\'' + cleaned(uri.text()) + '\'';
        const std::string place = uri.path() + " " + name;
        if (document.folder.empty())
            refuse(place, "a scene in memory can't read files", "embed them");
        std::error_code error;
        const std::filesystem::path root = std::filesystem::canonical(document.folder, error);
        const std::filesystem::path file = std::filesystem::canonical(root / relative, error);
        if (error) refuse(place, "there is no such file", "put it where the scene looks for it");
        // A symbolic link may lead out where the name alone did not.
        const std::filesystem::path inside = file.lexically_relative(root);
        if (inside.empty() || *inside.begin() == "..")
            refuse(place, "leads out of the scene's folder", "put the file itself there");
        bytes = readFile(file, most, place);
        if (document.filesRead.insert(file).second) document.addFileBytes(bytes.size());
    }
    document.spend(bytes.size(), uri.path());
    if (bytes.size() < least)
        uri.refuse(fmt::format("{} has {} bytes where {} are needed", name, bytes.size(), least));
    if (bytes.size() > most) bytes.resize(most);
    return bytes;
}

Document readDocument(Bytes file, const std::filesystem::path& folder) {
    Document document;
    document.folder = folder;
    document.budget = kBaseBudget;
    document.addFileBytes(file.size());
    const bool binary = file.size() >= 4 && readWord(file, 0) == kMagic;
    const Container container = binary ? splitGlb(file) : Container{asText(file), {}};
    document.json = parseJson(container.json);
    const std::vector<Place> buffers = document.root().object().elements("buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        document.buffers.push_back(loadBuffer(document, buffers[i].object(), i == 0, container));
    }
    return document;
}

}  // namespace lodestar::scene::gltf
