// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/study_json.h"
#include "core/base/formatted.h"

#include <cmath>

namespace imomushi {

namespace {

using Json = nlohmann::ordered_json;

Json known(double value) { return value >= 0.0 && std::isfinite(value) ? Json(value) : Json(nullptr); }

double number(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number() && found->get<double>() >= 0.0 ? found->get<double>() : -1.0;
}

std::string text(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool flag(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_boolean() && found->get<bool>();
}

Json settingJson(const AccuracySetting& s) {
    Json json{{"basis", s.previous ? "full" : basisName(s.basis)}, {"smooth_joints", s.smoothJoints}, {"format", formatName(s.format)}};
    json["model"] = s.previous ? "previous" : "proposed";
    json["own_meshes"] = s.mesh.own;
    if (!s.mesh.own) {
        json["solver_mesh"] = solverMeshName({s.mesh.kind, s.mesh.factor > 0.0 ? SolverMeshSetting::kFewest : 0});
        if (s.mesh.factor > 0.0) {
            json["solver_mesh"] = s.mesh.kind == SolverMeshSetting::Kind::Refined ? "refined" : "decimated";
            json["solver_mesh_factor"] = s.mesh.factor;
        }
    }
    return json;
}

std::optional<AccuracySetting> settingFromJson(const Json& json) {
    AccuracySetting s;
    const auto basis = parseBasis(text(json, "basis"));
    const auto format = responseFormat(text(json, "format"));
    if (!basis || !format) return std::nullopt;
    s.previous = text(json, "model") == "previous";
    s.basis = *basis;
    s.format = *format;
    s.smoothJoints = flag(json, "smooth_joints");
    s.mesh.own = flag(json, "own_meshes");
    if (s.mesh.own) return s;
    const std::string mesh = text(json, "solver_mesh");
    if (mesh == "refined" || mesh == "decimated") {
        s.mesh.kind = mesh == "refined" ? SolverMeshSetting::Kind::Refined : SolverMeshSetting::Kind::Decimated;
        s.mesh.factor = number(json, "solver_mesh_factor");
    } else if (const auto parsed = parseSolverMesh(mesh)) {
        s.mesh.kind = parsed->kind;
    } else {
        return std::nullopt;
    }
    return s;
}

}  // namespace

Json studyJson(const AccuracyStudy& study) {
    Json out{{"machine", study.machine}, {"complete", study.complete}, {"seconds", study.seconds}, {"yardstick_ms", known(study.calibrationMs)}, {"poses", study.poses}};
    if (const auto& r = study.reference)
        out["reference"] = {{"solution", "full"},
                            {"solver_mesh", r->mesh},
                            {"seconds", r->seconds},
                            {"error", {{"relative", known(r->relative)}, {"max_percent", known(r->percent)}}},
                            {"face_error", {{"relative", known(r->faceRelative)}, {"max_percent", known(r->facePercent)}}},
                            {"how", r->how}};
    else
        out["reference"] = nullptr;
    const auto front = study.frontPerFrame(), precompute = study.frontInPrecompute();
    Json points = Json::array();
    for (std::size_t i = 0; i < study.points.size(); ++i) {
        const AccuracyPoint& p = study.points[i];
        Json one{{"name", settingName(p.setting)}, {"setting", settingJson(p.setting)}};
        one["precompute_seconds"] = known(p.precomputeSeconds);
        one["predicted_seconds"] = known(p.predictedSeconds);
        one["precompute_bytes"] = known(p.precomputeBytes);
        one["frame_bytes"] = known(p.frameBytes);
        one["ms_per_frame"] = {{"median", known(p.frameMs)}, {"p99", known(p.frameP99Ms)}, {"predicted", known(p.predictedMs)}};
        one["error"] = {{"relative", known(p.relative)}, {"max_percent", known(p.percent)}};
        Json errors = Json::array();
        for (std::size_t k = 0; k < p.errors.size() && k < study.poses.size(); ++k)
            errors.push_back({{"pose", study.poses[k]}, {"relative", p.errors[k].relative}, {"max_percent", p.errors[k].percent}});
        one["errors"] = std::move(errors);
        if (p.problem) one["problem"] = p.problem->message, one["problem_code"] = p.problem->code;
        one["present"] = static_cast<int>(i) == study.present();
        one["dominated"] = {{"ms_per_frame", p.dominatedPerFrame}, {"precompute_seconds", p.dominatedInPrecompute}};
        points.push_back(std::move(one));
    }
    out["points"] = std::move(points);
    const auto names = [&](const std::vector<std::size_t>& list) {
        Json json = Json::array();
        for (const std::size_t i : list) json.push_back(settingName(study.points[i].setting));
        return json;
    };
    out["front"] = {{"ms_per_frame", names(front)}, {"precompute_seconds", names(precompute)}};
    Json effects = Json::array();
    for (const EffectPoint& e : study.effects) {
        effects.push_back({{"effect", e.effect}, {"predicted_ms", known(e.predictedMs)}, {"measured_ms", known(e.measuredMs)}, {"off_by", known(e.off())}, {"error", nullptr}});
        if (!e.problem.empty()) effects.back()["problem"] = e.problem;
    }
    out["effects"] = std::move(effects);
    return out;
}

AccuracyStudy studyFromJson(const Json& json) {
    AccuracyStudy out;
    if (!json.is_object()) return out;
    out.machine = text(json, "machine");
    out.seconds = std::max(0.0, number(json, "seconds"));
    out.calibrationMs = std::max(0.0, number(json, "yardstick_ms"));
    const auto pair = [](const Json& at, const char* key, double& relative, double& percent) {
        const auto found = at.find(key);
        if (found == at.end() || !found->is_object()) return;
        relative = number(*found, "relative");
        percent = number(*found, "max_percent");
    };
    if (const auto r = json.find("reference"); r != json.end() && r->is_object()) {
        Reference& reference = out.reference.emplace();
        reference.mesh = text(*r, "solver_mesh");
        reference.how = text(*r, "how");
        reference.seconds = std::max(0.0, number(*r, "seconds"));
        pair(*r, "error", reference.relative, reference.percent);
        pair(*r, "face_error", reference.faceRelative, reference.facePercent);
    }
    if (const auto points = json.find("points"); points != json.end() && points->is_array())
        for (const Json& one : *points) {
            const auto given = one.is_object() ? one.find("setting") : one.end();
            if (!one.is_object() || given == one.end() || !given->is_object()) continue;
            const auto setting = settingFromJson(*given);
            if (!setting) continue;
            AccuracyPoint p;
            p.setting = *setting;
            p.precomputeSeconds = number(one, "precompute_seconds");
            p.predictedSeconds = number(one, "predicted_seconds");
            p.precomputeBytes = number(one, "precompute_bytes");
            p.frameBytes = number(one, "frame_bytes");
            if (const auto ms = one.find("ms_per_frame"); ms != one.end() && ms->is_object()) {
                p.frameMs = number(*ms, "median");
                p.frameP99Ms = number(*ms, "p99");
                p.predictedMs = number(*ms, "predicted");
            }
            pair(one, "error", p.relative, p.percent);
            if (const auto errors = one.find("errors"); errors != one.end() && errors->is_array())
                for (const Json& e : *errors)
                    if (e.is_object()) p.errors.push_back({number(e, "relative"), number(e, "max_percent")});
            if (one.contains("problem")) p.problem = Error{text(one, "problem_code"), text(one, "problem")};
            out.points.push_back(std::move(p));
        }
    if (const auto effects = json.find("effects"); effects != json.end() && effects->is_array())
        for (const Json& e : *effects)
            if (e.is_object()) out.effects.push_back({text(e, "effect"), number(e, "predicted_ms"), number(e, "measured_ms"), text(e, "problem")});
    return out;
}

std::string studyCsv(const AccuracyStudy& study) {
    std::string out = "setting,precompute seconds,predicted seconds,precompute bytes,frame bytes,ms per frame (median),ms per frame (p99),ms per frame (predicted),"
                      "relative L2 error,largest error (% of the diagonal),dominated (ms per frame),dominated (precompute),present,problem\n";
    const auto cell = [](double value) { return value >= 0.0 ? formatted("%.6g", value) : std::string(); };
    const auto quoted = [](std::string text) {
        for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
        return "\"" + text + "\"";
    };
    for (std::size_t i = 0; i < study.points.size(); ++i) {
        const AccuracyPoint& p = study.points[i];
        out += quoted(settingName(p.setting));
        for (const double value : {p.precomputeSeconds, p.predictedSeconds, p.precomputeBytes, p.frameBytes, p.frameMs, p.frameP99Ms, p.predictedMs, p.relative, p.percent})
            out += "," + cell(value);
        const bool known = p.relative >= 0.0;
        out += std::string(",") + (known ? (p.dominatedPerFrame ? "yes" : "no") : "") + "," + (known ? (p.dominatedInPrecompute ? "yes" : "no") : "") + "," +
               (static_cast<int>(i) == study.present() ? "yes" : "no") + "," + (p.problem ? quoted(p.problem->message) : "") + "\n";
    }
    return out;
}

}  // namespace imomushi
