// SPDX-License-Identifier: Apache-2.0
#include "app/image_io.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <temp_folder.hpp>

namespace {

using namespace lodestar;
using quality::RgbImage;

std::string bigEndian32(std::uint32_t value) {
    return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
}

std::string chunk(const std::string& type, const std::string& data) {
    const std::string checked = type + data;
    const auto checksum =
        ::crc32(0, reinterpret_cast<const Bytef*>(checked.data()), uInt(checked.size()));
    return bigEndian32(std::uint32_t(data.size())) + checked + bigEndian32(std::uint32_t(checksum));
}

std::string deflated(const std::string& raw) {
    std::string out(compressBound(uLong(raw.size())), '\0');
    uLongf size = uLongf(out.size());
    compress(reinterpret_cast<Bytef*>(out.data()), &size,
             reinterpret_cast<const Bytef*>(raw.data()), uLong(raw.size()));
    out.resize(size);
    return out;
}

/// `data` is what goes into the IDAT chunk.
std::string png(std::uint32_t width, std::uint32_t height, int depth, int colorType,
                const std::string& data) {
    const std::string header = bigEndian32(width) + bigEndian32(height) + char(depth) +
                               char(colorType) + std::string(3, '\0');
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", data) + chunk("IEND", "");
}

/// Decodes from a heap block of exactly this size, so that ASan sees any read past it.
Result<RgbImage> decodeExactly(const std::string& bytes) {
    const std::unique_ptr<char[]> exact(new char[bytes.size()]);
    std::memcpy(exact.get(), bytes.data(), bytes.size());
    return app::decodeImage({exact.get(), bytes.size()}, "some.picture");
}

/// A failure is one line that starts with the file.
void expectOneLine(const Result<RgbImage>& result) {
    ASSERT_FALSE(result);
    const std::string& message = result.error().message;
    EXPECT_EQ(message.rfind("some.picture: ", 0), 0u) << message;
    EXPECT_GT(message.size(), 30u) << message;
    for (char c : message) ASSERT_GE(c, ' ') << message;
}

/// A damaged file may still be a picture, but then one of a sane size.
void expectPictureOrOneLine(const Result<RgbImage>& result) {
    if (!result) return expectOneLine(result);
    EXPECT_LE(result->width, 16384);
    EXPECT_LE(result->height, 16384);
    EXPECT_EQ(result->rgb.size(), std::size_t(3) * result->width * result->height);
}

RgbImage gradient(int width, int height) {
    RgbImage image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = std::uint8_t(i * 37);
    return image;
}

TEST(Png, comesBackAsWritten) {
    const TempFolder folder;
    for (const auto& [width, height] : {std::pair(1, 1), {17, 33}, {300, 2}}) {
        const RgbImage image = gradient(width, height);
        ASSERT_TRUE(app::writePng(folder / "with space.png", image));
        const auto back = app::readImage(folder / "with space.png");
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->width, width);
        EXPECT_EQ(back->height, height);
        EXPECT_EQ(back->rgb, image.rgb);
    }
    EXPECT_EQ(folder.fileCount(), 1) << "a temporary file was left";
}

TEST(Png, sixteenBitsAreRoundedNotCut) {
    // 128/257 and 129/257 lie on the two sides of one half; so do 65406 and 65407 of 254.5.
    std::string row(1, '\0');
    for (int code : {0, 128, 129, 65406, 65407, 65535}) {
        row += char(code >> 8);
        row += char(code & 0xff);
    }
    const auto image = decodeExactly(png(2, 1, 16, 2, deflated(row)));
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->rgb, (std::vector<std::uint8_t>{0, 0, 1, 254, 255, 255}));
}

TEST(Png, alphaIsDroppedAndGreySpreads) {
    const auto rgba = decodeExactly(png(1, 1, 8, 6, deflated(std::string("\0\x0a\x14\x1e\0", 5))));
    ASSERT_TRUE(rgba) << rgba.error().message;
    EXPECT_EQ(rgba->rgb, (std::vector<std::uint8_t>{10, 20, 30}));
    const auto grey = decodeExactly(png(1, 1, 8, 0, deflated(std::string("\0\x4d", 2))));
    ASSERT_TRUE(grey) << grey.error().message;
    EXPECT_EQ(grey->rgb, (std::vector<std::uint8_t>{77, 77, 77}));
}

