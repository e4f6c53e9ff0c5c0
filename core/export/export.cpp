// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/export.h"

#include "core/base/atomic_file.h"
#include "core/base/try.h"
#include "core/export/cache_writer.h"
#include "core/export/fbx.h"
#include "core/export/gltf_check.h"
#include "core/export/gltf_compressor.h"
#include "core/export/gltf_writer.h"
#include "core/export/normal_targets.h"
#include "core/export/vrm_writer.h"

namespace imomushi {

namespace {

constexpr double kBeforeBlender = 0.2;  // of the work for an .fbx file

/// The numbers of the rest shape without body loads.
std::vector<double> plainShape(const ShapeLayout& layout) {
    std::vector<double> shape(static_cast<std::size_t>(layout.size()), 0.0);
    const auto one = [&](int at) { shape[static_cast<std::size_t>(at)] = 1.0; };
    for (std::size_t e = 0; e < layout.elements.size(); ++e) one(layout.element(e) + 3);
    for (int j = 0; j < layout.joints; ++j)
        for (const int at : {3, 4, 8, 12, 16}) one(layout.joint(j) + at);
    return shape;
}

}  // namespace

Result<ExportReport> exportScene(const ExportScene& scene, const ExportOptions& asked, const std::filesystem::path& path, const Progress& whole) {
    const bool fbx = path.extension() == ".fbx", vrm = path.extension() == ".vrm";
    ExportOptions options = asked;
    const double own = fbx ? kBeforeBlender : 1.0;
    const Progress progress = whole.part(0.0, own);
    if (scene.clips.empty()) return fail("bad-value", "There is nothing to export: a clip is missing.");
    if (scene.character.elements.empty()) return fail("no-element", "There is nothing to export: import an element first.");
    if (vrm) {
        // Its players move bones: vertices that follow elements instead would stay behind.
        if (options.layout != ExportLayout::Skinned) return fail("bad-value", "A VRM avatar is moved by its bones: choose the layout \"skinned\".");
        std::vector<const Rig*> rigs;
        for (const auto& rig : scene.rigs) rigs.push_back(rig.rig.get());
        IMOMUSHI_TRY(options.avatar, avatarOf(rigs));
    }
    ExportReport report;
    progress.report("prepare", 0.0);
    IMOMUSHI_TRY(auto motion, Motion::build(scene, options.fps, progress));
    for (std::size_t c = 0; c < scene.clips.size(); ++c)
        report.clips.push_back({scene.clips[c].name, motion.clips[c].times.size(), motion.clips[c].times.back()});
    if (options.layout == ExportLayout::Cache) {
        if (auto written = writeCache(motion, scene, path, report, progress.part(0.1, 1.0)); !written) return tl::unexpected(written.error());
        return report;
    }
    if (!fbx && !vrm && path.extension() != ".glb")
        return fail("unknown-format", "\"" + path.string() + "\" is no place for a character: its name must end in .glb, .vrm or .fbx.");

    GltfContent content{scene, options, motion, {}, {}, {}, {}};
    // Normals are those of the positions that they go with: a skin begins with the body as loads leave it.
    const std::vector<double> plain = motion.withoutMorphs(plainShape(motion.layout).data());
    motion.character.show(options.layout == ExportLayout::Skinned ? motion.restShape.data() : plain.data());
    for (std::size_t e = 0; e < scene.character.elements.size(); ++e)
        if (motion.seen[e].mesh < 0) content.surfaces.push_back(renderSurface(scene, static_cast<int>(e), motion.character.surface(static_cast<int>(e)).normals));
    for (int m = 0, parts = 0; m < static_cast<int>(scene.meshes.size()); ++m) {
        for (auto& surface : partSurfaces(scene, motion, m, parts, motion.character.renderSurface(m).normals)) content.surfaces.push_back(std::move(surface));
        parts += static_cast<int>(scene.meshes[static_cast<std::size_t>(m)].model->parts.size());
    }
    if (options.layout == ExportLayout::Skinned) {
        IMOMUSHI_TRY(auto skin, fitSkin(motion, scene, progress.part(0.1, 0.6)));
        report.skinned = skin.error;
        content.skin = std::move(skin);
    } else {
        MorphErrors errors;
        IMOMUSHI_TRY(content.morphs, buildMorphs(motion, scene, options, options.layout == ExportLayout::Rigged, errors, progress.part(0.1, 0.6)));
        report.warped = errors.warped;
        report.touched = errors.touched;
        report.followed = errors.followed;
        report.dropped = errors.dropped;
        if (options.normals)
            for (const auto& surface : content.surfaces) {
                if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
                content.normalTargets.push_back(normalTargets(content, surface));
            }
    }
    IMOMUSHI_TRY(auto bytes, writeGltf(content, report, progress.part(0.6, 0.8)));
    progress.report("check", 0.8);
    IMOMUSHI_TRY(report.check, checkGltf(bytes, content, motion, report.checked, progress.part(0.8, 0.95)));
    if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
    if (options.compressed && !fbx) {  // Blender would not read it
        report.uncompressed = bytes.size();
        IMOMUSHI_TRY(bytes, compressGlb(bytes));
    }
    progress.report("save", 0.95);
    auto glb = path;
    if (fbx) glb += ".glb";
    if (auto written = writeFileAtomically(glb, bytes); !written) return tl::unexpected(written.error());
    report.bytes = bytes.size();
    if (fbx) {
        const auto worst = convertToFbx(glb, path, framesPerSecond(motion), whole.part(own, 1.0));
        std::error_code ignored;
        std::filesystem::remove(glb, ignored);
        if (!worst) return tl::unexpected(worst.error());
        report.check.largest += *worst / motion.diagonal;
        report.bytes = std::filesystem::file_size(path, ignored);
    }
    report.files.push_back(path);
    return report;
}

}  // namespace imomushi
