// SPDX-License-Identifier: Apache-2.0
#pragma once

// Structs are written with designated initialisers.
#define VULKAN_HPP_NO_STRUCT_CONSTRUCTORS
#include <vulkan/vulkan_raii.hpp>