std::string smallPng() {
    std::string rows;
    for (int y = 0; y < 5; ++y) {
        rows += char(y);  // each of PNG's five filters
        for (int i = 0; i < 7 * 3; ++i) rows += char(y * 50 + i * i);
    }
    return png(7, 5, 8, 2, deflated(rows));
}

TEST(Png, everyTruncationIsRefused) {
    const std::string whole = smallPng();
    ASSERT_TRUE(decodeExactly(whole));
    for (std::size_t size = 0; size < whole.size(); ++size)
        expectOneLine(decodeExactly(whole.substr(0, size)));
}

TEST(Png, everyBitFlipIsRefused) {
    const std::string whole = smallPng();
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = char(damaged[bit / 8] ^ (1 << bit % 8));
        SCOPED_TRACE(bit);
        expectOneLine(decodeExactly(damaged));
    }
}

TEST(Png, bitFlipsWithTheRightChecksumAreSurvived) {
    // What an attacker writes: damage that the checksums do not give away.
    const std::string whole = smallPng();
    const std::string header = whole.substr(16, 13);
    const std::string data = whole.substr(41, whole.size() - 41 - 16);
    for (std::size_t bit = 0; bit < 8 * (header.size() + data.size()); ++bit) {
        std::string damaged = header + data;
        damaged[bit / 8] = char(damaged[bit / 8] ^ (1 << bit % 8));
        expectPictureOrOneLine(
            decodeExactly(whole.substr(0, 8) + chunk("IHDR", damaged.substr(0, 13)) +
                          chunk("IDAT", damaged.substr(13)) + chunk("IEND", "")));
    }
}

TEST(Png, sizesThatTheFileCannotHoldAreRefused) {
    const std::string data = deflated(std::string(100, '\0'));
    const auto tooLarge = decodeExactly(png(16385, 1, 8, 2, data));
    expectOneLine(tooLarge);
    EXPECT_NE(tooLarge.error().message.find("16385 x 1"), std::string::npos);
    const auto promised = decodeExactly(png(16384, 16384, 8, 2, data));
    expectOneLine(promised);
    EXPECT_NE(promised.error().message.find("cannot hold"), std::string::npos);
    expectOneLine(decodeExactly(png(0, 1, 8, 2, data)));
    expectOneLine(decodeExactly(png(0xffffffff, 0xffffffff, 16, 6, data)));
    expectOneLine(decodeExactly(png(9, 9, 8, 2, deflated(std::string(9, '\0')))));
}

TEST(ReadImage, namesWhatIsNoPicture) {
    const TempFolder folder;
    const auto messageFor = [](const std::filesystem::path& path) {
        const auto result = app::readImage(path);
        return result ? std::string("read") : result.error().message;
    };
    EXPECT_NE(messageFor(folder / "missing.png").find("missing.png: no such file"),
              std::string::npos);
    EXPECT_NE(messageFor(folder / "").find("is not a file"), std::string::npos);
    EXPECT_NE(messageFor(folder.write("a.png", "")).find("a.png: is empty"), std::string::npos);
    EXPECT_NE(messageFor(folder.write("b.png", "hello")).find("neither PNG nor EXR"),
              std::string::npos);
    // By content, not by name.
    EXPECT_EQ(messageFor(folder.write("c.exr", smallPng())), "read");
}

TEST(WritePng, leavesTheOldFileWhereItCannotWrite) {
    const TempFolder folder;
    const auto missing = app::writePng(folder / "no/such/a.png", gradient(2, 2));
    ASSERT_FALSE(missing);
    EXPECT_NE(missing.error().message.find("its folder does not exist"), std::string::npos);
    EXPECT_FALSE(app::writePng(folder / "", gradient(2, 2)));
    EXPECT_EQ(folder.fileCount(), 0);
    EXPECT_THROW((void)app::writePng(folder / "a.png", RgbImage()), std::invalid_argument);
}

