// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/accuracy/paper_growth.h"
#include "core/accuracy/plot.h"
#include "core/base/atomic_file.h"
#include "core/base/formatted.h"
#include "core/base/parallel.h"
#include "core/comparison/model_table.h"
#include "core/comparison/paper_caterpillar.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/reports/report_commands.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

/// The previous model's matrices in double precision, kept while it is measured, may be this large together with the largest precompute (bytes).
constexpr double kMaxBytes = 6e9;

/// Growing the caterpillar may take about this long, for each model and number of threads (s).
constexpr double kGrowthSeconds = 30.0;

/// What the paper says (Pentium 4 650, 3.4 GHz). Memory in bytes.
struct Published {
    static constexpr int elements = 5, vertices = 1978, proposedAt60 = 28257, previousAt60 = 2000;
    static constexpr double frameMs = 1.17, proposedBytes = 0.5e6, previousBytes = 9.1e6;
};

Result<std::shared_ptr<const ElementResponse>> solved(ResponseStore& store, ResponseInput in, BasisKind basis, const std::string& name, const Progress& progress) {
    in.basis = basis;
    in.loads = BodyLoads::None;
    if (auto known = store.find(responseKey(in), in.mesh->body, in.faces)) return known;
    auto built = buildResponse(in, progress);
    if (!built) return fail(built.error().code, "\"" + name + "\": " + built.error().message);
    return std::make_shared<const ElementResponse>(std::move(*built));
}

/// The document's character. Responses of this comparison are not kept in the session: they would be saved with the project.
Result<ComparedModels> modelsOf(Session& session, const Progress& progress) {
    IMOMUSHI_TRY(auto plan, planCharacter(session.document()));
    ComparedModels out;
    out.input = std::move(plan.input);
    if (out.input.skeleton.bones.empty()) return fail("no-bone", "There is no bone to move the character by: add bones first.");
    std::size_t faces = 0;
    double kept = 0.0, peak = 0.0;
    for (const PartId id : plan.elements) {
        ResponseInput in = session.responseInput(id);
        faces += in.faces.size();
        if (in.faces.empty()) continue;
        in.basis = BasisKind::Full;
        const auto estimated = estimateResponse(in);
        const double m = estimated.columns, n = 3.0 * static_cast<double>(in.mesh->body.vertices.rows());
        kept += (sizeof(double) + sizeof(float)) * (n + m) * m;
        peak = std::max(peak, static_cast<double>(estimated.bytes));
    }
    if (faces == 0) return fail("no-face", "No element has a joint face: there is nothing to compare before faces are added.");
    if (kept + peak > kMaxBytes)
        return fail("too-large", "The previous model would need " + formatted("%.1f", 1e-9 * (kept + peak)) + " GB for this character, more than " +
                                     formatted("%.0f", 1e-9 * kMaxBytes) + " GB: use coarser elements, or an empty document for the paper's caterpillar.");
    const double count = static_cast<double>(plan.elements.size());
    for (std::size_t e = 0; e < plan.elements.size(); ++e) {
        const ResponseInput in = session.responseInput(plan.elements[e]);
        const std::string& name = session.document().elements.at(plan.elements[e])->name;
        std::shared_ptr<const ElementResponse> full;
        if (!in.faces.empty()) {
            const double at = static_cast<double>(e);
            IMOMUSHI_TRY(auto paper, solved(session.responses().store(), in, BasisKind::Paper, name, progress.part(at / count, (at + 0.3) / count)));
            IMOMUSHI_TRY(auto all, solved(session.responses().store(), in, BasisKind::Full, name, progress.part((at + 0.3) / count, (at + 1.0) / count)));
            out.input.elements[e].response = std::move(paper);
            full = std::move(all);
        }
        out.full.push_back(std::move(full));
    }
    return out;
}

/// The caterpillar grown until frames are too slow, and where the previous model diverges.
struct Limits {
    struct Grown {
        std::string model;
        int threads = 1;
        Growth growth;
    };
    std::vector<Grown> grown;
    std::vector<Divergence> divergence;
};

Result<Limits> limitsOf(const ComparedModels& models, double seconds, const Progress& progress) {
    Limits out;
    const auto add = [&](const char* model, int threads, Result<Growth> growth) -> Result<void> {
        if (!growth) return tl::unexpected(growth.error());
        out.grown.push_back({model, threads, std::move(*growth)});
        return {};
    };
    const int all = hardwareThreads();
    if (auto ok = add("proposed", 1, growProposed(1, seconds, progress.part(0.0, 0.25))); !ok) return tl::unexpected(ok.error());
    if (all > 1)
        if (auto ok = add("proposed", all, growProposed(all, seconds, progress.part(0.25, 0.5))); !ok) return tl::unexpected(ok.error());
    if (auto ok = add("previous", 1, growPrevious(seconds, progress.part(0.5, 0.75))); !ok) return tl::unexpected(ok.error());
    IMOMUSHI_TRY(out.divergence, previousDivergence(models, progress.part(0.75, 1.0)));
    return out;
}

