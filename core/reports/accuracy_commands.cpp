// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reports/accuracy_commands.h"

#include <algorithm>
#include <filesystem>

#include "core/accuracy/plot.h"
#include "core/accuracy/study_json.h"
#include "core/base/atomic_file.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/take.h"
#include "core/live/performance.h"
#include "core/reports/report_commands.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

constexpr const char* kNoTouch = "Fingers press on true responses only: enable \"touch\", run \"precompute\", and study again.";

/// The document's character as studies see it: without effects but smooth joints.
struct PlainCharacter {
    Document document;
    ReferenceInput reference;
    std::vector<PartId> elements;
};
Result<PlainCharacter> plainCharacter(const Session& session) {
    PlainCharacter out{session.document(), {}, {}};
    for (std::size_t k = 0; k < kEffects; ++k)
        if (static_cast<EffectKind>(k) != EffectKind::SmoothJoints) out.document.effects[static_cast<EffectKind>(k)].enabled = false;
    IMOMUSHI_TRY(auto plan, planCharacter(out.document));
    if (plan.input.skeleton.bones.empty()) return fail("no-bone", "There is no bone to move the character by: add bones first.");
    out.reference.character = std::move(plan.input);
    out.elements = std::move(plan.elements);
    bool any = false;
    for (const PartId id : out.elements) {
        out.reference.elements.push_back(session.responseInput(id));
        any = any || !out.reference.elements.back().faces.empty();
    }
    if (!any) return fail("no-face", "No element has a joint face: there is nothing to study before faces are added.");
    const Skeleton& skeleton = out.reference.character.skeleton;
    out.reference.poses = standardPoses(skeleton);
    for (const auto& [id, take] : session.document().takes)
        for (const int quarter : {1, 2, 3}) {
            const double time = 0.25 * quarter * take->duration();
            out.reference.poses.push_back({take->name + " " + std::to_string(25 * quarter) + " %", takePose(*take, momentAt(take->times, time), plan.bones, skeleton)});
        }
    return out;
}

/// How an effect is measured: by the present character with it alone. Nothing where such a character cannot be made.
std::optional<StudyInput::Effect> pricedEffect(const Session& session, const Document& plain, EffectKind kind) {
    Document with = plain;
    with.effects[kind] = session.document().effects[kind];
    with.effects[kind].enabled = true;
    with.effects[kind].elements.clear();
    auto planned = planCharacter(with);
    if (!planned) return std::nullopt;
    StudyInput::Effect out{std::string(effectName(kind)), session.effectCost(kind).milliseconds, {}, {}, {}};
    if (effectDescriptor(kind).scope == EffectScope::Bones) {
        auto built = Performance::build(with, *planned);
        if (!built) return std::nullopt;
        out.step = [performance = std::make_shared<Performance>(std::move(*built))](double seconds, const Pose& kinematic, std::span<const IkGoal> goals) -> const Pose& {
            performance->step(seconds, kinematic, goals);
            return performance->pose();
        };
    }
    if (kind == EffectKind::Touch) {
        for (std::size_t e = 0; e < planned->elements.size(); ++e) {
            auto& element = planned->input.elements[e];
            element.response = session.response(planned->elements[e]);
            if (!element.faces.empty() && (!element.response || element.response->touch.patches.count() == 0)) out.unknown = kNoTouch;
        }
    }
    out.with = std::move(planned->input);
    return out;
}

ScatterPlot plotOf(const AccuracyStudy& study, bool precompute) {
    ScatterPlot plot;
    plot.title = precompute ? "Error against time of the precompute" : "Error against time per frame";
    plot.xTitle = precompute ? "seconds of precompute" : "milliseconds per frame (median)";
    plot.yTitle = "relative L2 error against the full solution (%)";
    plot.floor = 100.0 * study.floor();
    plot.floorText = "below the error of the reference";
    const auto front = precompute ? study.frontInPrecompute() : study.frontPerFrame();
    for (std::size_t i = 0; i < study.points.size(); ++i) {
        const AccuracyPoint& p = study.points[i];
        const bool on = std::find(front.begin(), front.end(), i) != front.end(), now = static_cast<int>(i) == study.present();
        plot.points.push_back({precompute ? p.precomputeSeconds : p.frameMs, 100.0 * p.relative, settingName(p.setting), on, now, on || now});
    }
    return plot;
}

/// 0: no limit.
Result<double> secondsOf(const Json& arguments) {
    const Json* seconds = find(arguments, "seconds");
    return seconds ? numberWithin(*seconds, "seconds", 0.1, 1e6) : 0.0;
}