TEST(Exr, linearValuesBecomeSrgbCodes) {
    const TempFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float beyond = std::numeric_limits<float>::infinity();
    // 0.2158605 is 127.5 … 128 in sRGB; 0.001 is on the straight part: 12.92 · 255 · 0.001 = 3.29.
    ASSERT_TRUE(app::writeExr(folder / "a.exr", 3, 2,
                              {{"R", {0, 1, 0.5f, nan, beyond, 0.001f}},
                               {"G", {0.2158605f, 2, -1, -beyond, 0, 1}},
                               {"B", {1, 0, 0.25f, 1, 0, 0}},
                               {"depth", {1, 2, 3, 4, 5, 6}}}));
    const auto image = app::readImage(folder / "a.exr");
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->width, 3);
    EXPECT_EQ(image->height, 2);
    EXPECT_EQ(image->rgb, (std::vector<std::uint8_t>{0, 128, 255, 255, 255, 0, 188, 0, 137,  //
                                                     0, 0, 255, 255, 0, 0, 3, 255, 0}));
    EXPECT_EQ(folder.fileCount(), 1) << "a temporary file was left";
}

TEST(Exr, luminanceAloneIsGrey) {
    const TempFolder folder;
    ASSERT_TRUE(app::writeExr(folder / "y.exr", 1, 2, {{"Y", {0.5f, 1}}}));
    const auto image = app::readImage(folder / "y.exr");
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(image->rgb, (std::vector<std::uint8_t>{188, 188, 188, 255, 255, 255}));

    ASSERT_TRUE(app::writeExr(folder / "z.exr", 1, 1, {{"Z", {1}}}));
    const auto depth = app::readImage(folder / "z.exr");
    ASSERT_FALSE(depth);
    EXPECT_NE(depth.error().message.find("z.exr: unusable EXR, it has neither R, G and B nor Y"),
              std::string::npos);
}

TEST(Exr, channelsAreWrittenAsFloatsByName) {
    const TempFolder folder;
    std::vector<float> depth, id;
    for (int i = 0; i < 5 * 200; ++i) {
        depth.push_back(std::sqrt(float(i)));
        id.push_back(float(-i));
    }
    ASSERT_TRUE(app::writeExr(folder / "aov.exr", 5, 200, {{"depth.Z", depth}, {"A id", id}}));

    Imf::InputFile file((folder / "aov.exr").string().c_str());
    std::vector<float> back(depth.size()), backId(id.size());
    Imf::FrameBuffer target;
    target.insert("depth.Z", Imf::Slice::Make(Imf::FLOAT, back.data(), file.header().dataWindow()));
    target.insert("A id", Imf::Slice::Make(Imf::FLOAT, backId.data(), file.header().dataWindow()));
    file.setFrameBuffer(target);
    file.readPixels(0, 199);
    EXPECT_EQ(back, depth);
    EXPECT_EQ(backId, id);
}

TEST(Exr, misuseThrows) {
    const TempFolder folder;
    const auto write = [&](int width, int height, const std::vector<app::ExrChannel>& channels) {
        (void)app::writeExr(folder / "a.exr", width, height, channels);
    };
    EXPECT_THROW(write(0, 1, {{"Y", {}}}), std::invalid_argument);
    EXPECT_THROW(write(1, 1, {}), std::invalid_argument);
    EXPECT_THROW(write(1, 1, {{"Y", {1, 2}}}), std::invalid_argument);
    EXPECT_THROW(write(1, 1, {{"", {1}}}), std::invalid_argument);
    EXPECT_THROW(write(1, 1, {{"Y", {1}}, {"Y", {1}}}), std::invalid_argument);
    EXPECT_EQ(folder.fileCount(), 0);
}

/// A picture that OpenEXR itself wrote, in halves, with a data window away from the origin.
std::string foreignExr(const TempFolder& folder, Imf::Compression compression, int tileSide,
                       int height = 70) {
    constexpr int kWidth = 9;
    std::vector<half> values(std::size_t(kWidth) * height);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = half(float(i) / float(values.size()));
    const Imath::Box2i window({-3, 5}, {-3 + kWidth - 1, 5 + height - 1});
    Imf::Header header(window, window);
    header.compression() = compression;
    Imf::FrameBuffer source;
    for (const char* name : {"R", "G", "B"}) {
        header.channels().insert(name, Imf::Channel(Imf::HALF));
        source.insert(name, Imf::Slice::Make(Imf::HALF, values.data(), window));
    }
    const std::string path = (folder / "foreign.exr").string();
    if (tileSide > 0) {
        header.setTileDescription({unsigned(tileSide), unsigned(tileSide), Imf::ONE_LEVEL});
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(source);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(source);
        file.writePixels(height);
    }
    return folder.read("foreign.exr");
}

