// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

/// Makes small glTF files in memory for tests: a JSON document and one binary buffer.
class GltfBuilder {
public:
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
    std::vector<std::uint8_t> bin;

    /// A buffer view of a copy of `values`, starting at a multiple of 4 bytes.
    template <typename T>
    std::size_t view(const std::vector<T>& values) {
        while (bin.size() % 4 != 0) bin.push_back(0);
        const std::size_t offset = bin.size(), length = values.size() * sizeof(T);
        bin.resize(offset + length);
        if (length > 0) std::memcpy(bin.data() + offset, values.data(), length);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}});
        return json["bufferViews"].size() - 1;
    }

    std::size_t accessor(std::size_t view, int componentType, const std::string& type,
                         std::size_t count, bool normalized = false) {
        json["accessors"].push_back({{"bufferView", view},
                                     {"componentType", componentType},
                                     {"type", type},
                                     {"count", count},
                                     {"normalized", normalized}});
        return json["accessors"].size() - 1;
    }
    std::size_t floats(const std::vector<float>& values, const std::string& type) {
        const std::size_t components = type == "SCALAR" ? 1
                                       : type == "VEC2" ? 2
                                       : type == "VEC3" ? 3
                                       : type == "VEC4" ? 4
                                                        : 16;
        return accessor(view(values), 5126, type, values.size() / components);
    }
    std::size_t shorts(const std::vector<std::uint16_t>& values) {
        return accessor(view(values), 5123, "SCALAR", values.size());
    }

    std::size_t add(const char* things, const nlohmann::json& thing) {
        json[things].push_back(thing);
        return json[things].size() - 1;
    }
    /// A mesh of one primitive, shown by a node of its own; returns the primitive.
    nlohmann::json& show(const nlohmann::json& attributes) {
        const std::size_t mesh = add("meshes", {{"primitives", {{{"attributes", attributes}}}}});
        add("nodes", {{"mesh", mesh}});
        return json["meshes"][mesh]["primitives"][0];
    }

    /// The file. Exactly as long as its capacity, so that ASan sees a read past its end.
    std::vector<std::uint8_t> glb() const {
        nlohmann::json document = json;
        if (!bin.empty()) document["buffers"][0]["byteLength"] = bin.size();
        std::string text = document.dump();
        while (text.size() % 4 != 0) text += ' ';
        const std::size_t padded = (bin.size() + 3) / 4 * 4;
        std::vector<std::uint8_t> file;
        file.reserve(20 + text.size() + (bin.empty() ? 0 : 8 + padded));
        const auto word = [&](std::size_t value) {
            for (int i = 0; i < 4; ++i) file.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
        };
        word(0x46546c67);
        word(2);
        word(file.capacity());
        word(text.size());
        word(0x4e4f534a);
        file.insert(file.end(), text.begin(), text.end());
        if (!bin.empty()) {
            word(padded);
            word(0x004e4942);
            file.insert(file.end(), bin.begin(), bin.end());
            file.resize(file.size() + padded - bin.size());
        }
        return file;
    }
};

/// Positions of a triangle in the plane z = 0, counter-clockwise seen from +z.
inline const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};