/// The error of the character as it is set in the pose that it shows; that of each vertex goes into the file only.
Result<Json> accuracyOfPose(Session& session, const Json& arguments, const std::filesystem::path& path, const Progress& progress) {
    if (text(arguments, "pose") != "current") return fail("bad-value", "\"pose\" must be \"current\".");
    for (const char* key : {"svg", "csv", "fresh"})
        if (find(arguments, key)) return fail("bad-value", std::string("\"") + key + "\" belongs to the table: leave it out with \"pose\".");
    IMOMUSHI_TRY(auto input, poseErrorInput(session));
    IMOMUSHI_TRY(input.reference.seconds, secondsOf(arguments));
    IMOMUSHI_TRY(const auto made, FullSolutionKeeper().measure(input, progress));
    const auto known = [](double value) { return value >= 0.0 ? Json(value) : Json(nullptr); };
    const auto pair = [&](double relative, double percent) { return Json{{"relative", known(relative)}, {"max_percent", known(percent)}}; };
    const Reference& r = made.reference;
    Json answer{{"pose", "current"}, {"setting", settingName(presentSetting(session.document()))}, {"error", pair(made.error.relative, made.error.percent)}};
    answer["reference"] = {{"solution", "full"}, {"solver_mesh", r.mesh}, {"error", pair(r.relative, r.percent)}, {"face_error", pair(r.faceRelative, r.facePercent)}, {"how", r.how}};
    answer["seconds"] = {{"full_solution", r.seconds}, {"pose", made.seconds}};
    answer["bytes"] = made.bytes;
    Json elements = Json::array(), fields = Json::array();
    std::size_t e = 0;
    for (const auto& [id, element] : session.document().elements) {
        const auto& field = made.field[e++];
        double largest = -1.0;
        Json errors = Json::array();
        for (const float value : field) {
            largest = std::max(largest, static_cast<double>(value));
            errors.push_back(known(value));
        }
        elements.push_back({{"name", element->name}, {"max_percent", known(largest)}});
        fields.push_back({{"name", element->name}, {"max_percent", known(largest)}, {"percent", std::move(errors)}});
    }
    Json file = answer;
    file["elements"] = std::move(fields);
    answer["elements"] = std::move(elements);
    if (auto written = writeFileAtomically(path, file.dump(1) + "\n"); !written) return tl::unexpected(written.error());
    return answer;
}

Result<Json> accuracy(SessionAccess& access, const Json& arguments, const Progress& progress) {
    Session& session = access.session;
    IMOMUSHI_TRY(const auto path, outputPath(arguments, "path", {".json"}));
    IMOMUSHI_TRY(const auto svg, outputPath(arguments, "svg", {".svg"}));
    IMOMUSHI_TRY(const auto csv, outputPath(arguments, "csv", {".csv"}));
    if (find(arguments, "pose")) return accuracyOfPose(session, arguments, path, progress);
    IMOMUSHI_TRY(auto input, studyInput(session));
    IMOMUSHI_TRY(input.seconds, secondsOf(arguments));
    if (const Json* fresh = find(arguments, "fresh"); fresh && fresh->get<bool>()) {
        std::error_code error;
        for (const char* suffix : {".json", ".positions"}) std::filesystem::remove(input.store / (studyKey(input).hex() + suffix), error);
    }
    IMOMUSHI_TRY(const auto study, runStudy(input, {}, progress));
    Json answer = studyJson(study);
    answer["notes"] = Json::array(
        {"error: displacement in the frames of the elements against the full solution, vertices that are seen, all poses; relative is L2, max_percent of an element's "
         "bounding-box diagonal; null: unknown",
         "ms_per_frame: inverse kinematics, joints, product, positions and normals while all bones swing, without other effects than smooth joints; in turn with a reference load, in the quietest quarter of the time",
         "predicted: before the precompute, by frames with synthetic responses",
         "points whose error is below that of the reference cannot be told apart by it",
         "effects: what each adds to a frame of the present setting, by the difference of frames with and without it in turn, off_by: the factor between that and its "
         "prediction; their error is unknown, as the full solution has none of them"});
    if (auto written = writeFileAtomically(path, answer.dump(2) + "\n"); !written) return tl::unexpected(written.error());
    if (!csv.empty())
        if (auto written = writeFileAtomically(csv, studyCsv(study)); !written) return tl::unexpected(written.error());
    if (!svg.empty()) {
        if (auto written = writeFileAtomically(svg, plotOf(study, false).svg()); !written) return tl::unexpected(written.error());
        const auto second = svg.parent_path() / (svg.stem().string() + "-precompute.svg");
        if (auto written = writeFileAtomically(second, plotOf(study, true).svg()); !written) return tl::unexpected(written.error());
    }
    return answer;
}

}  // namespace

