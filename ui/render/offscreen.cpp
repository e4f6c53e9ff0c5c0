// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/offscreen.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cfenv>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "ui/render/gl.h"
#include "ui/render/scene_renderer.h"

namespace imomushi::render {

namespace {

class EglContext final : public OffscreenContext {
public:
    EglContext(EGLDisplay display, EGLContext context, EGLSurface surface) : display_(display), context_(context), surface_(surface) {}
    ~EglContext() override {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
        // The display itself stays: it belongs to the process, and others may use it.
        if (traps_) std::fesetenv(&*traps_);
    }
    void makeCurrent() const { eglMakeCurrent(display_, surface_, surface_, context_); }
    /// Puts these back when it goes.
    void restoreTraps(const std::fenv_t& traps) { traps_ = traps; }

private:
    EGLDisplay display_;
    EGLContext context_;
    EGLSurface surface_;
    std::optional<std::fenv_t> traps_;
};

bool listed(const char* extensions, const char* name) { return extensions && std::strstr(extensions, name); }

/// A current 3.3 core context on `display`, or null with `why`.
std::unique_ptr<EglContext> contextOn(EGLDisplay display, std::string& why) {
    const auto failed = [&](const char* what) {
        char code[32];
        std::snprintf(code, sizeof code, " (EGL 0x%x)", static_cast<unsigned>(eglGetError()));
        why = std::string(what) + code;
        return nullptr;
    };
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY) return failed("no display");
    if (!eglInitialize(display, &major, &minor)) return failed("the display does not start");
    if (!eglBindAPI(EGL_OPENGL_API)) return failed("no desktop OpenGL");
    const bool surfaceless = listed(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context");
    const EGLint wanted[] = {EGL_SURFACE_TYPE, surfaceless ? 0 : EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display, wanted, &config, 1, &count) || count < 1) return failed("no OpenGL configuration");
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) return failed("no OpenGL 3.3 context");
    EGLSurface surface = EGL_NO_SURFACE;
    if (!surfaceless) {
        const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
        surface = eglCreatePbufferSurface(display, config, size);
    }
    auto made = std::make_unique<EglContext>(display, context, surface);
    if (!eglMakeCurrent(display, surface, surface, context)) return failed("the context does not become current");
    return made;
}

Result<std::unique_ptr<EglContext>> bestContext() {
    if (!epoxy_has_egl()) return fail("no-opengl", "Drawing without a display needs EGL: install libegl1 and libgl1-mesa-dri.");
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::string why = "no platform without a display", first;
    std::unique_ptr<EglContext> software;
    // A graphics card if there is one, Mesa's software driver otherwise.
    const auto tryDisplay = [&](EGLDisplay display) -> std::unique_ptr<EglContext> {
        auto context = contextOn(display, why);
        if (first.empty() && !context) first = why;
        if (context && isSoftwareRenderer()) {
            if (!software) software = std::move(context);
            return nullptr;
        }
        return context;
    };
    if (listed(client, "EGL_MESA_platform_surfaceless") && listed(client, "EGL_EXT_platform_base"))
        if (auto c = tryDisplay(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr))) return c;
    if (listed(client, "EGL_EXT_platform_device") && (listed(client, "EGL_EXT_device_enumeration") || listed(client, "EGL_EXT_device_base"))) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        if (eglQueryDevicesEXT(16, devices, &count))
            for (EGLint i = 0; i < count; ++i) {
                const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
                if (software && listed(extensions, "EGL_MESA_device_software")) continue;
                if (auto c = tryDisplay(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr))) return c;
            }
    }
    if (!software)
        if (auto c = tryDisplay(eglGetDisplay(EGL_DEFAULT_DISPLAY))) return c;
    if (!software)
        return fail("no-opengl", "Drawing without a display needs OpenGL 3.3 by EGL, and EGL says: " + first + ". Install libegl1 and libgl1-mesa-dri.");
    software->makeCurrent();
    return software;
}

}  // namespace

Result<std::unique_ptr<OffscreenContext>> OffscreenContext::create() {
    std::fenv_t traps;
    std::feholdexcept(&traps);
    auto context = bestContext();
    if (!context) {
        std::fesetenv(&traps);
        return tl::unexpected(context.error());
    }
    (*context)->restoreTraps(traps);
    return std::unique_ptr<OffscreenContext>(std::move(*context));
}