void addLimits(Json& answer, const Limits& limits) {
    Json grown = Json::array(), divergence = Json::array();
    for (const auto& g : limits.grown) {
        Json points = Json::array();
        for (const auto& p : g.growth.points) points.push_back({{"vertices", p.vertices}, {"frame_ms", p.frameMs}});
        grown.push_back({{"model", g.model}, {"threads", g.threads}, {"vertices_at_60_fps", g.growth.most}, {"at_least", !g.growth.bounded}, {"points", std::move(points)}});
    }
    for (const auto& d : limits.divergence) {
        Json line = {{"shear_modulus", d.shearModulus}, {"step", d.step}, {"diverged", d.diverged}, {"largest_displacement", d.largest}};
        if (d.diverged) line["seconds"] = d.seconds;
        divergence.push_back(std::move(line));
    }
    answer["measured_vertices_at_60_fps"] = std::move(grown);
    answer["divergence"] = std::move(divergence);
    answer["notes"].push_back("measured_vertices_at_60_fps: the caterpillar with finer and finer cells, positions and normals, until a frame takes longer than a 60th of a second, with "
                              "synthetic responses, which cost the same; vertices_at_60_fps is the largest that was quick enough");
    answer["notes"].push_back("divergence: explicit dynamics of joint faces by step (s) and shear modulus (Pa), 200 steps and at least a quarter of a second each; largest_displacement before it diverged, in diagonals of "
                              "an element");
}

LinePlot growthPlot(const Limits& limits) {
    LinePlot plot{"The paper's caterpillar, grown", "vertices", "milliseconds per frame", {}};
    for (const auto& g : limits.grown) {
        auto& line = plot.lines.emplace_back();
        line.name = g.model + " model, " + std::to_string(g.threads) + (g.threads == 1 ? " thread" : " threads");
        for (const auto& p : g.growth.points) line.points.emplace_back(p.vertices, p.frameMs);
    }
    plot.lines.push_back({"60 frames per second", {{Published::vertices, 1000.0 / 60.0}, {2e6, 1000.0 / 60.0}}});
    return plot;
}

/// Drawn where it diverged, as how far it got before it was stopped says nothing.
constexpr double kDiverged = 100.0;

/// What happens to the largest displacement as steps grow.
LinePlot divergencePlot(const Limits& limits) {
    LinePlot plot{"Divergence of the previous model", "step of the explicit integration (s)", "largest displacement (diagonals of an element; 100: diverged)", {}};
    for (const auto& d : limits.divergence) {
        const std::string name = "shear modulus " + formatted("%g", d.shearModulus) + " Pa";
        if (plot.lines.empty() || plot.lines.back().name != name) plot.lines.push_back({name, {}});
        plot.lines.back().points.emplace_back(d.step, d.diverged ? kDiverged : d.largest);
    }
    return plot;
}

Json rowJson(const ModelTable::Row& row) {
    return {{"model", row.model},           {"elements", row.elements},      {"vertices", row.vertices},
            {"columns", row.columns},       {"bytes", row.bytes},            {"frame_bytes", row.frameBytes},
            {"product_ms", row.productMs},  {"frame_ms", row.frameMs},       {"vertices_at_60_fps", row.verticesAt60()}};
}

