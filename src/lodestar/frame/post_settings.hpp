// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/post/dof_options.hpp>
#include <lodestar/post/ssao_options.hpp>

namespace lodestar::frame {

/// Which effects a picture has, and how they are made. How coarse their grids B are is in
/// budget::Levers.
struct PostSettings {
    bool ssao = false;  ///< screen-space ambient occlusion, of the ambient light alone
    post::SsaoOptions occlusion{.radius = 0};  ///< radius 0: 1/40 of the scene's
    /// Depth of field. Focus 0: at the distance of what the camera looks at; full 0: sharp is 1/20
    /// and full 6/10 of the focus.
    std::optional<post::DofOptions> dof;
    /// Motion blur: the share of the time from frame to frame that the shutter is open, 0 … 1.
    float shutter = 0;
    /// Results come to grid O by the joint bilateral filter; else by linear interpolation.
    bool bilateral = true;
    /// Inputs by downsampling what grid O has, as the thesis's reference does, in the place of
    /// representatives.
    bool downsampled = false;

    bool any() const { return ssao || dof || shutter > 0; }
};

}  // namespace lodestar::frame
