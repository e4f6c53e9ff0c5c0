// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "core/accuracy/frame_prediction.h"
#include "core/accuracy/plot.h"
#include "core/base/atomic_file.h"
#include "core/base/formatted.h"
#include "core/base/parallel.h"
#include "core/character/standard_poses.h"
#include "core/comparison/paper_caterpillar.h"
#include "core/comparison/skin.h"
#include "core/comparison/timing.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/effects/smooth_joints_job.h"
#include "core/mesh/bounds.h"
#include "core/reports/accuracy_commands.h"
#include "core/reports/report_commands.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

std::string known(const char* format, double value) { return value >= 0.0 ? formatted(format, value) : "unknown"; }

std::string table(const std::vector<std::vector<std::string>>& rows) { return markdownTable(rows) + "\n"; }

std::string accuracyPart(const AccuracyStudy& study) {
    std::string out = "## What accuracy costs\n\n";
    if (const auto& r = study.reference)
        out += "Errors are against the full solution, solved on \"" + r->mesh + "\" in " + formatted("%.1f", r->seconds) + " s. Its own error: " +
               known("%.2f", 100.0 * r->relative) + " % (largest " + known("%.2f", r->percent) + " % of the diagonal) by its mesh, " + known("%.2f", 100.0 * r->faceRelative) + " % (" +
               known("%.2f", r->facePercent) + " %) by its joint faces. " + r->how + "\n\n";
    else
        out += "The full solution is too large for this machine: errors are unknown.\n\n";
    const auto front = study.frontPerFrame();
    std::vector<std::vector<std::string>> rows = {{"setting", "relative L2 error (%)", "largest (% of the diagonal)", "ms per frame", "p99", "predicted", "precompute (s)", "frame memory (MB)"}};
    for (std::size_t i = 0; i < study.points.size(); ++i) {
        const AccuracyPoint& p = study.points[i];
        if (!p.measured()) continue;
        const bool on = std::find(front.begin(), front.end(), i) != front.end();
        rows.push_back({std::string(on ? "**" : "") + settingName(p.setting) + (on ? "**" : "") + (static_cast<int>(i) == study.present() ? " (present)" : ""),
                        known("%.3g", p.relative < 0.0 ? -1.0 : 100.0 * p.relative), known("%.3g", p.percent), known("%.4f", p.frameMs), known("%.4f", p.frameP99Ms), known("%.4f", p.predictedMs),
                        known("%.2f", p.precomputeSeconds), known("%.3f", p.frameBytes < 0.0 ? -1.0 : 1e-6 * p.frameBytes)});
    }
    out += table(rows) + "Bold: not dominated in error and milliseconds per frame.";
    const auto waiting = std::count_if(study.points.begin(), study.points.end(), [](const AccuracyPoint& p) { return !p.measured(); });
    if (waiting > 0) out += " " + std::to_string(waiting) + " settings were not measured: there was no time, or they need too much memory.";
    out += "\n\n";
    if (!study.effects.empty()) {
        rows = {{"effect", "predicted (ms per frame)", "measured (ms per frame)", "off by a factor of"}};
        std::string problems;
        for (const auto& e : study.effects) {
            rows.push_back({e.effect, known("%.4f", e.predictedMs), known("%.4f", e.measuredMs), e.off() < 0.0 ? "" : formatted("%.2f", e.off())});
            if (!e.problem.empty()) problems += e.effect + ": " + e.problem + "\n\n";
        }
        out += "What effects add to a frame of the present setting; their error is unknown, as the full solution has none of them.\n\n" + table(rows) + problems;
    }
    return out;
}

