// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <numeric>
#include <random>

#include <glm/glm.hpp>

#include <lodestar/gpu/prefix_sum.hpp>
#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"

namespace lodestar::gpu {
namespace {

std::vector<std::uint32_t> noise(std::size_t count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> values(count);
    for (auto& v : values) v = random();
    return values;
}

std::vector<std::uint32_t> wordsOf(const Device& device, const Buffer& buffer, std::size_t count) {
    return as<std::uint32_t>(readBuffer(device, buffer, 4 * count));
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

class BufferTest : public GpuTest {};
class ImageTest : public GpuTest {};
class PrefixSumTest : public GpuTest {};
class RecorderTest : public GpuTest {};
class MemoryTest : public GpuTest {};
class DeviceTest : public GpuTest {};

TEST_F(BufferTest, whatIsUploadedIsReadBack) {
    const auto values = noise(1001, 1);
    for (const Residence residence : {Residence::device, Residence::mapped}) {
        Buffer buffer(device(), "values", 4 * values.size(), residence);
        buffer.upload(values);
        EXPECT_EQ(wordsOf(device(), buffer, values.size()), values);
    }
}

TEST_F(BufferTest, sizeZeroBecomesSixteenBytes) {
    EXPECT_EQ(Buffer(device(), "empty", 0).bytes(), 16u);
}

TEST_F(BufferTest, uploadRefusesWhatDoesNotFit) {
    Buffer buffer(device(), "small", 16);
    EXPECT_THROW(buffer.upload(noise(5, 2)), std::invalid_argument);
}

TEST_F(BufferTest, onlyMappedBuffersHaveAPointer) {
    EXPECT_EQ(Buffer(device(), "device", 64).mapped(), nullptr);
    EXPECT_NE(Buffer(device(), "mapped", 64, Residence::mapped).mapped(), nullptr);
}

TEST_F(BufferTest, texelBuffersLargerThanTheDeviceTakesAreRefused) {
    const std::uint64_t limit = device().physical().getProperties().limits.maxTexelBufferElements;
    if (limit > 1u << 28) GTEST_SKIP() << "the limit is too large to allocate past";
    EXPECT_THROW(TexelBuffer(device(), "large", 4 * (limit + 1), vk::Format::eR32Uint),
                 DeviceError);
}

TEST_F(ImageTest, everyLevelOfEveryLayerIsReadBack) {
    for (const vk::Format format : {vk::Format::eR8G8B8A8Unorm, vk::Format::eR32G32B32A32Uint}) {
        constexpr std::uint32_t kLayers = 3, kLevels = 5;
        const Image image(device(), {.name = "array",
                                     .format = format,
                                     .extent = {17, 33},
                                     .usage = vk::ImageUsageFlagBits::eSampled |
                                              vk::ImageUsageFlagBits::eTransferDst |
                                              vk::ImageUsageFlagBits::eTransferSrc,
                                     .layers = kLayers,
                                     .levels = kLevels});
        std::vector<std::vector<std::uint32_t>> texels;
        for (std::uint32_t level = 0; level < kLevels; ++level) {
            const vk::Extent2D extent = image.level(level).extent;
            EXPECT_EQ(extent.width, std::max(1u, 17u >> level));
            const std::size_t words =
                std::size_t(extent.width) * extent.height * kLayers * texelBytes(format) / 4;
            texels.push_back(noise(words, level));
            uploadImage(device(), image, level, std::as_bytes(std::span(texels.back())));
        }
        for (std::uint32_t level = 0; level < kLevels; ++level)
            for (std::uint32_t layer = 0; layer < kLayers; ++layer) {
                const std::size_t words = texels[level].size() / kLayers;
                const auto begin = texels[level].begin() + std::ptrdiff_t(layer * words);
                EXPECT_EQ(as<std::uint32_t>(readImage(device(), image.level(level), layer)),
                          std::vector(begin, begin + std::ptrdiff_t(words)))
                    << "level " << level << " layer " << layer;
            }
    }
}

TEST_F(ImageTest, emptyExtentsAndUnknownFormatsAreRefused) {
    EXPECT_THROW(Image(device(), {.name = "none",
                                  .format = vk::Format::eR32Uint,
                                  .extent = {0, 4},
                                  .usage = vk::ImageUsageFlagBits::eSampled}),
                 std::invalid_argument);
    EXPECT_THROW(texelBytes(vk::Format::eBc1RgbUnormBlock), std::invalid_argument);
}

TEST_F(PrefixSumTest, equalsTheSequentialSum) {
    const PrefixSum prefixSum(device());
    Recorder rec(device());
    for (const std::uint32_t count : {1u, 2u, 1023u, 1024u, 1025u, 5000u, 1048576u, 1048577u}) {
        const std::uint32_t length = PrefixSum::bufferLength(count);
        auto values = noise(length, count);  // what follows the values must not matter
        const Buffer buffer = makeBuffer(device(), "values", values);
        rec.begin();
        prefixSum.record(rec, buffer, count);
        rec.submit();

        values.resize(count);
        std::vector<std::uint32_t> expected(count);
        std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
        auto sums = wordsOf(device(), buffer, length);
        EXPECT_EQ(sums.back(), std::accumulate(values.begin(), values.end(), 0u)) << count;
        sums.resize(count);
        EXPECT_TRUE(sums == expected) << count;
    }
}

TEST_F(PrefixSumTest, refusesNothingAndShortBuffers) {
    const PrefixSum prefixSum(device());
    const Buffer buffer(device(), "values", 4ull * PrefixSum::bufferLength(2000) - 4);
    Recorder rec(device());
    rec.begin();
    EXPECT_THROW(prefixSum.record(rec, buffer, 0), std::invalid_argument);
    EXPECT_THROW(prefixSum.record(rec, buffer, 2000), std::invalid_argument);
    rec.submit();
}

TEST_F(RecorderTest, passesAreTimedInOrder) {
    const PrefixSum prefixSum(device());
    const Buffer buffer(device(), "values", 4ull * PrefixSum::bufferLength(200000));
    Recorder rec(device());
    rec.begin();
    {
        const auto pass = rec.pass("clear");
        rec.fill(buffer, 1);
    }
    rec.barrier(Stage::transfer, Stage::compute);
    {
        const auto pass = rec.pass("sum");
        prefixSum.record(rec, buffer, 200000);
    }
    const FrameTimes times = rec.submit();
    ASSERT_EQ(times.passes.size(), 2u);
    EXPECT_EQ(times.passes[0].name, "clear");
    EXPECT_EQ(times.passes[1].name, "sum");
    EXPECT_GT(times.passes[1].ms, 0);
    EXPECT_LE(times.passes[0].ms + times.passes[1].ms, times.gpuMs * 1.001);
    EXPECT_LE(times.gpuMs, times.wallMs);
    EXPECT_EQ(wordsOf(device(), buffer, 3), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST_F(RecorderTest, copiesWhatAFillWrote) {
    const Buffer from(device(), "from", 256), to(device(), "to", 256);
    Recorder rec(device());
    rec.begin();
    rec.fill(from, 7);
    rec.barrier(Stage::transfer, Stage::transfer);
    rec.copy(from, to, 256);
    rec.submit();
    EXPECT_EQ(wordsOf(device(), to, 64), std::vector<std::uint32_t>(64, 7));
}

TEST_F(RecorderTest, passesDoNotNest) {
    Recorder rec(device());
    rec.begin();
    {
        const auto outer = rec.pass("outer");
        EXPECT_THROW((void)rec.pass("inner"), std::invalid_argument);
    }
    { const auto next = rec.pass("next"); }
    EXPECT_EQ(rec.submit().passes.size(), 2u);
}

TEST_F(RecorderTest, aFrameHasAtMost128Passes) {
    Recorder rec(device());
    rec.begin();
    for (int i = 0; i < 128; ++i) const auto pass = rec.pass("pass");
    EXPECT_THROW((void)rec.pass("one more"), std::invalid_argument);
    EXPECT_EQ(rec.submit().passes.size(), 128u);
    rec.begin();
    { const auto pass = rec.pass("again"); }
    EXPECT_EQ(rec.submit().passes.size(), 1u);
}

constexpr std::uint32_t kPrefixSumCode[] =
#include <lodestar/gpu/prefix_sum.comp.inc>
    ;

TEST_F(RecorderTest, dispatchRefusesWrongBindingsAndParameters) {
    const Kernel kernel(device(), "sum", kPrefixSumCode, {Slot::storageBuffer}, 12, {0});
    const Buffer buffer(device(), "values", 8192);
    Recorder rec(device());
    rec.begin();
    EXPECT_THROW(rec.dispatch(kernel, {1, 1, 1}, {}, glm::uvec3(0)), std::invalid_argument);
    EXPECT_THROW(rec.dispatch(kernel, {1, 1, 1}, {buffer, buffer}, glm::uvec3(0)),
                 std::invalid_argument);
    EXPECT_THROW(rec.dispatch(kernel, {1, 1, 1}, {buffer}), std::invalid_argument);
    EXPECT_THROW(rec.dispatch(kernel, {1, 1, 1}, {buffer}, 1u), std::invalid_argument);
    rec.submit();
}

TEST_F(RecorderTest, pushConstantsEndAt128Bytes) {
    EXPECT_THROW(Kernel(device(), "sum", kPrefixSumCode, {Slot::storageBuffer}, 132),
                 std::invalid_argument);
}

TEST_F(MemoryTest, ledgerFollowsResourcesAndKeepsThePeak) {
    const std::uint64_t before = device().allocatedBytes();
    std::uint64_t during = 0;
    {
        Buffer buffer(device(), "half", 1 << 19);
        const Buffer twin(device(), "half", 1 << 19);
        const Image image(device(), {.name = "picture",
                                     .format = vk::Format::eR8G8B8A8Unorm,
                                     .extent = {256, 256},
                                     .usage = vk::ImageUsageFlagBits::eSampled});
        during = device().allocatedBytes();
        EXPECT_GE(during, before + (1 << 20) + 256 * 256 * 4);
        const auto list = device().allocations();
        EXPECT_TRUE(std::is_sorted(list.begin(), list.end(),
                                   [](const auto& a, const auto& b) { return a.bytes > b.bytes; }));
        const auto bytesOf = [&](const std::string& name) {
            const auto entry = std::find_if(list.begin(), list.end(),
                                            [&](const auto& a) { return a.resource == name; });
            return entry == list.end() ? 0 : entry->bytes;
        };
        EXPECT_GE(bytesOf("half"), 1u << 20);
        EXPECT_GE(bytesOf("picture"), 256u * 256 * 4);

        const Buffer moved = std::move(buffer);
        EXPECT_EQ(device().allocatedBytes(), during);
        buffer = Buffer(device(), "other", 1 << 16);
        EXPECT_EQ(device().allocatedBytes(), during + (1 << 16));
        buffer = Buffer(device(), "another", 1 << 15);
        EXPECT_EQ(device().allocatedBytes(), during + (1 << 15));
    }
    EXPECT_EQ(device().allocatedBytes(), before);
    EXPECT_GE(device().peakBytes(), during);
}

TEST_F(DeviceTest, anUnknownNameIsAnErrorThatListsWhatThereIs) {
    for (const char* name : {"no such card", "4711"}) try {
            const Device none(DeviceRequest{.device = name});
            FAIL() << "opened " << none.description().name;
        } catch (const DeviceError& error) {
            EXPECT_TRUE(contains(error.what(), name)) << error.what();
            for (const auto& d : Device::enumerate())
                EXPECT_TRUE(contains(error.what(), d.name)) << error.what();
        }
}

TEST_F(DeviceTest, isChosenByIndexAndByPartOfItsName) {
    std::string part = device().description().name.substr(0, 6);
    for (char& c : part)
        c = std::isupper(static_cast<unsigned char>(c))
                ? static_cast<char>(std::tolower(static_cast<unsigned char>(c)))
                : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const Device byName(DeviceRequest{.device = part});
    EXPECT_EQ(byName.description().name, device().description().name);
    const Device byIndex(DeviceRequest{.device = std::to_string(device().description().index)});
    EXPECT_EQ(byIndex.description().index, device().description().index);
    EXPECT_EQ(byIndex.description().name, device().description().name);
    EXPECT_TRUE(contains(byIndex.whyChosen(), "--device"));
}

TEST_F(DeviceTest, describesItself) {
    EXPECT_EQ(device().description().type == "Cpu", onReferenceDriver());
    EXPECT_EQ(device().description().unusableBecause, "");
    EXPECT_GT(device().timestampMs(), 0);
    for (const auto& feature : device().optionalFeatures()) {
        EXPECT_FALSE(feature.name.empty());
        EXPECT_FALSE(feature.fallback.empty());
    }
}

TEST_F(DeviceTest, validationSpeaksUpAboutMisuse) {
    const Device own(DeviceRequest{.device = testDevice(), .validation = true});
    EXPECT_TRUE(own.validationMessages().empty());
    const Buffer a(own, "a", 256), b(own, "b", 256);
    own.runNow([&](const vk::raii::CommandBuffer& commands) {
        commands.fillBuffer(a.vk(), 0, 256, 1);
        commands.copyBuffer(a.vk(), b.vk(), vk::BufferCopy{.size = 256});  // no barrier between
    });
    ASSERT_FALSE(own.validationMessages().empty());
    EXPECT_TRUE(contains(own.validationMessages().front(), "SYNC-HAZARD"));
}

VKAPI_ATTR VkBool32 VKAPI_CALL onHostMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                             VkDebugUtilsMessageTypeFlagsEXT,
                                             const VkDebugUtilsMessengerCallbackDataEXT* data,
                                             void*) {
    ADD_FAILURE() << "validation: " << data->pMessage;
    return VK_FALSE;
}

/// What a host program has of its own: instance, device and queue, made with plain Vulkan.
struct Host {
    vk::raii::Context context;
    vk::raii::Instance instance{nullptr};
    vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
    vk::raii::PhysicalDevice physical{nullptr};
    vk::raii::Device device{nullptr};
    HostDevice handles;
};

Host makeHost(const std::string& name) {
    Host host;
    const vk::ApplicationInfo application{.apiVersion = VK_API_VERSION_1_3};
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const char* debugUtils = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    host.instance = vk::raii::Instance(
        host.context, vk::InstanceCreateInfo{.pApplicationInfo = &application,
                                             .enabledLayerCount = 1,
                                             .ppEnabledLayerNames = &layer,
                                             .enabledExtensionCount = 1,
                                             .ppEnabledExtensionNames = &debugUtils});
    host.messenger = vk::raii::DebugUtilsMessengerEXT(
        host.instance, vk::DebugUtilsMessengerCreateInfoEXT{
                           .messageSeverity = vk::DebugUtilsMessageSeverityFlagBitsEXT::eWarning |
                                              vk::DebugUtilsMessageSeverityFlagBitsEXT::eError,
                           .messageType = vk::DebugUtilsMessageTypeFlagBitsEXT::eValidation,
                           .pfnUserCallback = &onHostMessage});
    for (auto& physical : vk::raii::PhysicalDevices(host.instance))
        if (name == physical.getProperties().deviceName.data()) host.physical = std::move(physical);

    vk::StructureChain<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features,
                       vk::PhysicalDeviceVulkan13Features>
        chain;
    Device::enableRequiredFeatures(chain.get<vk::PhysicalDeviceFeatures2>().features,
                                   chain.get<vk::PhysicalDeviceVulkan12Features>(),
                                   chain.get<vk::PhysicalDeviceVulkan13Features>());
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queue{.queueCount = 1, .pQueuePriorities = &priority};
    const auto extensions = Device::requiredExtensions();
    host.device = vk::raii::Device(
        host.physical,
        vk::DeviceCreateInfo{.pNext = &chain.get<vk::PhysicalDeviceFeatures2>(),
                             .queueCreateInfoCount = 1,
                             .pQueueCreateInfos = &queue,
                             .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                             .ppEnabledExtensionNames = extensions.data()});
    host.handles = {.instance = *host.instance,
                    .physicalDevice = *host.physical,
                    .device = *host.device,
                    .queue = *host.device.getQueue(0, 0),
                    .queueFamily = 0};
    return host;
}

TEST_F(DeviceTest, aHostsDeviceServesAndLivesOn) {
    const Host host = makeHost(device().description().name);
    for (int round = 0; round < 2; ++round) {
        const Device wrapped(host.handles);
        EXPECT_EQ(wrapped.description().name, device().description().name);
        const PrefixSum prefixSum(wrapped);
        const Buffer buffer = makeBuffer(
            wrapped, "values", std::vector<std::uint32_t>(PrefixSum::bufferLength(3000), 2));
        Recorder rec(wrapped);
        rec.begin();
        prefixSum.record(rec, buffer, 3000);
        rec.submit();
        EXPECT_EQ(wordsOf(wrapped, buffer, 3000).back(), 2u * 2999);
    }
    // The wrappers are gone; the host goes on with its own handles.
    const vk::raii::Fence fence(host.device, vk::FenceCreateInfo{});
    vk::Queue(host.handles.queue).submit({}, *fence);
    EXPECT_EQ(host.device.waitForFences(*fence, true, 1'000'000'000), vk::Result::eSuccess);
}

TEST_F(DeviceTest, aHostDeviceWithoutHandlesIsRefused) {
    EXPECT_THROW(Device(HostDevice{}), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::gpu
