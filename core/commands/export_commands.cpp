// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/export_commands.h"

#include <algorithm>
#include <array>

#include "core/commands/core_commands.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/rig_movers.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

constexpr double kFastest = 1000.0;  // frames per second
constexpr int kMaxTargetsAsked = 1000;

constexpr std::array<std::pair<const char*, ExportLayout>, 4> kLayouts = {
    {{"baked", ExportLayout::Baked}, {"rigged", ExportLayout::Rigged}, {"skinned", ExportLayout::Skinned}, {"cache", ExportLayout::Cache}}};

ExportOptions options(bool split, bool quantised, double fps) {
    ExportOptions out;
    out.split = split;
    out.quantised = quantised;
    out.fps = fps;
    return out;
}

template <class List>
std::string listed(const List& list) {
    std::string names;
    for (const auto& item : list) names += std::string(names.empty() ? "\"" : ", \"") + std::get<0>(item) + "\"";
    return names;
}

Json errorJson(const ExportError& error) { return Json{{"max_percent", 100.0 * error.largest}, {"rms_percent", 100.0 * error.rms}}; }

/// Takes as clips; `rigged`: with their poses. One that was recorded on another character is its poses.
ExportClip clipOf(const std::shared_ptr<const Take>& take, const CharacterPlan& shown, const Character& character, bool rigged, std::vector<ExportWarning>& warnings) {
    ExportClip clip{take->name, take->times, {}, {}};
    const bool fits = take->elements == shown.elements && take->layout == character.shapeLayout();
    if (fits) clip.shape = [take](std::size_t frame, double* numbers) { take->shapes.at(frame, numbers); };
    if (!fits)
        warnings.push_back({"poses-only", take->name, "The character is not what it was when \"" + take->name + "\" was recorded: its poses are written without what effects added."});
    for (std::size_t f = 0; (!fits || rigged) && f < take->times.size(); ++f) clip.poses.push_back(takePose(*take, {f, 0.0}, shown.bones, shown.input.skeleton));
    return clip;
}

/// The takes that are asked for, in the order of the document. Errors: "no-such-take", "bad-type".
Result<std::vector<std::shared_ptr<const Take>>> takesOf(const Document& document, const Json* asked) {
    std::vector<std::shared_ptr<const Take>> takes;
    if (!asked) {
        for (const auto& [id, take] : document.takes) takes.push_back(take);
        return takes;
    }
    const Json names = asked->is_array() ? *asked : Json::array({*asked});
    for (const Json& name : names) {
        if (!name.is_string()) return fail("bad-type", "\"take\" must be the name of a take, or a list of names.");
        IMOMUSHI_TRY(const auto take, takeOf(document, name.get_ref<const std::string&>()));
        if (std::find(takes.begin(), takes.end(), take) == takes.end()) takes.push_back(take);
    }
    return takes;
}

/// What became of an effect.
Json effectJson(const ExportPlan& plan, const ExportReport& report, EffectKind kind) {
    const auto told = [&](const char* result) { return Json{{"effect", effectName(kind)}, {"result", result}}; };
    const auto fitted = [&](const ExportError& error) {
        Json answer = told("fitted");
        answer["error"] = errorJson(error);
        return answer;
    };
    const EffectDescriptor& effect = effectDescriptor(kind);
    if (effect.dependsOnMotion && !plan.performed) return told("dropped");
    if (plan.options.layout == ExportLayout::Cache) return told("exact");
    const bool ofBones = effect.scope == EffectScope::Bones;
    if (plan.options.layout == ExportLayout::Skinned) return ofBones ? told("exact") : fitted(report.skinned);
    if (kind == EffectKind::BendWarp) return fitted(report.warped);
    if (kind == EffectKind::Touch && report.touched.largest > 0.0) return fitted(report.touched);
    if (!ofBones && report.dropped.largest > 0.0) return fitted(report.dropped);
    return told("exact");
}

Result<Json> exportCommand(SessionAccess& access, const Json& arguments, const Progress& progress) {
    IMOMUSHI_TRY(const auto plan, planExport(access.session, arguments));
    return runExport(plan, progress);
}

}  // namespace

std::span<const ExportPreset> exportPresets() {
    static const std::array<ExportPreset, 6> presets = {{
        {"exact", "all targets, keys as recorded", options(false, false, 0.0)},
        {"blender", "weights of 0 to 1, to which Blender clamps them, at 60 frames per second", options(true, false, 60.0)},
        {"godot", "all targets, at 60 frames per second", options(false, false, 60.0)},
        {"unity", "weights of 0 to 1, to which Unity clamps them, at 60 frames per second", options(true, false, 60.0)},
        {"unreal", "weights of 0 to 1, at 30 frames per second", options(true, false, 30.0)},
        {"threejs", "16-bit coordinates, for small files", options(false, true, 0.0)},
    }};
    return presets;
}

