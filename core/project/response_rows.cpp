// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/response_rows.h"

#include <algorithm>
#include <limits>

#include "core/project/project_rows.h"

namespace imomushi {

namespace {

constexpr const char* kResponseTable = R"(
CREATE TABLE responses (id INTEGER PRIMARY KEY, key BLOB, shape BLOB, free_vertices BLOB, bases BLOB, response BLOB, stiffness BLOB,
    tractions BLOB, loads BLOB, load_forces BLOB,
    residual REAL, rcond REAL, peak_bytes INTEGER, asymmetry REAL, negative_energy REAL, solver_vertices INTEGER, solver_nodes INTEGER,
    decimated INTEGER, error REAL, mapping_error REAL, shape_error REAL, tetrahedra INTEGER, no_filling TEXT);
)";
constexpr const char* kTouchTable = R"(
CREATE TABLE touch_responses (response INTEGER PRIMARY KEY, centres BLOB, reach REAL, first BLOB, patches BLOB, weights BLOB, displacement BLOB,
    forces BLOB, compliance BLOB, probes BLOB, gradients BLOB, asymmetry REAL, negative_energy REAL);
)";

constexpr std::size_t kMaxTouchPatches = 100'000;
constexpr int kMaxFaceVertices = 1'000'000;  // of all faces of an element

ContentKey readKey(RowReader& rows) {
    const auto halves = rows.array<std::uint64_t>(2);
    require(halves.size() == 2, "a key is broken");
    return {halves[0], halves[1]};
}

/// Where fingers press, of a response with these free vertices and g columns.
TouchResponse readTouch(RowReader& rows, const std::vector<std::int32_t>& freeVertices, std::size_t g) {
    TouchResponse t;
    t.patches.centre = rows.array<std::int32_t>();
    t.patches.reach = rows.real(0.0, kMaxCoordinate);
    t.patches.first = rows.array<std::int32_t>();
    t.patches.patch = rows.array<std::int32_t>();
    t.patches.weight = rows.array<float>();
    const auto displacement = rows.array<float>();
    const auto forces = rows.array<double>(), compliance = rows.array<double>();
    t.probes = rows.array<std::int32_t>();
    const auto gradients = rows.array<float>();
    t.asymmetry = rows.real();
    t.negativeEnergy = rows.real();
    const std::size_t count = t.patches.centre.size(), columns = 3 * count;
    require(count >= 1 && count <= kMaxTouchPatches && !t.patches.first.empty(), "touch is broken");
    const auto vertices = static_cast<std::int64_t>(t.patches.first.size()) - 1;
    require(t.patches.first.front() == 0 && std::is_sorted(t.patches.first.begin(), t.patches.first.end()) &&
                static_cast<std::size_t>(t.patches.first.back()) == t.patches.patch.size() && t.patches.weight.size() == t.patches.patch.size(),
            "touch is broken");
    require(allWithin(t.patches.centre, vertices) && allWithin(t.patches.patch, static_cast<std::int64_t>(count)) && allWithin(t.probes, vertices) && allWithin(freeVertices, vertices),
            "touch names what is not there");
    require(std::all_of(t.patches.weight.begin(), t.patches.weight.end(), [](float w) { return isFinite(w) && w >= 0.0f && w <= 1.0f; }), "touch has a broken weight");
    require(displacement.size() == 3 * freeVertices.size() * columns && forces.size() == g * columns && compliance.size() == columns * columns &&
                gradients.size() == 9 * t.probes.size() * columns,
            "touch has a broken size");
    require(allFinite(displacement) && allFinite(forces) && allFinite(compliance) && allFinite(gradients), "touch is not finite");
    const auto put = [&](const auto& from, auto& to, std::size_t height) {
        to.resize(static_cast<Eigen::Index>(height), static_cast<Eigen::Index>(columns));
        std::copy(from.begin(), from.end(), to.data());
    };
    put(displacement, t.displacement, 3 * freeVertices.size());
    put(forces, t.forces, g);
    put(compliance, t.compliance, columns);
    put(gradients, t.gradients, 9 * t.probes.size());
    return t;
}

}  // namespace

void createResponseTables(Database& db) {
    db.run(kResponseTable);
    db.run(kTouchTable);
}

