// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include <lodestar/gpu/device.hpp>

/// The device that tests run on: Mesa's CPU driver, wherever other drivers are installed too;
/// $LODESTAR_TEST_DEVICE names another, to try the tests on real hardware.
inline std::string testDevice() {
    const char* asked = std::getenv("LODESTAR_TEST_DEVICE");
    return asked && *asked ? asked : "llvmpipe";
}

/// Whether that is the driver whose last bits tests may expect.
inline bool onReferenceDriver() {
    return testDevice() == "llvmpipe";
}

/// A test that needs a device: testDevice(), with validation and synchronization validation.
/// A suite shares one device. A test during which the layers say anything fails. Without the driver
/// or the layers tests are skipped, but fail in CI, which must have both.
class GpuTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        try {
            opened = std::make_unique<lodestar::gpu::Device>(
                lodestar::gpu::DeviceRequest{.device = testDevice(), .validation = true});
        } catch (const lodestar::gpu::DeviceError& error) {
            whyNone = error.what();
        }
    }
    static void TearDownTestSuite() { opened.reset(); }

    void SetUp() override {
        if (!opened && std::getenv("CI")) FAIL() << whyNone;
        if (!opened) GTEST_SKIP() << whyNone;
        messagesBefore = opened->validationMessages().size();
    }
    void TearDown() override {
        if (!opened) return;
        const auto messages = opened->validationMessages();
        for (std::size_t i = messagesBefore; i < messages.size(); ++i)
            ADD_FAILURE() << "validation: " << messages[i];
    }

    static const lodestar::gpu::Device& device() { return *opened; }

private:
    static inline std::unique_ptr<lodestar::gpu::Device> opened;
    static inline std::string whyNone;
    std::size_t messagesBefore = 0;
};