Result<ExportPlan> planExport(const Session& session, const Json& arguments) {
    const Document& document = session.document();
    ExportPlan plan;
    if (const Json* name = find(arguments, "preset")) {
        const auto presets = exportPresets();
        const auto preset = std::find_if(presets.begin(), presets.end(), [&](const ExportPreset& p) { return *name == p.name; });
        if (preset == presets.end()) {
            std::string names;
            for (const auto& p : presets) names += std::string(names.empty() ? "\"" : ", \"") + p.name + "\"";
            return fail("bad-value", "\"preset\" must be one of " + names + ".");
        }
        plan.options = preset->options;
    }
    const auto layout = std::find_if(kLayouts.begin(), kLayouts.end(), [&](const auto& l) { return text(arguments, "layout") == l.first; });
    if (layout == kLayouts.end()) return fail("bad-value", "\"layout\" must be one of " + listed(kLayouts) + ".");
    plan.options.layout = layout->second;
    if (auto ok = readNumber(arguments, "fps", 0.0, kFastest, plan.options.fps); !ok) return tl::unexpected(ok.error());
    if (const Json* targets = find(arguments, "targets")) {
        if (*targets == "all") {
            plan.options.targets = 0;
        } else {
            IMOMUSHI_TRY(const auto given, numberWithin(*targets, "targets", 1, kMaxTargetsAsked));
            plan.options.targets = static_cast<int>(given);
        }
    }
    if (auto ok = readNumber(arguments, "tolerance", 0.0, 1.0, plan.options.tolerance); !ok) return tl::unexpected(ok.error());
    IMOMUSHI_TRY(plan.path, pathFrom(arguments));
    // Blender makes FBX, and clamps.
    plan.options.split = arguments.value("split", plan.options.split || plan.path.extension() == ".fbx");
    plan.options.quantised = arguments.value("quantise", plan.options.quantised);
    plan.options.compressed = arguments.value("compress", false);
    plan.options.normals = arguments.value("normals", plan.options.normals);

    IMOMUSHI_TRY(const auto alive, session.builtCharacter());
    if (!alive || document.elements.empty()) return fail("no-element", "There is nothing to export: import an element first.");
    const Character& character = *alive;
    const CharacterPlan& shown = session.plan();
    plan.scene.name = plan.path.stem().string();
    plan.scene.character = character.input();
    plan.scene.character.effects = characterEffects(document);  // their numbers of now
    for (const PartId id : shown.elements) {
        const Element& element = *document.elements.at(id);
        plan.scene.elements.push_back(element.name);
        plan.scene.colors.push_back(element.color);
        if (!element.faces.empty() && !session.responses().fittingOf(id))
            plan.warnings.push_back({"not-precomputed", element.name, "\"" + element.name + "\" is not precomputed and follows its bones rigidly: precompute it first."});
        else if (session.responses().isDraft(id))
            plan.warnings.push_back({"draft", element.name, "\"" + element.name + "\" goes out as a draft: precompute it for what its settings ask for."});
    }
    for (const PartId id : shown.characters) {
        const CharacterSource& source = *document.characters.at(id);
        ExportedMesh mesh{source.name, source.model, {}};
        for (const PartId element : document.elementsOf(id)) mesh.elements.push_back(shown.elementIndex(element));
        std::sort(mesh.elements.begin(), mesh.elements.end());
        if (source.rig && !source.rig->bones.empty()) {
            plan.scene.rigs.push_back(rigMovers(document, shown, source, *plan.scene.character.renderMeshes[plan.scene.meshes.size()]));
            plan.scene.rigs.back().mesh = static_cast<int>(plan.scene.meshes.size());
        }
        plan.scene.meshes.push_back(std::move(mesh));
    }
    for (const PartId id : shown.bones) plan.scene.bones.push_back(document.bones.at(id)->name);
    plan.scene.points.resize(shown.input.skeleton.points.size());
    for (const auto& [end, point] : shown.points)
        if (auto& name = plan.scene.points[static_cast<std::size_t>(point)]; name.empty()) name = endpointText(document, end);

    IMOMUSHI_TRY(const auto takes, takesOf(document, find(arguments, "take")));
    for (const auto& take : takes) plan.scene.clips.push_back(clipOf(take, shown, character, !plan.scene.rigs.empty(), plan.warnings));
    plan.performed = !plan.scene.clips.empty();
    const Json* pose = find(arguments, "pose");
    if (pose && !pose->is_boolean() && !pose->is_string()) return fail("bad-type", "\"pose\" must be true, false or the name of a clip.");
    if (!plan.performed && pose && *pose == false) return fail("bad-value", "There is nothing to export: no take was named, and no pose is asked for.");
    if (!plan.performed || (pose && *pose != false)) {
        const std::string wish = pose && pose->is_string() ? pose->get<std::string>() : "pose";
        if (wish.empty()) return fail("bad-value", "\"pose\" is an empty name.");
        const auto taken = [&](const std::string& name) { return std::any_of(plan.scene.clips.begin(), plan.scene.clips.end(), [&](const ExportClip& c) { return c.name == name; }); };
        std::string name = wish;
        for (int n = 2; taken(name); ++n) name = wish + " " + std::to_string(n);
        std::vector<double> shape(static_cast<std::size_t>(character.shapeLayout().size()));
        character.shape(shape.data());
        const Pose& now = session.shownPose();
        plan.scene.clips.push_back({name, {0.0}, [shape](std::size_t, double* numbers) { std::copy(shape.begin(), shape.end(), numbers); }, {now.points.empty() ? restPose(shown.input.skeleton) : now}});
    }
    for (std::size_t k = 0; k < kEffects; ++k)
        if (const auto kind = static_cast<EffectKind>(k); document.effects.has(kind)) plan.effects.push_back(kind);
    return plan;
}