Json tableJson(const ModelTable& table, const std::string& character) {
    const auto &a = table.proposed, &b = table.previous;
    Json answer = {{"character", character}, {"format", "float"}, {"threads", 1}};
    answer["rows"] = Json::array({rowJson(a), rowJson(b)});
    answer["ratios"] = {{"bytes", static_cast<double>(b.bytes) / static_cast<double>(a.bytes)},
                        {"product_ms", b.productMs / a.productMs},
                        {"frame_ms", b.frameMs / a.frameMs},
                        {"vertices_at_60_fps", a.verticesAt60() / b.verticesAt60()}};
    Json errors = Json::array();
    double relative = 0.0, percent = 0.0;
    for (const auto& e : table.errors) {
        Json line = {{"pose", e.pose}, {"relative", e.relative}, {"max_percent", e.percent}};
        if (e.beyondBasis) line["beyond_basis"] = true;
        errors.push_back(std::move(line));
        relative = std::max(relative, e.relative), percent = std::max(percent, e.percent);
    }
    answer["error"] = {{"relative", relative}, {"max_percent", percent}};
    answer["errors"] = std::move(errors);
    answer["paper"] = Json::array({{{"model", "proposed"}, {"elements", Published::elements}, {"vertices", Published::vertices}, {"bytes", Published::proposedBytes},
                                    {"frame_ms", Published::frameMs}, {"vertices_at_60_fps", Published::proposedAt60}},
                                   {{"model", "previous"}, {"elements", Published::elements}, {"vertices", Published::vertices}, {"bytes", Published::previousBytes},
                                    {"vertices_at_60_fps", Published::previousAt60}}});
    answer["notes"] = Json::array({
        "bytes: the matrices of all elements in float, n' x g of free vertices against n x m with tractions; frame_bytes: what a frame reads of them",
        "product_ms: the product alone (the proposed one's places its vertices too); frame_ms: inverse kinematics, joints, product, positions and normals, "
        "and in the previous model one explicit step of its joint faces",
        "vertices_at_60_fps: extrapolated from frame_ms per vertex, to more elements like these",
        "error: displacement in the frames of the elements against the previous model at rest, vertices that are seen; relative is L2, max_percent of an "
        "element's bounding-box diagonal; beyond_basis: the pose twists or shifts a joint face in its plane, which the basis \"paper\" cannot say",
        "paper: Watanabe et al. 2006 on a Pentium 4 650 (3.4 GHz); its previous model's figure is about 2,000"});
    if (table.diverged) answer["diverged"] = true;
    return answer;
}

/// The rows of both models and of the paper, as a table of texts; the first row holds titles.
std::vector<std::vector<std::string>> cells(const ModelTable& table, const Limits& limits) {
    const auto &a = table.proposed, &b = table.previous;
    const auto number = [](double value) { return formatted("%.6g", value); };
    const auto ratio = [](double value) { return formatted("%.3g", value); };
    std::vector<std::vector<std::string>> out = {{"", "proposed", "previous", "ratio", "paper: proposed", "paper: previous", "paper: ratio"}};
    const auto row = [&](std::string name, double p, double q, double r, std::string paperA = "", std::string paperB = "", std::string paperRatio = "") {
        out.push_back({std::move(name), number(p), number(q), r > 0.0 ? ratio(r) : "", std::move(paperA), std::move(paperB), std::move(paperRatio)});
    };
    row("elements", a.elements, b.elements, 0.0, number(Published::elements), number(Published::elements));
    row("vertices", a.vertices, b.vertices, 0.0, number(Published::vertices), number(Published::vertices));
    row("columns", a.columns, b.columns, static_cast<double>(b.columns) / a.columns);
    row("matrices (MB)", 1e-6 * static_cast<double>(a.bytes), 1e-6 * static_cast<double>(b.bytes), static_cast<double>(b.bytes) / static_cast<double>(a.bytes),
        number(1e-6 * Published::proposedBytes), number(1e-6 * Published::previousBytes), ratio(Published::previousBytes / Published::proposedBytes));
    row("product (ms)", a.productMs, b.productMs, b.productMs / a.productMs);
    row("frame (ms)", a.frameMs, b.frameMs, b.frameMs / a.frameMs, number(Published::frameMs));
    row("vertices at 60 frames per second, extrapolated", std::floor(a.verticesAt60()), std::floor(b.verticesAt60()), a.verticesAt60() / b.verticesAt60(),
        number(Published::proposedAt60), number(Published::previousAt60), ratio(static_cast<double>(Published::proposedAt60) / Published::previousAt60));
    for (const auto& g : limits.grown)
        if (g.model == "proposed")
            for (const auto& old : limits.grown)
                if (old.model == "previous")
                    row("vertices at 60 frames per second, grown, " + std::to_string(g.threads) + (g.threads == 1 ? " thread" : " threads (previous: 1)"), g.growth.most, old.growth.most,
                        old.growth.most > 0 ? static_cast<double>(g.growth.most) / old.growth.most : 0.0, number(Published::proposedAt60), number(Published::previousAt60));
    for (const auto& e : table.errors) {
        const std::string more = e.beyondBasis ? " (beyond the basis)" : "";
        out.push_back({"error in " + e.pose + more + ", relative L2", number(e.relative), "", "", "", "", ""});
        out.push_back({"error in " + e.pose + more + ", largest (% of the diagonal)", number(e.percent), "", "", "", "", ""});
    }
    return out;
}

