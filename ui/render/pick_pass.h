// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/pass.h"

namespace imomushi::render {

/// Finds the body under a pixel by drawing that pixel alone.
class PickPass {
public:
    /// Errors: "bad-shader".
    Result<void> prepare();
    /// False: the driver has no memory for a pixel.
    bool resize() { return pixel_.resize(1, 1, GL_RG32UI, GL_DEPTH_COMPONENT24); }
    struct Hit {
        int body = -1;       ///< into scene.bodies; -1: none
        int triangle = -1;   ///< of the body
        Vec3 point = Vec3::Zero();  ///< world, m
        double depth = 0.0;  ///< m in front of the eye, along the view
    };
    /// Pixel (x, y) from the top left.
    [[nodiscard]] Hit bodyAt(const PassInput& in, const GpuDeformer& deformer, int x, int y) const;

private:
    Program identity_;
    Target pixel_;
};

}  // namespace imomushi::render