/// Frames with synthetic responses: what grows with what.
Result<std::string> scalingPart(const CharacterInput& character, const Progress& progress) {
    std::string out = "## Scaling\n\nMilliseconds of whole frames, float, with synthetic responses, which cost the same.\n\n";
    const auto add = [&](std::vector<std::vector<std::string>>& rows, const std::string& name, CharacterInput input) -> Result<void> {
        int vertices = 0;
        for (const auto& e : input.elements) vertices += static_cast<int>(e.mesh->body.vertices.rows());
        IMOMUSHI_TRY(const auto ms, predictFrame(input, progress));
        rows.push_back({name, std::to_string(vertices), formatted("%.4f", ms), formatted("%.3g", 1e6 * ms / std::max(1, vertices))});
        return {};
    };
    const std::vector<std::string> titles = {"", "vertices", "ms per frame", "ns per vertex"};
    std::vector<std::vector<std::string>> rows = {titles};
    rows[0][0] = "vertices of the paper's caterpillar, one thread";
    for (const int around : {24, 48, 96, 192, 384})
        if (auto ok = add(rows, "cells x " + std::to_string(around / 24), paperCaterpillar(around)); !ok) return tl::unexpected(ok.error());
    out += table(rows);
    rows = {titles};
    rows[0][0] = "elements of a caterpillar, one thread";
    for (const int elements : {1, 5, 25, 100})
        if (auto ok = add(rows, std::to_string(elements), paperCaterpillar(24, elements)); !ok) return tl::unexpected(ok.error());
    out += table(rows);
    rows = {titles};
    rows[0][0] = "joint modes of this character, smooth joints";
    for (const char* name : {"paper", "affine", "modes:5", "modes:12", "modes:24", "modes:36"}) {
        CharacterInput input = character;
        input.basis = parseBasis(name).value();
        input.effects.set(SmoothJointsEffect{});
        if (auto ok = add(rows, name, std::move(input)); !ok) return tl::unexpected(ok.error());
    }
    out += table(rows);
    rows = {titles};
    rows[0][0] = "threads, a caterpillar of many vertices";
    for (int threads = 1; threads <= hardwareThreads(); threads *= 2) {
        CharacterInput input = paperCaterpillar(288);
        input.threads = threads;
        if (auto ok = add(rows, std::to_string(threads), std::move(input)); !ok) return tl::unexpected(ok.error());
    }
    return out + table(rows);
}

/// What a deformation does to a surface of triangles.
struct Quality {
    double volume = 0.0;     ///< relative change
    double worst = 1.0;      ///< least shape of a triangle (4 sqrt 3 area / squared edges), relative to rest
};
Quality qualityOf(const WeldedSurface& body, const std::function<Vec3(std::int32_t)>& at) {
    const auto rest = [&](std::int32_t v) -> Vec3 { return body.vertices.row(v).transpose(); };
    const auto volume = [&](const std::function<Vec3(std::int32_t)>& point) {
        double sum = 0.0;
        for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) sum += point(body.triangles(t, 0)).dot(point(body.triangles(t, 1)).cross(point(body.triangles(t, 2)))) / 6.0;
        return sum;
    };
    const auto shape = [](const Vec3& a, const Vec3& b, const Vec3& c) {
        const double edges = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
        return edges > 0.0 ? (b - a).cross(c - a).norm() / edges : 0.0;
    };
    Quality out;
    const double before = volume(rest);
    out.volume = before != 0.0 ? volume(at) / before - 1.0 : 0.0;
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const auto a = body.triangles(t, 0), b = body.triangles(t, 1), c = body.triangles(t, 2);
        const double was = shape(rest(a), rest(b), rest(c));
        if (was > 0.0) out.worst = std::min(out.worst, shape(at(a), at(b), at(c)) / was);
    }
    return out;
}

