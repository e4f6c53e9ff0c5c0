// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/gl.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "ui/render/shaders.h"

namespace imomushi::render {

Buffer makeBuffer() {
    GLuint n = 0;
    glGenBuffers(1, &n);
    return Buffer(n);
}

VertexArray makeVertexArray() {
    GLuint n = 0;
    glGenVertexArrays(1, &n);
    return VertexArray(n);
}

Sampler makeDepthSampler(bool raw) {
    GLuint n = 0;
    glGenSamplers(1, &n);
    const GLint filter = raw ? GL_NEAREST : GL_LINEAR;
    glSamplerParameteri(n, GL_TEXTURE_MIN_FILTER, filter);
    glSamplerParameteri(n, GL_TEXTURE_MAG_FILTER, filter);
    if (!raw) {
        glSamplerParameteri(n, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        glSamplerParameteri(n, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    }
    const float far[4] = {1, 1, 1, 1};
    glSamplerParameteri(n, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glSamplerParameteri(n, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glSamplerParameterfv(n, GL_TEXTURE_BORDER_COLOR, far);
    return Sampler(n);
}

void bindTexture(int unit, GLuint texture) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, texture);
}

bool isSoftwareRenderer() {
    const char* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return !renderer || std::strstr(renderer, "llvmpipe") || std::strstr(renderer, "softpipe") || std::strstr(renderer, "swrast");
}

void floatAttribute(GLuint location, int size, std::size_t stride, std::size_t offset, GLuint divisor) {
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride), reinterpret_cast<const void*>(offset));
    glVertexAttribDivisor(location, divisor);
}

namespace {

void appendShader(std::string_view name, std::string& out) {
    std::string_view text = shaderText(name);
    constexpr std::string_view kInclude = "#include \"";
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
        const std::string_view line = text.substr(0, end);
        if (line.starts_with(kInclude))
            appendShader(line.substr(kInclude.size(), line.find('"', kInclude.size()) - kInclude.size()), out);
        else
            out.append(line);
        text.remove_prefix(end);
    }
}

Result<GLuint> compile(GLenum kind, const char* name) {
    std::string text;
    appendShader(name, text);
    const GLuint shader = glCreateShader(kind);
    const char* start = text.c_str();
    glShaderSource(shader, 1, &start, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good) return shader;
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    return fail("bad-shader", std::string("The graphics driver refuses the shader ") + name + ": " + log);
}

}  // namespace

Result<Program> Program::linked(Program program, const std::string& name) {
    glLinkProgram(program.name_);
    GLint good = 0;
    glGetProgramiv(program.name_, GL_LINK_STATUS, &good);
    if (!good) {
        char log[2000] = "";
        glGetProgramInfoLog(program.name_, sizeof log, nullptr, log);
        return fail("bad-shader", "The graphics driver cannot link " + name + ": " + log);
    }
    GLuint binding = 0;
    for (const char* block : {"Frame", "ElementState"}) {
        const GLuint index = glGetUniformBlockIndex(program.name_, block);
        if (index != GL_INVALID_INDEX) glUniformBlockBinding(program.name_, index, binding);
        ++binding;
    }
    return program;
}

Result<Program> Program::link(const char* vertex, const char* fragment) {
    const auto v = compile(GL_VERTEX_SHADER, vertex);
    if (!v) return tl::unexpected(v.error());
    const auto f = compile(GL_FRAGMENT_SHADER, fragment);
    if (!f) {
        glDeleteShader(*v);
        return tl::unexpected(f.error());
    }
    Program p;
    p.name_ = Name<deleteProgram>(glCreateProgram());
    for (const GLuint shader : {*v, *f}) {
        glAttachShader(p.name_, shader);
        glDeleteShader(shader);
    }
    return linked(std::move(p), std::string(vertex) + " and " + fragment);
}

Result<Program> Program::feedback(const char* vertex, const std::vector<const char*>& outputs) {
    const auto v = compile(GL_VERTEX_SHADER, vertex);
    if (!v) return tl::unexpected(v.error());
    Program p;
    p.name_ = Name<deleteProgram>(glCreateProgram());
    glAttachShader(p.name_, *v);
    glDeleteShader(*v);
    glTransformFeedbackVaryings(p.name_, static_cast<GLsizei>(outputs.size()), outputs.data(), GL_INTERLEAVED_ATTRIBS);
    return linked(std::move(p), vertex);
}

Result<void> linkAll(std::initializer_list<ProgramSource> sources) {
    for (const ProgramSource& source : sources) {
        auto program = Program::link(source.vertex, source.fragment);
        if (!program) return tl::unexpected(program.error());
        *source.program = std::move(*program);
    }
    return {};
}

namespace {

bool isDepth(GLenum format) { return format == GL_DEPTH_COMPONENT24 || format == GL_DEPTH_COMPONENT32F; }
bool isInteger(GLenum format) { return format == GL_RG32UI; }

TextureName makeTexture(GLenum format, int width, int height) {
    GLuint n = 0;
    glGenTextures(1, &n);
    glBindTexture(GL_TEXTURE_2D, n);
    if (isDepth(format))
        glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    else if (isInteger(format))
        glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, GL_RG_INTEGER, GL_UNSIGNED_INT, nullptr);
    else
        glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
    const GLint filter = isInteger(format) || isDepth(format) ? GL_NEAREST : GL_LINEAR;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return TextureName(n);
}

Renderbuffer makeRenderbuffer(GLenum format, int width, int height, int samples) {
    GLuint n = 0;
    glGenRenderbuffers(1, &n);
    glBindRenderbuffer(GL_RENDERBUFFER, n);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    return Renderbuffer(n);
}

}  // namespace

bool Target::resize(int width, int height, GLenum color, GLenum depth, int samples) {
    if (framebuffer_ && width == width_ && height == height_ && samples == samples_ && color == colorFormat_ && depth == depthFormat_)
        return true;
    framebuffer_ = {};
    color_ = {};
    depth_ = {};
    colorSamples_ = {};
    depthSamples_ = {};
    width_ = width, height_ = height, samples_ = samples, colorFormat_ = color, depthFormat_ = depth;
    GLuint n = 0;
    glGenFramebuffers(1, &n);
    framebuffer_ = Framebuffer(n);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    if (color && samples > 1) {
        colorSamples_ = makeRenderbuffer(color, width, height, samples);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colorSamples_);
    } else if (color) {
        color_ = makeTexture(color, width, height);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color_, 0);
    } else {
        glDrawBuffer(GL_NONE);
        glReadBuffer(GL_NONE);
    }
    if (depth && samples > 1) {
        depthSamples_ = makeRenderbuffer(depth, width, height, samples);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depthSamples_);
    } else if (depth) {
        depth_ = makeTexture(depth, width, height);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_, 0);
    }
    const bool good = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    if (!good) framebuffer_ = {};
    return good;
}

void Target::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width_, height_);
}

}  // namespace imomushi::render