namespace {

Result<std::vector<std::uint8_t>> drawWith(SceneRenderer& renderer, const Scene& scene, int width, int height) {
    const auto noMemory = [] { return fail("out-of-memory", "The graphics driver has no memory for a picture of this size: make it smaller."); };
    Target target;
    if (!target.resize(width, height, GL_RGBA8, 0)) return noMemory();
    renderer.draw(scene, target.framebuffer(), width, height);
    std::vector<std::uint8_t> rows(std::size_t(width) * height * 4);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
    if (glGetError() == GL_OUT_OF_MEMORY) return noMemory();
    // OpenGL's rows start at the bottom.
    const std::size_t row = std::size_t(width) * 4;
    for (int y = 0; y < height / 2; ++y) std::swap_ranges(&rows[row * y], &rows[row * y] + row, &rows[row * (height - 1 - y)]);
    if (scene.transparentBackground)
        for (std::size_t i = 0; i < rows.size(); i += 4) {
            const int a = rows[i + 3];
            for (int c = 0; c < 3 && a > 0; ++c) rows[i + c] = static_cast<std::uint8_t>(std::min(255, (rows[i + c] * 255 + a / 2) / a));
        }
    return rows;
}

/// A thread with an OpenGL context of its own. Whatever its callers draw with stays current with them.
class DrawingThread {
public:
    /// Never destroyed: drivers take themselves apart when the program ends, and must not be called after that.
    static DrawingThread& instance() {
        static auto* thread = new DrawingThread;
        return *thread;
    }

    /// What drawing throws is thrown here; the next picture is drawn from nothing.
    Result<std::vector<std::uint8_t>> draw(const OffscreenView& view, const Scene& scene, int width, int height) {
        const std::lock_guard oneAtATime(callers_);
        Result<std::vector<std::uint8_t>> pixels;
        std::exception_ptr failure;
        run([&] {
            try {
                pixels = paint(view, scene, width, height);
            } catch (...) {
                failure = std::current_exception();
                renderer_.reset();
                last_ = nullptr;
            }
        });
        if (failure) std::rethrow_exception(failure);
        return pixels;
    }
    void release(const OffscreenView& view) noexcept {
        const std::lock_guard oneAtATime(callers_);
        if (last_ != &view) return;
        run([this] {
            last_ = nullptr;
            if (renderer_) renderer_->releaseMemory();
        });
    }

private:
    DrawingThread() : thread_([this] { work(); }) { thread_.detach(); }

    /// The task throws nothing.
    void run(const std::function<void()>& task) {
        std::unique_lock lock(mutex_);
        task_ = &task;
        changed_.notify_all();
        changed_.wait(lock, [&] { return !task_; });
    }
    void work() {
        for (;;) {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return task_ != nullptr; });
            (*task_)();
            task_ = nullptr;
            changed_.notify_all();
        }
    }

    Result<std::vector<std::uint8_t>> paint(const OffscreenView& view, const Scene& scene, int width, int height) {
        if (!context_) {
            auto made = OffscreenContext::create();
            if (!made) return tl::unexpected(made.error());
            context_ = std::move(*made);
        }
        if (!renderer_) {
            auto made = SceneRenderer::create();
            if (!made) return tl::unexpected(made.error());
            renderer_ = std::move(*made);
        }
        if (last_ != &view) renderer_->releaseMemory();
        last_ = &view;
        return drawWith(*renderer_, scene, width, height);
    }

    std::mutex callers_, mutex_;
    std::condition_variable changed_;
    const std::function<void()>* task_ = nullptr;
    const OffscreenView* last_ = nullptr;  ///< whose bodies the renderer has
    std::unique_ptr<OffscreenContext> context_;
    std::unique_ptr<SceneRenderer> renderer_;
    std::thread thread_;
};

}  // namespace

OffscreenView::~OffscreenView() {
    if (drew_) DrawingThread::instance().release(*this);
}

Result<std::vector<std::uint8_t>> OffscreenView::draw(const Scene& scene, int width, int height) {
    if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide || static_cast<long>(width) * height > kMaxPixels)
        return fail("bad-size", "A picture has 1 to " + std::to_string(kLargestSide) + " pixels a side and at most " + std::to_string(kMaxPixels / 1'000'000) + " million in all.");
    drew_ = true;
    return DrawingThread::instance().draw(*this, scene, width, height);
}

Result<std::vector<std::uint8_t>> drawOffscreen(const Scene& scene, int width, int height) { return OffscreenView().draw(scene, width, height); }

}  // namespace imomushi::render
