// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/device.hpp>

#include <algorithm>
#include <cctype>
#include <cstring>

#include <fmt/format.h>

namespace lodestar::gpu {
namespace {

constexpr std::uint32_t kApiVersion = VK_API_VERSION_1_3;

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

bool hasLayer(const vk::raii::Context& context, const char* name) {
    for (const auto& layer : context.enumerateInstanceLayerProperties())
        if (std::strcmp(layer.layerName, name) == 0) return true;
    return false;
}

bool hasInstanceExtension(const vk::raii::Context& context, const char* name) {
    for (const auto& extension : context.enumerateInstanceExtensionProperties())
        if (std::strcmp(extension.extensionName, name) == 0) return true;
    return false;
}

vk::raii::Instance makeInstance(const vk::raii::Context& context, bool validation) {
    constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";
    std::vector<const char*> layers, extensions;
    if (validation) {
        if (!hasLayer(context, kLayer))
            throw DeviceError(
                "the Vulkan validation layer is not installed; install vulkan-validationlayers or "
                "run without validation");
        layers.push_back(kLayer);
        extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    }
    if (hasInstanceExtension(context, VK_EXT_DEBUG_UTILS_EXTENSION_NAME))
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

    const vk::ApplicationInfo application{.pApplicationName = "lodestar",
                                          .apiVersion = kApiVersion};
    const std::array enabled{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
    const vk::ValidationFeaturesEXT features{
        .enabledValidationFeatureCount = static_cast<std::uint32_t>(enabled.size()),
        .pEnabledValidationFeatures = enabled.data()};
    const vk::InstanceCreateInfo info{
        .pNext = validation ? &features : nullptr,
        .pApplicationInfo = &application,
        .enabledLayerCount = static_cast<std::uint32_t>(layers.size()),
        .ppEnabledLayerNames = layers.data(),
        .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
        .ppEnabledExtensionNames = extensions.data()};
    try {
        return {context, info};
    } catch (const vk::IncompatibleDriverError&) {
        throw DeviceError(
            "no Vulkan driver found; install one (on Debian without a GPU: mesa-vulkan-drivers)");
    }
}

std::optional<std::uint32_t> queueFamilyOf(const vk::raii::PhysicalDevice& device) {
    constexpr auto kNeeded = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
    const auto families = device.getQueueFamilyProperties();
    for (std::uint32_t i = 0; i < families.size(); ++i)
        if ((families[i].queueFlags & kNeeded) == kNeeded) return i;
    return std::nullopt;
}

bool hasDeviceExtension(const vk::raii::PhysicalDevice& device, const char* name) {
    for (const auto& extension : device.enumerateDeviceExtensionProperties())
        if (std::strcmp(extension.extensionName, name) == 0) return true;
    return false;
}

using FeatureChain =
    vk::StructureChain<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan11Features,
                       vk::PhysicalDeviceVulkan12Features, vk::PhysicalDeviceVulkan13Features>;

/// The parts of a feature chain in which lodestar has needs.
struct Features {
    vk::PhysicalDeviceFeatures& core;
    vk::PhysicalDeviceVulkan12Features& v12;
    vk::PhysicalDeviceVulkan13Features& v13;

    explicit Features(FeatureChain& chain)
        : Features(chain.get<vk::PhysicalDeviceFeatures2>().features,
                   chain.get<vk::PhysicalDeviceVulkan12Features>(),
                   chain.get<vk::PhysicalDeviceVulkan13Features>()) {}
    Features(vk::PhysicalDeviceFeatures& f, vk::PhysicalDeviceVulkan12Features& f12,
             vk::PhysicalDeviceVulkan13Features& f13)
        : core(f), v12(f12), v13(f13) {}
};

struct RequiredFeature {
    const char* name;
    VkBool32& (*field)(const Features&);
};

constexpr RequiredFeature kRequiredFeatures[] = {
    {"depthClamp", [](const Features& f) -> VkBool32& { return f.core.depthClamp; }},
    {"scalarBlockLayout", [](const Features& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    {"synchronization2", [](const Features& f) -> VkBool32& { return f.v13.synchronization2; }},
    {"dynamicRendering", [](const Features& f) -> VkBool32& { return f.v13.dynamicRendering; }},
    {"maintenance4", [](const Features& f) -> VkBool32& { return f.v13.maintenance4; }},
};

FeatureChain supportedFeatures(const vk::raii::PhysicalDevice& device) {
    return device
        .getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan11Features,
                      vk::PhysicalDeviceVulkan12Features, vk::PhysicalDeviceVulkan13Features>();
}

bool supportsInt64Atomics(const vk::raii::PhysicalDevice& device) {
    FeatureChain chain = supportedFeatures(device);
    return chain.get<vk::PhysicalDeviceFeatures2>().features.shaderInt64 &&
           chain.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics;
}

/// The most, up to 8, that colour and depth targets and their reading all take.
std::uint32_t mostSamples(const vk::PhysicalDeviceLimits& limits) {
    const vk::SampleCountFlags both = limits.framebufferColorSampleCounts &
                                      limits.framebufferDepthSampleCounts &
                                      limits.sampledImageColorSampleCounts;
    if (!limits.standardSampleLocations) return 1;
    if (both & vk::SampleCountFlagBits::e8) return 8;
    return both & vk::SampleCountFlagBits::e4 ? 4 : 1;
}

std::string whyUnusable(const vk::raii::PhysicalDevice& device) {
    const auto properties = device.getProperties();
    if (properties.apiVersion < kApiVersion)
        return fmt::format("it has Vulkan {}.{}, 1.3 is needed",
                           VK_API_VERSION_MAJOR(properties.apiVersion),
                           VK_API_VERSION_MINOR(properties.apiVersion));
    for (const char* extension : Device::requiredExtensions())
        if (!hasDeviceExtension(device, extension)) return fmt::format("it lacks {}", extension);
    FeatureChain chain = supportedFeatures(device);
    const Features features(chain);
    for (const RequiredFeature& feature : kRequiredFeatures)
        if (!feature.field(features)) return fmt::format("it lacks the feature {}", feature.name);
    if (!queueFamilyOf(device)) return "it has no queue for both graphics and compute";
    return "";
}

DeviceDescription describe(const vk::raii::PhysicalDevice& device, std::uint32_t index) {
    const auto chain =
        device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
    const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
    return {.index = index,
            .name = properties.deviceName.data(),
            .type = vk::to_string(properties.deviceType),
            .driver = fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data()),
            .api = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(properties.apiVersion),
                               VK_API_VERSION_MINOR(properties.apiVersion),
                               VK_API_VERSION_PATCH(properties.apiVersion)),
            .unusableBecause = whyUnusable(device)};
}

int rank(const DeviceDescription& device) {
    if (device.type == "DiscreteGpu") return 4;
    if (device.type == "IntegratedGpu") return 3;
    if (device.type == "VirtualGpu") return 2;
    return 1;
}

struct Choice {
    std::uint32_t index;
    std::string reason;
};

Choice choose(const std::vector<DeviceDescription>& devices, const std::string& request) {
    std::string list;
    for (const auto& d : devices)
        list += fmt::format("{}{}: {}", list.empty() ? "" : ", ", d.index, d.name);
    if (devices.empty())
        throw DeviceError(
            "the Vulkan drivers installed report no device; install one that fits this machine (on "
            "Debian without a GPU: mesa-vulkan-drivers)");
    if (!request.empty()) {
        const bool isIndex = std::all_of(request.begin(), request.end(),
                                         [](unsigned char c) { return std::isdigit(c) != 0; });
        for (const auto& d : devices) {
            const bool match = isIndex ? std::to_string(d.index) == request
                                       : lower(d.name).find(lower(request)) != std::string::npos;
            if (!match) continue;
            if (!d.unusableBecause.empty())
                throw DeviceError(fmt::format("device {} ({}) cannot be used: {}", d.index, d.name,
                                              d.unusableBecause));
            return {d.index, fmt::format("asked for by --device {}", request)};
        }
        throw DeviceError(fmt::format("no Vulkan device matches '{}'; there is {}", request, list));
    }
    const DeviceDescription* best = nullptr;
    for (const auto& d : devices)
        if (d.unusableBecause.empty() && (!best || rank(d) > rank(*best))) best = &d;
    if (!best)
        throw DeviceError(fmt::format("no Vulkan device can be used: {} ({})", list,
                                      devices.front().unusableBecause));
    return {best->index, devices.size() == 1
                             ? "the only device"
                             : fmt::format("{} comes first among the usable ones (discrete, "
                                           "integrated, virtual, CPU)",
                                           best->type)};
}

}  // namespace

std::vector<const char*> Device::requiredExtensions() {
    return {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
}

void Device::enableRequiredFeatures(vk::PhysicalDeviceFeatures& core,
                                    vk::PhysicalDeviceVulkan12Features& v12,
                                    vk::PhysicalDeviceVulkan13Features& v13) {
    const Features features(core, v12, v13);
    for (const RequiredFeature& feature : kRequiredFeatures) feature.field(features) = VK_TRUE;
}

std::vector<DeviceDescription> Device::enumerate() {
    const vk::raii::Context context;
    const vk::raii::Instance instance = makeInstance(context, false);
    std::vector<DeviceDescription> devices;
    for (const auto& device : vk::raii::PhysicalDevices(instance))
        devices.push_back(describe(device, static_cast<std::uint32_t>(devices.size())));
    return devices;
}

Device::Device(const DeviceRequest& request) {
    instance.emplace(makeInstance(context, request.validation));
    debugNames = hasInstanceExtension(context, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (request.validation) {
        using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
        using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
        messenger.emplace(*instance, vk::DebugUtilsMessengerCreateInfoEXT{
                                         .messageSeverity = Severity::eWarning | Severity::eError,
                                         // Not ePerformance: it minds that images live in GENERAL.
                                         .messageType = Type::eValidation,
                                         .pfnUserCallback = &onMessage,
                                         .pUserData = &messages});
    }
    vk::raii::PhysicalDevices all(*instance);
    std::vector<DeviceDescription> devices;
    for (const auto& device : all)
        devices.push_back(describe(device, static_cast<std::uint32_t>(devices.size())));
    const Choice choice = choose(devices, request.device);
    about = devices[choice.index];
    reason = choice.reason;
    physicalDevice.emplace(std::move(all[choice.index]));
    family = *queueFamilyOf(*physicalDevice);
    open(choice.index);
    readProperties();
}

Device::Device(const HostDevice& host) : hostOwned(true) {
    if (!host.instance || !host.physicalDevice || !host.device || !host.queue)
        throw std::invalid_argument("HostDevice: every handle must be set");
    instance.emplace(context, host.instance);
    physicalDevice.emplace(*instance, host.physicalDevice);
    device.emplace(*physicalDevice, host.device);
    queueHandle = host.queue;
    family = host.queueFamily;
    about = describe(*physicalDevice, 0);
    reason = "the host program's device";
    readProperties();
}

Device::~Device() {
    if (device) device->waitIdle();
    setupPool.reset();
    if (hostOwned) {
        device->release();
        instance->release();
    }
}

void Device::open(std::uint32_t) {
    FeatureChain supported = supportedFeatures(*physicalDevice);
    FeatureChain enabled;
    enableRequiredFeatures(enabled.get<vk::PhysicalDeviceFeatures2>().features,
                           enabled.get<vk::PhysicalDeviceVulkan12Features>(),
                           enabled.get<vk::PhysicalDeviceVulkan13Features>());
    enabled.get<vk::PhysicalDeviceFeatures2>().features.samplerAnisotropy =
        supported.get<vk::PhysicalDeviceFeatures2>().features.samplerAnisotropy;
    enabled.get<vk::PhysicalDeviceFeatures2>().features.sampleRateShading =
        supported.get<vk::PhysicalDeviceFeatures2>().features.sampleRateShading;
    if (supportsInt64Atomics(*physicalDevice)) {
        enabled.get<vk::PhysicalDeviceFeatures2>().features.shaderInt64 = VK_TRUE;
        enabled.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics = VK_TRUE;
    }

    const float priority = 1;
    const vk::DeviceQueueCreateInfo queueInfo{
        .queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
    const auto extensions = requiredExtensions();
    device.emplace(
        *physicalDevice,
        vk::DeviceCreateInfo{.pNext = &enabled.get<vk::PhysicalDeviceFeatures2>(),
                             .queueCreateInfoCount = 1,
                             .pQueueCreateInfos = &queueInfo,
                             .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                             .ppEnabledExtensionNames = extensions.data()});
    queueHandle = *device->getQueue(family, 0);
}

void Device::readProperties() {
    memoryProperties = physicalDevice->getMemoryProperties();
    const auto queues = physicalDevice->getQueueFamilyProperties();
    if (queues[family].timestampValidBits > 0)
        tickMs = physicalDevice->getProperties().limits.timestampPeriod * 1e-6;
    // What a host enabled beyond the requirements is not known.
    anisotropy = physicalDevice->getFeatures().samplerAnisotropy && !hostOwned;
    int64Atomics = supportsInt64Atomics(*physicalDevice) && !hostOwned;
    if (physicalDevice->getFeatures().sampleRateShading && !hostOwned)
        samples = mostSamples(physicalDevice->getProperties().limits);
    setupPool.emplace(*device,
                      vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eTransient,
                                                .queueFamilyIndex = family});
}

std::vector<OptionalFeature> Device::optionalFeatures() const {
    return {{"timestamps", tickMs > 0, "frame times from the CPU clock, none per pass"},
            {"samplerAnisotropy", anisotropy, "trilinear texture filtering"},
            {"64-bit atomics", int64Atomics, "visibility captured by the raster pipeline"},
            {"multisampling", samples > 1, "visibility captured by supersampling"},
            {"VK_EXT_debug_utils", debugNames, "objects and passes without names in debuggers"}};
}

void Device::runNow(const std::function<void(const vk::raii::CommandBuffer&)>& record) const {
    vk::raii::CommandBuffers buffers(*device, {.commandPool = **setupPool,
                                               .level = vk::CommandBufferLevel::ePrimary,
                                               .commandBufferCount = 1});
    const vk::raii::CommandBuffer& commands = buffers.front();
    commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    record(commands);
    commands.end();
    const vk::raii::Fence fence(*device, vk::FenceCreateInfo{});
    const vk::CommandBuffer handle = *commands;
    queueHandle.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle}, *fence);
    if (device->waitForFences(*fence, true, UINT64_MAX) != vk::Result::eSuccess)
        throw DeviceError("waiting for the device failed");
}

vk::raii::DeviceMemory Device::allocate(const vk::MemoryRequirements& requirements,
                                        vk::MemoryPropertyFlags flags,
                                        const std::string& name) const {
    for (std::uint32_t i = 0; i < memoryProperties.memoryTypeCount; ++i) {
        if (!(requirements.memoryTypeBits & (1u << i))) continue;
        if ((memoryProperties.memoryTypes[i].propertyFlags & flags) != flags) continue;
        vk::raii::DeviceMemory memory(
            *device,
            vk::MemoryAllocateInfo{.allocationSize = requirements.size, .memoryTypeIndex = i});
        ledger[*memory] = {name, requirements.size};
        bytesNow += requirements.size;
        bytesPeak = std::max(bytesPeak, bytesNow);
        this->name(memory, name);
        return memory;
    }
    throw DeviceError(fmt::format("{} has no memory type for '{}'", about.name, name));
}

void Device::release(const vk::raii::DeviceMemory& memory) const {
    const auto entry = ledger.find(*memory);
    if (entry == ledger.end()) return;
    bytesNow -= entry->second.bytes;
    ledger.erase(entry);
}

std::vector<Allocation> Device::allocations() const {
    std::map<std::string, std::uint64_t> sums;
    for (const auto& [memory, allocation] : ledger) sums[allocation.resource] += allocation.bytes;
    std::vector<Allocation> sorted;
    for (const auto& [resource, bytes] : sums) sorted.push_back({resource, bytes});
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.bytes > b.bytes; });
    return sorted;
}

void Device::nameObject(vk::ObjectType type, std::uint64_t handle, const std::string& text) const {
    if (!debugNames) return;
    device->setDebugUtilsObjectNameEXT(
        {.objectType = type, .objectHandle = handle, .pObjectName = text.c_str()});
}

std::vector<std::string> Device::validationMessages() const {
    const std::lock_guard lock(messages.mutex);
    return messages.texts;
}

VkBool32 Device::onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& messages = *static_cast<Messages*>(user);
    const std::lock_guard lock(messages.mutex);
    messages.texts.emplace_back(data->pMessage);
    return VK_FALSE;
}

}  // namespace lodestar::gpu