TEST(Exr, foreignFilesAreRead) {
    const TempFolder folder;
    for (const auto& [compression, tileSide] : {std::pair(Imf::NO_COMPRESSION, 0),
                                                {Imf::RLE_COMPRESSION, 0},
                                                {Imf::ZIP_COMPRESSION, 16},
                                                {Imf::PIZ_COMPRESSION, 0},
                                                {Imf::PXR24_COMPRESSION, 4},
                                                {Imf::B44_COMPRESSION, 0}}) {
        SCOPED_TRACE(int(compression));
        const auto image = decodeExactly(foreignExr(folder, compression, tileSide));
        ASSERT_TRUE(image) << image.error().message;
        ASSERT_EQ(image->width, 9);
        ASSERT_EQ(image->height, 70);
        EXPECT_EQ(image->at(0, 0)[0], 0);
        EXPECT_EQ(image->at(0, 35)[1], 188);  // the middle value, 0.5
        EXPECT_EQ(image->at(8, 69)[2], 255);
    }
}

TEST(Exr, dwaCompressionIsNamedAsUnsupported) {
    const TempFolder folder;
    const auto image = decodeExactly(foreignExr(folder, Imf::DWAA_COMPRESSION, 0));
    expectOneLine(image);
    EXPECT_NE(image.error().message.find("DWA"), std::string::npos);
}

TEST(Exr, everyTruncationIsRefused) {
    const TempFolder folder;
    for (const int tileSide : {0, 16}) {
        const std::string whole = foreignExr(folder, Imf::ZIP_COMPRESSION, tileSide);
        ASSERT_TRUE(decodeExactly(whole));
        for (std::size_t size = 0; size < whole.size(); ++size) {
            SCOPED_TRACE(size);
            expectOneLine(decodeExactly(whole.substr(0, size)));
        }
    }
}

TEST(Exr, bitFlipsAreSurvived) {
    const TempFolder folder;
    for (const auto& [compression, tileSide] : {std::pair(Imf::ZIP_COMPRESSION, 0),
                                                {Imf::PIZ_COMPRESSION, 0},
                                                {Imf::RLE_COMPRESSION, 16}}) {
        const std::string whole = foreignExr(folder, compression, tileSide, 18);
        for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
            std::string damaged = whole;
            damaged[bit / 8] = char(damaged[bit / 8] ^ (1 << bit % 8));
            SCOPED_TRACE(bit);
            expectPictureOrOneLine(decodeExactly(damaged));
        }
    }
}

TEST(Exr, sizesThatTheFileCannotHoldAreRefused) {
    const TempFolder folder;
    ASSERT_TRUE(app::writeExr(folder / "a.exr", 4, 4, {{"Y", std::vector<float>(16)}}));
    const std::string whole = folder.read("a.exr");
    const std::size_t window = whole.find("dataWindow") + 11 + 6 + 4;
    const auto withMaximum = [&](std::int32_t x, std::int32_t y) {
        std::string bytes = whole;
        std::memcpy(&bytes[window + 8], &x, 4);
        std::memcpy(&bytes[window + 12], &y, 4);
        return decodeExactly(bytes);
    };
    ASSERT_TRUE(withMaximum(3, 3));
    const auto tooWide = withMaximum(16384, 3);
    expectOneLine(tooWide);
    EXPECT_NE(tooWide.error().message.find("(16385) too large"), std::string::npos);
    expectOneLine(withMaximum(3, std::numeric_limits<std::int32_t>::max()));
    expectOneLine(withMaximum(-1, 3));
    expectOneLine(withMaximum(3, 16383));

    // A wider picture than the chunks of an uncompressed file hold.
    std::string wider = foreignExr(folder, Imf::NO_COMPRESSION, 0);
    ASSERT_TRUE(decodeExactly(wider));
    wider[wider.find("dataWindow") + 11 + 6 + 4 + 8] = 50;
    expectOneLine(decodeExactly(wider));

    // An attribute that asks for 2 GiB.
    std::string bytes = whole;
    const std::uint32_t huge = 0x7fffffff;
    std::memcpy(&bytes[window - 4], &huge, 4);
    expectOneLine(decodeExactly(bytes));
}

}  // namespace
