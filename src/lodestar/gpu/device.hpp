// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <lodestar/gpu/vulkan.hpp>

namespace lodestar::gpu {

/// No usable Vulkan device: the message says what was found and what to do.
class DeviceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Which device to open.
struct DeviceRequest {
    /// An index as `lodestar info` prints it, or a part of a name (case ignored); empty: the best
    /// one, discrete before integrated before virtual before CPU.
    std::string device;
    /// Validation and synchronization validation; messages are kept for Device::validationMessages.
    bool validation = false;
};

/// A Vulkan device of this machine, usable or not.
struct DeviceDescription {
    std::uint32_t index = 0;
    std::string name, type, driver, api;
    std::string unusableBecause;  ///< empty when lodestar can run on it
};

/// A feature lodestar uses where it is there, and what serves where it is not.
struct OptionalFeature {
    std::string name;
    bool present = false;
    std::string fallback;
};

/// A device that the host program made and keeps: Vulkan 1.3 with the extensions and features of
/// Device::requiredExtensions and Device::enableRequiredFeatures enabled. lodestar never destroys
/// it.
struct HostDevice {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;  ///< graphics + compute; the caller serialises its use
    std::uint32_t queueFamily = 0;
};

/// Memory of one image or buffer, as Vulkan allocated it.
struct Allocation {
    std::string resource;
    std::uint64_t bytes = 0;
};

/// The Vulkan device everything is made on. One queue, one frame in flight. Not thread-safe.
class Device {
public:
    /// Throws DeviceError when no device fits, and Vulkan-Hpp's exceptions when opening fails.
    explicit Device(const DeviceRequest& request = {});
    explicit Device(const HostDevice& host);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    /// All devices of the machine, in the loader's order, with the verdict on each.
    static std::vector<DeviceDescription> enumerate();
    static std::vector<const char*> requiredExtensions();
    /// Adds the features lodestar needs to those a host enables on its own device.
    static void enableRequiredFeatures(vk::PhysicalDeviceFeatures&,
                                       vk::PhysicalDeviceVulkan12Features&,
                                       vk::PhysicalDeviceVulkan13Features&);

    const vk::raii::Device& vk() const { return *device; }
    const vk::raii::PhysicalDevice& physical() const { return *physicalDevice; }
    vk::Queue queue() const { return queueHandle; }
    std::uint32_t queueFamily() const { return family; }

    const DeviceDescription& description() const { return about; }
    const std::string& whyChosen() const { return reason; }
    std::vector<OptionalFeature> optionalFeatures() const;
    /// Milliseconds of one timestamp tick; 0 where the queue has no timestamps.
    double timestampMs() const { return tickMs; }
    bool hasAnisotropy() const { return anisotropy; }
    /// 64-bit integers and 64-bit atomics on buffers: what capture in compute needs.
    bool hasInt64Atomics() const { return int64Atomics; }
    /// Most samples a pixel, up to 8, of colour and depth targets at the standard locations; 1 =
    /// no multisampling.
    std::uint32_t multisamples() const { return samples; }

    /// Records with `record` and waits until the device has run it. For set-up, not for frames.
    void runNow(const std::function<void(const vk::raii::CommandBuffer&)>& record) const;

    /// Memory for one resource, entered in the ledger under `name` until `release(memory)`.
    vk::raii::DeviceMemory allocate(const vk::MemoryRequirements&, vk::MemoryPropertyFlags,
                                    const std::string& name) const;
    void release(const vk::raii::DeviceMemory&) const;
    std::vector<Allocation> allocations() const;  ///< largest first, same names summed
    std::uint64_t allocatedBytes() const { return bytesNow; }
    std::uint64_t peakBytes() const { return bytesPeak; }

    /// Gives a Vulkan object the name that debuggers and validation messages show.
    template <typename Handle>
    void name(const Handle& handle, const std::string& text) const {
        nameObject(Handle::objectType,
                   reinterpret_cast<std::uint64_t>(static_cast<typename Handle::CType>(*handle)),
                   text);
    }
    bool hasDebugNames() const { return debugNames; }

    /// What the validation layers said since the device was opened. Empty = silent.
    std::vector<std::string> validationMessages() const;

private:
    struct Messages {
        std::mutex mutex;
        std::vector<std::string> texts;
    };
    void open(std::uint32_t deviceIndex);
    void readProperties();
    void nameObject(vk::ObjectType, std::uint64_t handle, const std::string& text) const;
    static VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                    VkDebugUtilsMessageTypeFlagsEXT,
                                                    const VkDebugUtilsMessengerCallbackDataEXT*,
                                                    void*);

    mutable Messages messages;
    vk::raii::Context context;
    std::optional<vk::raii::Instance> instance;
    std::optional<vk::raii::DebugUtilsMessengerEXT> messenger;
    std::optional<vk::raii::PhysicalDevice> physicalDevice;
    std::optional<vk::raii::Device> device;
    std::optional<vk::raii::CommandPool> setupPool;
    vk::Queue queueHandle;
    vk::PhysicalDeviceMemoryProperties memoryProperties;
    DeviceDescription about;
    std::string reason;
    std::uint32_t family = 0;
    double tickMs = 0;
    bool debugNames = false, anisotropy = false, int64Atomics = false, hostOwned = false;
    std::uint32_t samples = 1;

    mutable std::map<VkDeviceMemory, Allocation> ledger;
    mutable std::uint64_t bytesNow = 0, bytesPeak = 0;
};

}  // namespace lodestar::gpu
