// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/result.h"
#include "ui/render/scene.h"

namespace imomushi::render {

/// Draws scenes with the OpenGL 3.3 core context that is current on this thread. No Qt. Drivers compute with infinities on purpose: floating-point traps are off
/// inside.
class SceneRenderer {
public:
    /// Errors: "no-opengl" (no 3.3 core context), "bad-shader" with the compiler's log.
    static Result<std::unique_ptr<SceneRenderer>> create();
    virtual ~SceneRenderer() = default;

    /// Draws into framebuffer object `target` (0: the window's), size in device pixels. Values written are sRGB-encoded; with a transparent
    /// background colour is multiplied by alpha. Leaves the context's state at OpenGL's defaults, except the framebuffer binding (`target`)
    /// and the viewport.
    virtual void draw(const Scene& scene, unsigned target, int width, int height) = 0;

    /// Id of the marker (first) or body at a device pixel (origin top left) of the last drawn scene; 0: nothing. `triangle`: of the body, or -1.
    /// `point`: world position there. Draws nothing visible and needs no draw() before.
    struct Pick {
        std::uint64_t id = 0;
        int triangle = -1;
        Vec3 point = Vec3::Zero();
        bool marker = false;
    };
    virtual Pick pick(const Scene& scene, int width, int height, int x, int y) = 0;

    /// Uploads what never changes of a character, unless it is there already. False: the driver has no room for it.
    virtual bool uploadCharacter(const SurfaceRecipe& recipe) = 0;
    /// The GPU can deform this element of the uploaded character.
    [[nodiscard]] virtual bool deforms(int element) const = 0;
    /// OpenGL without a graphics card: deforming with it would cost more than without.
    [[nodiscard]] virtual bool software() const = 0;

    /// Of the last draw(): milliseconds that the processor spent to upload what changed, or to start its deformation on the GPU.
    [[nodiscard]] virtual double uploadMs() const = 0;

    /// Frees all memory of bodies and pictures; the next draw() makes it anew.
    virtual void releaseMemory() = 0;
};

}  // namespace imomushi::render