Result<Json> runExport(const ExportPlan& plan, const Progress& progress) {
    IMOMUSHI_TRY(const auto report, exportScene(plan.scene, plan.options, plan.path, progress));
    Json answer{{"bytes", report.bytes}, {"files", report.files.size()}, {"path", report.files.front().string()},
                {"vertices", report.vertices}, {"triangles", report.triangles}, {"targets", report.targets}, {"keys", report.keys},
                {"clips", Json::array()}};
    for (const auto& clip : report.clips) answer["clips"].push_back({{"name", clip.name}, {"frames", clip.frames}, {"seconds", clip.seconds}});
    // The file's own mesh of a character, or the bodies of elements.
    answer["written"] = Json::array();
    for (const auto& told : report.written) {
        Json item{{told.ownMesh ? "character" : "element", told.name}};
        if (told.ownMesh) item["parts"] = told.parts;
        item["vertices"] = told.vertices;
        item["triangles"] = told.triangles;
        answer["written"].push_back(std::move(item));
    }
    answer["effects"] = Json::array();
    for (const EffectKind kind : plan.effects) answer["effects"].push_back(effectJson(plan, report, kind));
    // By design, and as the file was read back.
    if (plan.options.layout == ExportLayout::Skinned) answer["skin"] = errorJson(report.skinned);
    if (report.followed.largest > 0.0) answer["render_mesh"] = errorJson(report.followed);
    if (report.dropped.largest > 0.0) answer["dropped_targets"] = errorJson(report.dropped);
    if (report.quantised > 0.0) answer["quantised"] = Json{{"max_percent", 100.0 * report.quantised}};
    if (report.uncompressed > 0) answer["uncompressed_bytes"] = report.uncompressed;
    answer["check"] = errorJson(report.check);
    answer["check"]["frames"] = report.checked;
    answer["warnings"] = Json::array();
    for (const auto& list : {plan.warnings, report.warnings})
        for (const ExportWarning& warning : list) answer["warnings"].push_back({{"code", warning.code}, {"subject", warning.subject}, {"text", warning.text}});
    return answer;
}

void addExportCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    std::string presets;
    for (const auto& preset : exportPresets()) presets += std::string(presets.empty() ? "\"" : "; \"") + preset.name + "\": " + preset.help;
    registry.addAction("export",
                       "Writes the character with its takes for other programs, reads the file back and compares it. Errors are distances over the bounding-box "
                       "diagonal of the character. Metres, +Y up, times from 0. An imported character goes out as its file's own mesh: triangles, parts, materials, texture coordinates "
                       "and vertices as there and in that order (\"write-mesh\" says which); other elements as their bodies. The answer says which in \"written\".",
                       {{"path", Type::Text, true, "A file that ends in .glb, in .fbx, which needs Blender, or in .vrm: an avatar that came from a VRM file, as VRM 1.0, in the layout skinned; for caches in .pc2, .mdd, .obj or .ply (a file per frame, numbered)."},
                        {"layout", Type::Text, true,
                         "\"baked\": a node and morph targets per element (a character: a mesh per part, on a skin with a joint per element); \"rigged\": the same in one skeleton, with what drives it live; \"skinned\": weights "
                         "of four joints per vertex, no morph targets; \"cache\": all vertices in all frames, to be put on the file that a character came from; several characters have a cache each, "
                         "after their names."},
                        {"take", Type::Any, false, "The take, or a list of takes (all takes unless given). Caches and sequences of several go to a file or folder each, after their names."},
                        {"pose", Type::Any, false,
                         "true, or the name of a clip: what is shown now goes out too, as a clip of one frame (without takes it always does; \"take\": [] leaves them out)."},
                        {"fps", Type::Number, false, "Keys per second, up to 1000 (the frames of the take)."},
                        {"preset", Type::Text, false, presets + "."},
                        {"targets", Type::Any, false, "Morph targets per element, or of a character together: a number (4 or 8 for phones), or \"all\". What is dropped is said."},
                        {"split", Type::Boolean, false, "A target for each sign of a weight, for programs that clamp weights to 0 ... 1 (false)."},
                        {"quantise", Type::Boolean, false, "16 bits per coordinate and weight, by KHR_mesh_quantization (false). What that rounds is said."},
                        {"compress", Type::Boolean, false, "Less bytes by EXT_meshopt_compression, without loss (false). Readers must know it: three.js and Babylon.js do, Blender does not. FBX files and caches stay as they are."},
                        {"normals", Type::Boolean, false, "Morph targets move normals too (false: engines find them, or leave them)."},
                        {"tolerance", Type::Number, false, "Keys are left out where the others say the same within this part of the diagonal (0)."}},
                       exportCommand);
}

}  // namespace imomushi