Result<std::string> skinPart(const CharacterInput& character, const Progress& progress) {
    std::string out = "## Against skins\n\nThe same bones and poses. Volume: change of the whole body; shape: of its worst triangle, 1 as at rest, 0 folded flat.\n\n";
    const WeldedSurface body = weldedSurface(character);
    auto weights = automaticWeights(body, character.skeleton, progress);
    const bool automatic = weights.has_value();
    if (!automatic) {
        if (weights.error().code == kCancelled) return tl::unexpected(weights.error());
        weights = rampWeights(body, character.skeleton, 0.0);
    }
    if (!weights) return out + "No skin: " + weights.error().message + "\n\n";
    IMOMUSHI_TRY(auto own, Character::build(character));
    std::vector<std::pair<std::string, Skin>> skins;
    for (const auto& [name, kind] : {std::pair{"linear blend skinning", SkinKind::LinearBlend}, {"dual quaternions", SkinKind::DualQuaternion}, {"spline skin", SkinKind::Spline}}) {
        IMOMUSHI_TRY(auto skin, Skin::build(body, character.skeleton, *weights, kind));
        skins.emplace_back(name, std::move(skin));
    }
    auto poses = standardPoses(character.skeleton);
    poses.resize(3);
    std::vector<std::string> titles = {"deformer", "ms per pose", "memory (MB)"};
    for (const auto& pose : poses) {
        titles.push_back("volume, " + pose.name + " (%)");
        titles.push_back("shape, " + pose.name);
    }
    std::vector<std::function<void()>> loops;
    std::size_t turn = 0;
    for (auto& [name, skin] : skins) loops.emplace_back([&skin = skin, &poses, &turn] { skin.update(poses[turn++ % 3].pose); });
    loops.emplace_back([&] { own.update(poses[turn++ % 3].pose); });
    const auto ms = mediansInTurn(100, 1.0, loops, progress);
    if (progress.cancelled()) return fail(kCancelled, "The report was cancelled.");
    std::vector<std::vector<std::string>> rows = {titles};
    const auto qualities = [&](std::vector<std::string>& row, const std::function<void(const Pose&)>& take, const std::function<Vec3(std::int32_t)>& at) {
        for (const auto& pose : poses) {
            take(pose.pose);
            const Quality q = qualityOf(body, at);
            row.push_back(formatted("%+.1f", 100.0 * q.volume));
            row.push_back(formatted("%.2f", q.worst));
        }
    };
    for (std::size_t i = 0; i < skins.size(); ++i) {
        Skin& skin = skins[i].second;
        rows.push_back({skins[i].first, formatted("%.4f", ms[i]), formatted("%.3f", 1e-6 * static_cast<double>(skin.bytes()))});
        qualities(rows.back(), [&](const Pose& p) { skin.update(p); },
                  [&](std::int32_t v) -> Vec3 { return Eigen::Map<const Eigen::Vector3f>(skin.positions() + 3 * static_cast<std::ptrdiff_t>(v)).cast<double>(); });
    }
    double bytes = 0.0;
    for (std::size_t e = 0; e < character.elements.size(); ++e) bytes += static_cast<double>(own.memory(static_cast<int>(e)).response + own.memory(static_cast<int>(e)).surface);
    rows.push_back({"this character, as it is set", formatted("%.4f", ms.back()), formatted("%.3f", 1e-6 * bytes)});
    qualities(rows.back(), [&](const Pose& p) { own.update(p); },
              [&](std::int32_t v) -> Vec3 {
                  const auto e = static_cast<int>(std::upper_bound(body.first.begin(), body.first.end(), v) - body.first.begin()) - 1;
                  return Eigen::Map<const Eigen::Vector3f>(own.surface(e).positions + 3 * static_cast<std::ptrdiff_t>(v - body.first[static_cast<std::size_t>(e)])).cast<double>();
              });
    return out + table(rows) + (automatic ? "Weights by bone heat.\n\n" : "Weights by ramps at the joints: no bone heat on this body.\n\n") +
           "Skins give positions alone; the character's time includes normals.\n\n";
}