AccuracySetting presentSetting(const Document& document) {
    AccuracySetting out;
    out.basis = document.settings.basis;
    out.format = document.settings.format;
    out.smoothJoints = document.effects.has(EffectKind::SmoothJoints);
    bool first = true;
    for (const auto& [id, element] : document.elements) {
        if (element->faces.empty()) continue;
        const SolverMeshSetting& mesh = element->solverMesh;
        if (mesh.count > 0 || (!first && mesh.kind != out.mesh.kind)) {
            out.mesh = {true, SolverMeshSetting::Kind::Default, 0.0};
            break;
        }
        out.mesh.kind = mesh.kind;
        first = false;
    }
    return out;
}

Result<ReferenceInput> studiedCharacter(const Session& session) {
    IMOMUSHI_TRY(auto plain, plainCharacter(session));
    return std::move(plain.reference);
}

Result<StudyInput> studyInput(const Session& session) {
    IMOMUSHI_TRY(auto plain, plainCharacter(session));
    StudyInput out;
    out.present = presentSetting(session.document());
    out.store = studyFolder();
    out.reference = std::move(plain.reference);
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        if (kind == EffectKind::PreviousModel) continue;  // it has a point of its own
        if (auto effect = pricedEffect(session, plain.document, kind)) out.effects.push_back(std::move(*effect));
    }
    return out;
}

Result<PoseErrorInput> poseErrorInput(const Session& session) {
    IMOMUSHI_TRY(auto plain, plainCharacter(session));
    PoseErrorInput out{std::move(plain.reference), {}};
    out.shown = out.reference.character;
    for (std::size_t e = 0; e < plain.elements.size(); ++e) {
        auto& element = out.shown.elements[e];
        element.response = session.response(plain.elements[e]);
        if (!element.response && !element.faces.empty())
            return fail("not-precomputed", "\"" + session.document().elements.at(plain.elements[e])->name + "\" is not precomputed as it is now: run \"precompute\" first.");
    }
    const Pose& pose = session.shownPose();
    out.reference.poses = {{"current", pose.points.empty() ? restPose(out.shown.skeleton) : pose}};
    return out;
}

std::vector<Json> settingCommands(const Document& document, const AccuracySetting& setting) {
    std::vector<Json> out;
    const AccuracySetting now = presentSetting(document);
    const auto set = [&](const std::string& target, const char* property, const std::string& value) {
        out.push_back({{"do", "set"}, {"target", target}, {"property", property}, {"value", value}});
    };
    const BasisChoice basis = setting.previous ? BasisChoice(BasisKind::Full) : setting.basis;
    if (!(basis == now.basis)) set("character", "basis", basisName(basis));
    if (setting.format != now.format) set("character", "format", formatName(setting.format));
    for (const auto& [id, element] : document.elements) {
        if (element->faces.empty()) continue;
        const SolverMeshSetting mesh = setting.mesh.on(static_cast<int>(element->mesh->body.vertices.rows()), element->solverMesh);
        if (!(mesh == element->solverMesh)) set(element->name, "solver-mesh", solverMeshName(mesh));
    }
    const auto turn = [&](EffectKind kind, bool on) {
        if (document.effects.has(kind) != on) out.push_back({{"do", on ? "enable" : "disable"}, {"effect", std::string(effectName(kind))}});
    };
    turn(EffectKind::SmoothJoints, setting.smoothJoints && !setting.previous);
    if (setting.previous || document.effects.has(EffectKind::PreviousModel)) turn(EffectKind::PreviousModel, setting.previous);
    return out;
}

void addAccuracyCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("accuracy",
                       "What accuracy costs: bases, solver meshes and number formats of this character, each with precompute seconds, bytes, milliseconds per frame and error against the "
                       "full solution on the finest affordable solver mesh, measured on this machine. What is known from before is not measured again.",
                       {{"path", Type::Text, true, "The table, .json."},
                        {"svg", Type::Text, false, "Plot of error against time per frame, NAME.svg; that against the precompute goes beside it as NAME-precompute.svg."},
                        {"csv", Type::Text, false, "The table as .csv."},
                        {"seconds", Type::Number, false, "About how long it may take, s (0.1 to 1e6): what does not fit stays unknown and is done by the next study. No limit unless given."},
                        {"fresh", Type::Boolean, false, "Forget what is known and measure all anew."},
                        {"pose", Type::Text, false,
                         "\"current\": no table, but the error of the character as it is set in the pose that it shows now, of every vertex too (% of the diagonal of its element; null: "
                         "not seen). Then \"seconds\" are for the full solution."}},
                       accuracy);
}

}  // namespace imomushi
