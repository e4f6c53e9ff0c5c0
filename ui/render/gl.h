// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace imomushi::render {

/// An OpenGL name that is deleted with its owner; 0: none. The context must be current then.
template <void (*destroy)(GLuint)>
class Name {
public:
    Name() = default;
    explicit Name(GLuint name) : name_(name) {}
    Name(Name&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Name& operator=(Name&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~Name() {
        if (name_) destroy(name_);
    }
    operator GLuint() const { return name_; }

private:
    GLuint name_ = 0;
};

inline void deleteBuffer(GLuint n) { glDeleteBuffers(1, &n); }
inline void deleteVertexArray(GLuint n) { glDeleteVertexArrays(1, &n); }
inline void deleteTexture(GLuint n) { glDeleteTextures(1, &n); }
inline void deleteFramebuffer(GLuint n) { glDeleteFramebuffers(1, &n); }
inline void deleteRenderbuffer(GLuint n) { glDeleteRenderbuffers(1, &n); }
inline void deleteSampler(GLuint n) { glDeleteSamplers(1, &n); }
inline void deleteProgram(GLuint n) { glDeleteProgram(n); }
using Buffer = Name<deleteBuffer>;
using VertexArray = Name<deleteVertexArray>;
using TextureName = Name<deleteTexture>;
using Framebuffer = Name<deleteFramebuffer>;
using Renderbuffer = Name<deleteRenderbuffer>;
using Sampler = Name<deleteSampler>;

Buffer makeBuffer();
VertexArray makeVertexArray();
/// Reads a depth texture whose outside is far away: bilinear results of the comparison (less or equal), or `raw` depths of the nearest texel.
Sampler makeDepthSampler(bool raw);
void bindTexture(int unit, GLuint texture);
/// An attribute of the vertex array that is bound: `size` floats in the buffer that is bound, `stride` and `offset` in bytes; `divisor` 1: one per instance.
void floatAttribute(GLuint location, int size, std::size_t stride, std::size_t offset, GLuint divisor = 0);
/// OpenGL on the processor (Mesa's software drivers).
bool isSoftwareRenderer();

/// A vertex and a fragment shader of shaders/, linked. `#include "x.glsl"` lines are resolved. The uniform block Frame is bound to 0.
class Program {
public:
    Program() = default;
    /// Errors: "bad-shader" with the compiler's log.
    static Result<Program> link(const char* vertex, const char* fragment);
    /// A vertex shader alone, whose outputs of these names go one after the other into the transform feedback buffer. The uniform block
    /// ElementState is bound to 1.
    static Result<Program> feedback(const char* vertex, const std::vector<const char*>& outputs);

    void use() const { glUseProgram(name_); }
    // The program must be in use.
    void set(const char* uniform, int value) const { glUniform1i(at(uniform), value); }
    void set(const char* uniform, unsigned value) const { glUniform1ui(at(uniform), value); }
    void set(const char* uniform, float value) const { glUniform1f(at(uniform), value); }
    void set(const char* uniform, const Eigen::Vector2f& v) const { glUniform2fv(at(uniform), 1, v.data()); }
    void set(const char* uniform, const Eigen::Vector3f& v) const { glUniform3fv(at(uniform), 1, v.data()); }
    void set(const char* uniform, const Eigen::Vector4f& v) const { glUniform4fv(at(uniform), 1, v.data()); }
    void set(const char* uniform, const Eigen::Matrix4f& m) const { glUniformMatrix4fv(at(uniform), 1, GL_FALSE, m.data()); }

private:
    static Result<Program> linked(Program program, const std::string& name);
    [[nodiscard]] GLint at(const char* uniform) const { return glGetUniformLocation(name_, uniform); }
    Name<deleteProgram> name_;
};

/// Programs to link, each from a vertex and a fragment shader. Errors: as Program::link().
struct ProgramSource {
    Program* program;
    const char *vertex, *fragment;
};
Result<void> linkAll(std::initializer_list<ProgramSource> sources);

/// A triangle that covers the whole viewport, for fullscreen.vert.
class FullscreenTriangle {
public:
    void prepare() { empty_ = makeVertexArray(); }
    void draw() const {
        glBindVertexArray(empty_);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

private:
    VertexArray empty_;
};

/// A picture to draw into: colour and depth, either of which may be absent (format 0), as textures or, with `samples` > 1, multisampled.
class Target {
public:
    /// Makes it new when anything changed. False: the driver has no memory for it.
    bool resize(int width, int height, GLenum color, GLenum depth, int samples = 1);
    /// Binds it for drawing, with the viewport on all of it.
    void bind() const;
    [[nodiscard]] GLuint framebuffer() const { return framebuffer_; }
    [[nodiscard]] GLuint color() const { return color_; }
    [[nodiscard]] GLuint depth() const { return depth_; }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

private:
    Framebuffer framebuffer_;
    TextureName color_, depth_;
    Renderbuffer colorSamples_, depthSamples_;
    int width_ = 0, height_ = 0, samples_ = 0;
    GLenum colorFormat_ = 0, depthFormat_ = 0;
};

}  // namespace imomushi::render