Result<std::string> previousPart(const Session& session, const Progress& progress) {
    const bool empty = session.document().elements.empty();
    Session other(session.registry());
    // In an empty document "paper" takes the paper's caterpillar; the document's own comparison is a command of its own.
    IMOMUSHI_TRY(auto answer, other.execute({{"do", "paper"}, {"seconds", 0}}, progress));
    std::vector<std::vector<std::string>> rows = {{"the paper's caterpillar", "proposed", "previous", "ratio"}};
    const Json &a = answer["rows"][0], &b = answer["rows"][1], &ratios = answer["ratios"];
    const auto row = [&](const char* name, const char* key, const char* format, double unit) {
        rows.push_back({name, formatted(format, unit * a[key].get<double>()), formatted(format, unit * b[key].get<double>()), formatted("%.3g", ratios[key].get<double>())});
    };
    row("matrices (MB)", "bytes", "%.3f", 1e-6);
    row("product (ms)", "product_ms", "%.4f", 1.0);
    row("frame (ms)", "frame_ms", "%.4f", 1.0);
    std::string out = "## Against the previous model\n\nFive elements, 1978 vertices, float, one thread, measured in turn. The error of the proposed model in its poses: relative " +
                      formatted("%.3g", answer["error"]["relative"].get<double>()) + ", largest " + formatted("%.3g", answer["error"]["max_percent"].get<double>()) +
                      " % of the diagonal (poses that twist are beyond the basis \"paper\").\n\n" + table(rows);
    if (!empty) out += "The same for this character: the command \"paper\".\n\n";
    return out;
}

/// Answers of finite elements for single elements: NAME.obj, NAME.faces.json (vertices of each face) and NAME.json (results) of a folder.
Result<std::string> finiteElementPart(const Session& session, const std::filesystem::path& folder, const Progress& progress) {
    std::vector<std::filesystem::path> bodies;
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(folder, error))
        if (file.path().extension() == ".obj" && std::filesystem::exists(std::filesystem::path(file.path()).replace_extension(".faces.json"))) bodies.push_back(file.path());
    std::sort(bodies.begin(), bodies.end());
    if (bodies.empty()) return fail("file-not-found", "There are no finite-element answers (NAME.obj with NAME.faces.json and NAME.json) in \"" + folder.string() + "\".");
    const auto read = [](const std::filesystem::path& path) {
        std::ifstream file(path, std::ios::binary);
        return Json::parse(std::string(std::istreambuf_iterator<char>(file), {}), nullptr, false);
    };
    std::vector<std::vector<std::string>> rows = {{"element", "case", "nu", "relative L2 error over free vertices (%)", "largest (% of the diagonal)"}};
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        progress.report("compare", static_cast<double>(i) / static_cast<double>(bodies.size()));
        const std::string name = bodies[i].stem().string();
        const Json faces = read(std::filesystem::path(bodies[i]).replace_extension(".faces.json")), answers = read(std::filesystem::path(bodies[i]).replace_extension(".json"));
        if (!faces.is_object() || !answers.is_object() || !faces.contains("faces") || !answers.contains("results")) continue;
        Session other(session.registry());
        if (auto ok = other.execute({{"do", "import-element"}, {"path", bodies[i].string()}, {"name", "body"}}, progress); !ok) return tl::unexpected(ok.error());
        for (const Json& face : faces["faces"])
            if (auto ok = other.execute({{"do", "add-joint-face"}, {"element", "body"}, {"name", face["name"]}, {"vertices", face["vertices"]}}); !ok) return tl::unexpected(ok.error());
        for (const Json& result : answers["results"]) {
            if (progress.cancelled()) return fail(kCancelled, "The report was cancelled.");
            if (auto ok = other.execute({{"do", "set"}, {"target", "body"}, {"property", "nu"}, {"value", result["nu"]}}); !ok) return tl::unexpected(ok.error());
            if (auto ok = other.execute({{"do", "deform-element"}, {"element", "body"}, {"faces", result["faces"]}}, progress); !ok) return tl::unexpected(ok.error());
            const PartId id = other.document().elements.begin()->first;
            const Element& element = *other.document().elements.begin()->second;
            const Points& rest = element.mesh->body.vertices;
            const Points u = other.positionsOf(id) - rest;
            if (result["displacement"].size() != static_cast<std::size_t>(rest.rows())) continue;
            std::vector<char> held(static_cast<std::size_t>(rest.rows()), 0);
            for (const JointFace& face : element.faces)
                for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
            double wrong = 0.0, all = 0.0, largest = 0.0;
            for (Eigen::Index v = 0; v < rest.rows(); ++v) {
                const Vec3 wanted = vector3(result["displacement"][static_cast<std::size_t>(v)]).value_or(Vec3::Zero());
                const double miss = (u.row(v).transpose() - wanted).squaredNorm();
                largest = std::max(largest, miss);
                all += wanted.squaredNorm() * (result["case"] == "asym" || !held[static_cast<std::size_t>(v)] ? 1.0 : 0.0);
                if (!held[static_cast<std::size_t>(v)]) wrong += miss;
            }
            const double diagonal = diagonalOf(rest);
            rows.push_back({name, result["case"].get<std::string>(), formatted("%.2f", result["nu"].get<double>()), formatted("%.2f", 100.0 * std::sqrt(wrong / std::max(all, 1e-300))),
                            formatted("%.3f", 100.0 * std::sqrt(largest) / diagonal)});
        }
    }
    return "## Against second-order finite elements\n\nSingle elements, statics, default solver mesh, basis \"affine\"; answers of other software from files (in the case asym relative to all "
           "vertices, as free ones hardly move).\n\n" + table(rows);
}