std::string markdown(const ModelTable& table, const Limits& limits, const Json& answer) {
    std::string out = "# The paper's table: " + answer["character"].get<std::string>() + "\n\n" + markdownTable(cells(table, limits));
    out += "\nBoth models in float on one thread, measured in turn.\n";
    if (!limits.divergence.empty()) {
        out += "\n## Divergence of the previous model\n\nLargest displacement, in diagonals of an element, in 200 steps and at least a quarter of a second; \"diverged\": after so many seconds.\n\n";
        std::set<double> moduli;
        std::set<double, std::greater<>> steps;
        for (const auto& d : limits.divergence) moduli.insert(d.shearModulus), steps.insert(d.step);
        std::vector<std::vector<std::string>> rows = {{"step (ms)"}};
        for (const double modulus : moduli) rows[0].push_back(formatted("%g Pa", modulus));
        for (const double step : steps) {
            auto& row = rows.emplace_back(1, formatted("%.3g", 1e3 * step));
            for (const double modulus : moduli) {
                const auto d = std::find_if(limits.divergence.begin(), limits.divergence.end(), [&](const Divergence& x) { return x.shearModulus == modulus && x.step == step; });
                row.push_back(d == limits.divergence.end() ? "" : d->diverged ? formatted("diverged (%.2g s)", d->seconds) : formatted("%.3g", d->largest));
            }
        }
        out += markdownTable(rows) + "\n";
    }
    for (const auto& note : answer["notes"]) out += "* " + note.get<std::string>() + "\n";
    return out;
}

std::string csv(const ModelTable& table, const Limits& limits) {
    std::string out;
    for (const auto& line : cells(table, limits)) {
        bool first = true;
        for (const auto& cell : line) {
            out += (first ? "\"" : ",\"") + cell + "\"";
            first = false;
        }
        out += "\n";
    }
    return out;
}

Result<Json> paper(SessionAccess& access, const Json& arguments, const Progress& progress) {
    Session& session = access.session;
    IMOMUSHI_TRY(const auto path, outputPath(arguments, "path", {".json", ".md", ".csv"}));
    IMOMUSHI_TRY(const auto svg, outputPath(arguments, "svg", {".svg"}));
    const bool empty = session.document().elements.empty();
    double seconds = kGrowthSeconds;
    if (auto ok = readNumber(arguments, "seconds", 0.0, 1e6, seconds); !ok) return tl::unexpected(ok.error());
    IMOMUSHI_TRY(auto models, empty ? solvedPaperCaterpillar(progress.part(0.0, 0.1)) : modelsOf(session, progress.part(0.0, 0.8)));
    IMOMUSHI_TRY(const auto table, compareModels(models, empty ? progress.part(0.1, 0.3) : progress.part(0.8, 1.0)));
    Json answer = tableJson(table, empty ? "built-in caterpillar" : "document");
    Limits limits;
    if (empty && seconds > 0.0) {
        IMOMUSHI_TRY(limits, limitsOf(models, seconds, progress.part(0.3, 1.0)));
        addLimits(answer, limits);
        if (!svg.empty()) {
            if (auto written = writeFileAtomically(svg, divergencePlot(limits).svg()); !written) return tl::unexpected(written.error());
            const auto growth = svg.parent_path() / (svg.stem().string() + "-growth.svg");
            if (auto written = writeFileAtomically(growth, growthPlot(limits).svg()); !written) return tl::unexpected(written.error());
        }
    }
    if (!path.empty()) {
        const std::string suffix = path.extension().string();
        const std::string bytes = suffix == ".json" ? answer.dump(2) + "\n" : suffix == ".md" ? markdown(table, limits, answer) : csv(table, limits);
        if (auto written = writeFileAtomically(path, bytes); !written) return tl::unexpected(written.error());
    }
    return answer;
}

}  // namespace

void addPaperCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("paper",
                       "The paper's table of this character, or of a caterpillar of the paper's size where the document is empty: the proposed model in the basis "
                       "\"paper\" beside the previous one, both solved and measured now (float, one thread), with the error between them and the paper's figures.",
                       {{"path", Type::Text, false, "Also writes the table to this file: .json, .md or .csv."},
                        {"svg", Type::Text, false, "Of the caterpillar: plots the divergence of the previous model to NAME.svg, and its growth to NAME-growth.svg."},
                        {"seconds", Type::Number, false, "How long the caterpillar is grown at most for each model and number of threads, s (30 unless given); 0: neither growth nor divergence."}},
                       paper);
}

}  // namespace imomushi
