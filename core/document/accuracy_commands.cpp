// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/accuracy_commands.h"

#include <algorithm>
#include <filesystem>

#include "core/accuracy/plot.h"
#include "core/accuracy/study_json.h"
#include "core/document/command_support.h"
#include "core/document/session_state.h"
#include "core/document/take.h"
#include "core/io/atomic_file.h"

namespace imomushi {

namespace {

/// Effects whose price is measured with stand-ins: those of elements and joints. Fingers need true responses, and bone dynamics and the ground are priced by trial anyway.
constexpr EffectKind kPriced[] = {EffectKind::SmoothJoints, EffectKind::BendWarp, EffectKind::JointDynamics, EffectKind::Gravity, EffectKind::Inflate};

/// A path with one of these endings whose folder is there. Errors: "bad-value", "unknown-format", "not-writable".
Result<std::filesystem::path> outputPath(const Json& arguments, const char* key, const char* suffix) {
    const Json* given = find(arguments, key);
    if (!given) return std::filesystem::path();
    const auto& name = given->get_ref<const std::string&>();
    const std::string quoted = std::string("\"") + key + "\"";
    if (name.empty() || name.find('\0') != std::string::npos) return fail("bad-value", quoted + " is empty or holds a zero byte.");
    const std::filesystem::path path(name);
    if (path.extension() != suffix) return fail("unknown-format", quoted + " must end in " + suffix + ".");
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) return fail("not-writable", "There is no folder \"" + folder.string() + "\": choose one that is there.");
    return path;
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

Result<Json> accuracy(Session& session, const Json& arguments, const Progress& progress) {
    const auto path = outputPath(arguments, "path", ".json");
    if (!path) return tl::unexpected(path.error());
    const auto svg = outputPath(arguments, "svg", ".svg");
    if (!svg) return tl::unexpected(svg.error());
    const auto csv = outputPath(arguments, "csv", ".csv");
    if (!csv) return tl::unexpected(csv.error());
    auto input = studyInput(session);
    if (!input) return tl::unexpected(input.error());
    if (const Json* seconds = find(arguments, "seconds")) {
        const auto given = numberWithin(*seconds, "seconds", 0.1, 1e6);
        if (!given) return tl::unexpected(given.error());
        input->seconds = *given;
    }
    if (const Json* fresh = find(arguments, "fresh"); fresh && fresh->get<bool>()) {
        std::error_code error;
        for (const char* suffix : {".json", ".positions"}) std::filesystem::remove(input->store / (studyKey(*input).hex() + suffix), error);
    }
    const auto study = runStudy(*input, {}, progress);
    if (!study) return tl::unexpected(study.error());
    Json answer = studyJson(*study);
    answer["notes"] = Json::array(
        {"error: displacement in the frames of the elements against the full solution, vertices that are seen, all poses; relative is L2, max_percent of an element's "
         "bounding-box diagonal; null: unknown",
         "ms_per_frame: inverse kinematics, joints, product, positions and normals while all bones swing, without other effects than smooth joints; measured in turn with a yardstick",
         "predicted: before the precompute, by frames with stand-ins for its results",
         "points whose error is below that of the reference cannot be told apart by it",
         "effects: what each adds to a frame of the present setting; their error is unknown, as the full solution has none of them"});
    if (auto written = writeFileAtomically(*path, answer.dump(2) + "\n"); !written) return tl::unexpected(written.error());
    if (!csv->empty())
        if (auto written = writeFileAtomically(*csv, studyCsv(*study)); !written) return tl::unexpected(written.error());
    if (!svg->empty()) {
        if (auto written = writeFileAtomically(*svg, plotOf(*study, false).svg()); !written) return tl::unexpected(written.error());
        const auto second = svg->parent_path() / (svg->stem().string() + "-precompute.svg");
        if (auto written = writeFileAtomically(second, plotOf(*study, true).svg()); !written) return tl::unexpected(written.error());
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

Result<StudyInput> studyInput(Session& session) {
    Session::State& s = session.state();
    Document plain = s.document;
    for (std::size_t k = 0; k < kEffects; ++k)
        if (static_cast<EffectKind>(k) != EffectKind::SmoothJoints) plain.effects[static_cast<EffectKind>(k)].enabled = false;
    auto plan = planCharacter(plain);
    if (!plan) return tl::unexpected(plan.error());
    StudyInput out;
    out.present = presentSetting(s.document);
    out.store = studyFolder();
    out.reference.character = std::move(plan->input);
    if (out.reference.character.skeleton.bones.empty()) return fail("no-bone", "There is no bone to move the character by: add bones first.");
    bool any = false;
    for (const PartId id : plan->elements) {
        out.reference.elements.push_back(s.inputOf(id));
        any = any || !out.reference.elements.back().faces.empty();
    }
    if (!any) return fail("no-face", "No element has a joint face: there is nothing to study before faces are added.");
    const Skeleton& skeleton = out.reference.character.skeleton;
    out.reference.poses = standardPoses(skeleton);
    for (const auto& [id, take] : s.document.takes)
        for (const int quarter : {1, 2, 3}) {
            const double time = 0.25 * quarter * take->duration();
            out.reference.poses.push_back({take->name + " " + std::to_string(25 * quarter) + " %", takePose(*take, momentAt(take->times, time), plan->bones, skeleton)});
        }
    for (const EffectKind kind : kPriced) {
        Document with = plain;
        with.effects[kind] = s.document.effects[kind];
        with.effects[kind].enabled = true;
        with.effects[kind].elements.clear();
        auto planned = planCharacter(with);
        if (!planned) continue;
        out.effects.push_back({std::string(effectName(kind)), s.costOf(kind).milliseconds, std::move(planned->input)});
    }
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
    registry.add({"accuracy",
                  "What accuracy costs: bases, solver meshes and number formats of this character, each with precompute seconds, bytes, milliseconds per frame and error against the "
                  "full solution on the finest affordable solver mesh, measured on this machine. What is known from before is not measured again.",
                  {{"path", Type::Text, true, "The table, .json."},
                   {"svg", Type::Text, false, "Plot of error against time per frame, NAME.svg; that against the precompute goes beside it as NAME-precompute.svg."},
                   {"csv", Type::Text, false, "The table as .csv."},
                   {"seconds", Type::Number, false, "About how long it may take, s (0.1 to 1e6): what does not fit stays unknown and is done by the next study. No limit unless given."},
                   {"fresh", Type::Boolean, false, "Forget what is known and measure all anew."}},
                  false, accuracy});
}

}  // namespace imomushi