void writeResponses(Database& db, std::span<const StoredResponse> responses) {
    RowWriter rows(db, "INSERT INTO responses VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    int id = 0;
    for (const StoredResponse& r : responses) {
        const ElementResponse& a = *r.response;
        std::vector<std::int32_t> bases;
        // What a basis has besides its kind: the number of vertices, or whether the face is flat and twice the number of warping modes.
        for (const FaceBasis& basis : a.bases)
            bases.insert(bases.end(), {static_cast<std::int32_t>(basis.kind), basis.kind == BasisKind::Full ? basis.vertices : basis.flat + 2 * basis.modes});
        rows.row(++id, std::vector{r.key.high, r.key.low}, std::vector{r.shape.high, r.shape.low}, a.freeVertices, bases, a.response, a.stiffness, a.tractions, a.loads,
                 a.loadForces, a.quality.solve.residual, a.quality.solve.rcond, a.quality.solve.peakBytes, a.quality.asymmetry, a.quality.negativeEnergy,
                 a.quality.solverVertices, a.quality.solverNodes, a.quality.decimated, a.quality.error, a.quality.mappingError, a.quality.shapeError,
                 a.quality.tetrahedra, a.quality.noFilling);
    }
    RowWriter touches(db, "INSERT INTO touch_responses VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)");
    id = 0;
    for (const StoredResponse& r : responses) {
        const TouchResponse& t = r.response->touch;
        ++id;
        if (t.patches.count() == 0) continue;
        touches.row(id, t.patches.centre, t.patches.reach, t.patches.first, t.patches.patch, t.patches.weight, t.displacement, t.forces, t.compliance, t.probes, t.gradients,
                    t.asymmetry, t.negativeEnergy);
    }
}

std::map<std::int64_t, ResponseRow> readResponses(Database& db, bool keep) {
    std::map<std::int64_t, ResponseRow> read;
    const auto touchOf = [&](std::int64_t response, const ElementResponse& of) {
        RowReader rows(db, ("SELECT * FROM touch_responses WHERE response=" + std::to_string(response)).c_str());
        if (!rows.next()) return TouchResponse{};
        rows.integer();
        return readTouch(rows, of.freeVertices, static_cast<std::size_t>(of.columns()));
    };
    RowReader rows(db, "SELECT * FROM responses ORDER BY id");
    while (rows.next()) {
        const std::int64_t responseId = rows.integer();
        ResponseRow r;
        r.key = readKey(rows);
        r.shape = readKey(rows);
        auto a = std::make_shared<ElementResponse>();
        a->freeVertices = rows.array<std::int32_t>();
        require(ascendingWithin(a->freeVertices, std::numeric_limits<std::int32_t>::max()), "a response is broken");
        const auto bases = rows.array<std::int32_t>(2);
        a->firstColumn.push_back(0);
        for (std::size_t i = 0; i < bases.size(); i += 2) {
            require(bases[i] >= 0 && bases[i] <= static_cast<std::int32_t>(BasisKind::Modes) && bases[i + 1] >= 0, "a basis is unknown");
            FaceBasis basis;
            basis.kind = static_cast<BasisKind>(bases[i]);
            if (basis.kind == BasisKind::Full) {
                require(bases[i + 1] <= kMaxFaceVertices, "a basis is unknown");
                basis.vertices = bases[i + 1];
            } else {
                basis.flat = bases[i + 1] % 2 == 1;
                basis.modes = bases[i + 1] / 2;
                require(basis.kind == BasisKind::Modes ? basis.modes >= 1 && basis.modes <= BasisChoice::kMaxModes : basis.modes == 0, "a basis is unknown");
            }
            a->bases.push_back(std::move(basis));
            require(static_cast<std::int64_t>(a->firstColumn.back()) + a->bases.back().columns() <= 3 * kMaxFaceVertices, "a basis is too large");
            a->firstColumn.push_back(a->firstColumn.back() + a->bases.back().columns());
        }
        const auto g = static_cast<std::size_t>(a->columns());
        const auto values = rows.array<double>(), stiffness = rows.array<double>(), tractions = rows.array<double>(), loads = rows.array<double>(),
                   loadForces = rows.array<double>();
        require(values.size() == 3 * a->freeVertices.size() * g && stiffness.size() == g * g, "a response has a broken size");
        require(tractions.empty() || tractions.size() == g * g, "a response has a broken size");
        require(loads.empty() ? loadForces.empty() : loads.size() == 12 * a->freeVertices.size() && loadForces.size() == 4 * g, "a response has a broken size");
        require(allFinite(values) && allFinite(stiffness) && allFinite(tractions) && allFinite(loads) && allFinite(loadForces), "a response is not finite");
        a->response = Eigen::Map<const Eigen::MatrixXd>(values.data(), 3 * static_cast<Eigen::Index>(a->freeVertices.size()), static_cast<Eigen::Index>(g));
        const auto matrix = [](const std::vector<double>& from, std::size_t columns) -> Eigen::MatrixXd {
            return Eigen::Map<const Eigen::MatrixXd>(from.data(), static_cast<Eigen::Index>(from.size() / columns), static_cast<Eigen::Index>(columns));
        };
        a->stiffness = Eigen::Map<const Eigen::MatrixXd>(stiffness.data(), static_cast<Eigen::Index>(g), static_cast<Eigen::Index>(g));
        if (!tractions.empty()) a->tractions = matrix(tractions, g);
        if (!loads.empty()) {
            a->loads = matrix(loads, 4);
            a->loadForces = matrix(loadForces, 4);
        }
        a->quality.solve.residual = rows.real();
        a->quality.solve.rcond = rows.real();
        a->quality.solve.peakBytes = static_cast<std::size_t>(rows.integer(0, std::numeric_limits<std::int64_t>::max()));
        a->quality.asymmetry = rows.real();
        a->quality.negativeEnergy = rows.real();
        a->quality.solverVertices = static_cast<int>(rows.integer(0, std::numeric_limits<int>::max()));
        a->quality.solverNodes = static_cast<int>(rows.integer(0, std::numeric_limits<int>::max()));
        a->quality.decimated = rows.boolean();
        a->quality.error = rows.real();
        a->quality.mappingError = rows.real();
        a->quality.shapeError = rows.real();
        a->quality.tetrahedra = rows.integer(0, std::numeric_limits<std::int32_t>::max());
        a->quality.noFilling = readUtf8(rows);
        a->touch = touchOf(responseId, *a);
        if (!keep) {
            for (Eigen::MatrixXd* part : {&a->response, &a->stiffness, &a->tractions, &a->loads, &a->loadForces}) part->resize(0, 0);
            a->touch = {};
        }
        r.response = std::move(a);
        read.emplace(responseId, std::move(r));
    }
    return read;
}

bool hasWarping(const ElementResponse& response) { return !response.bases.empty() && response.bases[0].kind == BasisKind::Modes; }

void addWarping(ElementResponse& response, const TriangleMesh& body, std::span<const JointFace> faces) {
    if (!hasWarping(response)) return;
    require(response.bases.size() == faces.size(), "a response belongs to other joint faces");
    for (std::size_t f = 0; f < faces.size(); ++f) response.bases[f].warping = FaceBasis::on(body, faces[f], response.bases[f].choice()).warping;
}

}  // namespace imomushi
