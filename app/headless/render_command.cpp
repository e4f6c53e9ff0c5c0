// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/headless/render_command.h"

#include <cmath>
#include <optional>

#include "core/base/finite.h"
#include "core/session/session.h"
#include "core/session/session_access.h"
#include "ui/render/image.h"
#include "ui/render/offscreen.h"
#include "ui/scene/document_scene.h"
#include "ui/scene/framing.h"

namespace imomushi {

namespace {

// Angles beyond these show nothing useful and lose all precision.
constexpr double kMinFov = 0.01, kLargestFov = 3.0;

Result<Vec3> vector(const Json& camera, const char* key) {
    const auto wrong = [&] { return fail("bad-value", std::string("\"camera\" needs \"") + key + "\" as three finite numbers [x, y, z] in metres."); };
    const Json& v = camera.at(key);
    if (!v.is_array() || v.size() != 3) return wrong();
    Vec3 out;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!v[i].is_number()) return wrong();
        out[static_cast<Eigen::Index>(i)] = v[i].get<double>();
    }
    // Single precision is what the graphics card takes.
    if (!allFinite(out) || out.cwiseAbs().maxCoeff() > 1e9) return wrong();
    return out;
}

Result<void> readCamera(const Json& given, render::Camera& camera) {
    for (const auto& [key, value] : given.items())
        if (key != "eye" && key != "target" && key != "up" && key != "fov")
            return fail("unknown-key", "\"camera\" has no key \"" + key + "\": it takes eye, target, up and fov.");
    if (!given.contains("eye") || !given.contains("target")) return fail("missing-key", "\"camera\" needs \"eye\" and \"target\".");
    for (const auto& [key, out] : {std::pair{"eye", &camera.eye}, std::pair{"target", &camera.target}, std::pair{"up", &camera.up}}) {
        if (!given.contains(key)) continue;
        const auto v = vector(given, key);
        if (!v) return tl::unexpected(v.error());
        *out = *v;
    }
    const Vec3 look = camera.target - camera.eye;
    if (look.norm() < 1e-6) return fail("bad-value", "The camera's eye and target are the same point: move them apart.");
    if (camera.up.norm() < 1e-9 || look.normalized().cross(camera.up.normalized()).norm() < 1e-6)
        return fail("bad-value", "The camera's up direction is zero or lies along its view: choose another.");
    if (given.contains("fov")) {
        const Json& fov = given.at("fov");
        if (!fov.is_number() || !(fov.get<double>() >= kMinFov && fov.get<double>() <= kLargestFov))
            return fail("bad-value", "The camera's \"fov\" is the vertical angle in radians, 0.01 to 3.");
        camera.fov = fov.get<double>();
    }
    return {};
}

Result<Json> run(SessionAccess& access, const Json& arguments, const Progress&) {
    const auto width = arguments.at("width").get<long long>(), height = arguments.at("height").get<long long>();
    if (width < 1 || height < 1 || width > render::kLargestSide || height > render::kLargestSide || width * height > render::kMaxPixels)
        return fail("bad-value", "\"width\" and \"height\" are 1 to " + std::to_string(render::kLargestSide) + " pixels and at most " +
                                     std::to_string(render::kMaxPixels / 1'000'000) + " million pixels in all.");
    const auto path = arguments.at("path").get<std::string>();
    if (path.size() < 5 || path.substr(path.size() - 4) != ".png") return fail("bad-value", "\"path\" must end in .png: pictures are written as PNG.");

    render::Scene scene;
    if (arguments.contains("theme")) {
        const auto theme = arguments.at("theme").get<std::string>();
        if (theme != "dark" && theme != "light") return fail("bad-value", "\"theme\" is \"dark\" or \"light\".");
        scene.darkTheme = theme == "dark";
    }
    scene.grid = arguments.value("grid", true);
    scene.transparentBackground = arguments.value("transparent", false);
    // A cut-out goes over other pictures; a grid goes with it only where it is asked for.
    if (scene.transparentBackground && !arguments.contains("grid")) scene.grid = false;
    SceneOptions options;
    options.bones = options.faces = arguments.value("bones", false);
    DocumentScene view;
    view.update(access.session, options, scene);
    // Out-of-date elements are marked for the artist in the studio, not in pictures.
    for (render::Body& body : scene.bodies) body.outdated = false;

    if (arguments.contains("camera")) {
        if (const auto good = readCamera(arguments.at("camera"), scene.camera); !good) return tl::unexpected(good.error());
    } else {
        scene.camera = framed(scene, threeQuarterDirection(), static_cast<double>(width) / static_cast<double>(height));
    }
    const int w = static_cast<int>(width), h = static_cast<int>(height);
    const auto picture = render::drawOffscreen(scene, w, h);
    if (!picture) return tl::unexpected(picture.error());
    if (const auto written = render::writePng(path, *picture, w, h); !written) return tl::unexpected(written.error());
    return Json{{"path", path}, {"width", w}, {"height", h}};
}

}  // namespace

void addRenderCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    Command command;
    command.name = "render";
    command.help = "Draws the character as it is now into a PNG picture, without a display.";
    command.keys = {
        {"path", Type::Text, true, "the picture to write, ending in .png"},
        {"width", Type::Integer, true, "pixels, 1 to 8192"},
        {"height", Type::Integer, true, "pixels, 1 to 8192; at most 36 million pixels in all"},
        {"camera", Type::Object, false, "{eye, target, up, fov}: points [x, y, z] in metres, vertical angle in radians; default: a three-quarter view of everything"},
        {"bones", Type::Boolean, false, "also draws bones and the outlines of joint faces (default false)"},
        {"grid", Type::Boolean, false, "draws the ground grid (default true, false with transparent)"},
        {"transparent", Type::Boolean, false, "no background: the picture has an alpha channel (default false)"},
        {"theme", Type::Text, false, "\"dark\" (default) or \"light\""},
    };
    command.run = run;
    registry.add(std::move(command));
}

}  // namespace imomushi