Result<Json> report(SessionAccess& access, const Json& arguments, const Progress& progress) {
    Session& session = access.session;
    IMOMUSHI_TRY(const auto path, outputPath(arguments, "path", {".md"}));
    IMOMUSHI_TRY(auto input, studyInput(session));
    if (auto ok = readNumber(arguments, "seconds", 0.1, 1e6, input.seconds); !ok) return tl::unexpected(ok.error());
    IMOMUSHI_TRY(const auto study, runStudy(input, {}, progress.part(0.0, 0.7)));
    if (auto alive = session.builtCharacter(); !alive) return tl::unexpected(alive.error());
    CharacterInput plain = input.reference.character;
    for (std::size_t e = 0; e < plain.elements.size(); ++e) plain.elements[e].response = session.plan().input.elements[e].response;
    int vertices = 0, missing = 0;
    for (const auto& e : plain.elements) {
        vertices += static_cast<int>(e.mesh->body.vertices.rows());
        missing += !e.faces.empty() && !e.response;
    }
    std::string out = "# Accuracy and cost\n\n" + study.machine + ". " + std::to_string(plain.elements.size()) + " elements, " + std::to_string(vertices) + " vertices, " +
                      std::to_string(plain.skeleton.bones.size()) + " bones. The table of settings is that of this machine's study, which is kept and goes on from run to run; all other figures are of this run.\n\n";
    out += accuracyPart(study);
    IMOMUSHI_TRY(const auto scaling, scalingPart(plain, progress.part(0.7, 0.8)));
    out += scaling;
    if (missing == 0) {
        IMOMUSHI_TRY(const auto skins, skinPart(plain, progress.part(0.8, 0.9)));
        out += skins;
    } else {
        out += "## Against skins\n\nNot compared: some elements are not precomputed. Run \"precompute\" first.\n\n";
    }
    IMOMUSHI_TRY(const auto previous, previousPart(session, progress.part(0.9, 0.95)));
    out += previous;
    if (const Json* references = find(arguments, "references")) {
        IMOMUSHI_TRY(const auto elements, finiteElementPart(session, references->get<std::string>(), progress.part(0.95, 1.0)));
        out += elements;
    }
    if (auto written = writeFileAtomically(path, out); !written) return tl::unexpected(written.error());
    return Json{{"bytes", out.size()}, {"complete", study.complete}};
}

}  // namespace

void addReportCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("report",
                       "Writes a report of this character on this machine, with figures of this run: accuracy and cost, scaling with vertices, elements, joint modes and threads, and "
                       "comparisons with skins, the paper's previous model and finite elements.",
                       {{"path", Type::Text, true, "The report, .md."},
                        {"seconds", Type::Number, false, "About how long the study of accuracy may take, s (0.1 to 1e6). No limit unless given."},
                        {"references", Type::Text, false, "A folder of finite-element answers: NAME.obj, NAME.faces.json and NAME.json."}},
                       report);
}

}  // namespace imomushi
