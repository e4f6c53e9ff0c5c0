// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/document/project_rows.h"
#include "core/document/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kHandleTables = R"(
CREATE TABLE handles (element INTEGER, position INTEGER, face TEXT, point BLOB, radius REAL, bone INTEGER, at_end INTEGER, PRIMARY KEY (element, position));
CREATE TABLE handle_goals (element INTEGER, face TEXT, held INTEGER, pinned INTEGER, at BLOB, turn BLOB, from_at BLOB, from_turn BLOB, seconds REAL,
    elapsed REAL, PRIMARY KEY (element, face));
)";

}  // namespace

Eigen::Quaterniond readTurn(RowReader& row) {
    constexpr double kUnit = 1e-6;  // by rounding
    const auto q = row.array<double>(4);
    require(q.size() == 4 && allCoordinates(q), "a turn is broken");
    const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
    require(std::abs(turn.norm() - 1.0) < kUnit, "a turn is no rotation");
    return turn;
}

void createHandleTables(Database& db) { db.run(kHandleTables); }

void writeHandles(Database& db, const Document& document) {
    RowWriter handles(db, "INSERT INTO handles VALUES (?,?,?,?,?,?,?)");
    for (const auto& [id, element] : document.elements)
        for (std::size_t i = 0; i < element->handles.size(); ++i) {
            const Handle& h = element->handles[i];
            handles.row(id, i, h.face, h.point, h.radius, h.bone ? h.bone->bone : PartId(0), h.bone && h.bone->atEnd);
        }
    RowWriter goals(db, "INSERT INTO handle_goals VALUES (?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [handle, g] : document.handleGoals) {
        const Eigen::Vector4d turn = g.target.turn.coeffs(), from = g.from.turn.coeffs();
        goals.row(handle.element, handle.face, g.target.held, g.pinned, g.target.at, turn, g.from.at, from, g.seconds, g.elapsed);
    }
}

void readHandles(Database& db, Document& document) {
    std::map<PartId, std::vector<Handle>> read;
    RowReader rows(db, "SELECT * FROM handles ORDER BY element, position");
    while (rows.next()) {
        const PartId id = readId(rows);
        auto& handles = read[id];
        readPosition(rows, handles.size());
        Handle handle;
        handle.face = rows.text();
        handle.point = readPoint(rows);
        handle.radius = rows.real(0.0, kMaxCoordinate);
        const PartId bone = readIdOrNone(rows);
        const bool atEnd = rows.boolean();
        require(bone == 0 || document.bones.contains(bone), "a handle hangs on a bone that is not there");
        if (bone != 0) handle.bone = EndpointRef{bone, atEnd};
        const auto element = document.elements.find(id);
        require(element != document.elements.end() && element->second->faceIndex(handle.face) >= 0, "a handle has no face");
        require(checkNewName(document, handle.face).has_value(), "a name is broken or used twice");
        require(!document.jointOf({id, handle.face}), "a handle is joined");
        for (const auto& [other, known] : read)
            for (const Handle& h : known) require(h.face != handle.face, "two handles have one name");
        handles.push_back(std::move(handle));
    }
    for (auto& [id, handles] : read) {
        Element element = *document.elements.at(id);
        element.handles = std::move(handles);
        document.elements.at(id) = std::make_shared<const Element>(std::move(element));
    }
    RowReader goals(db, "SELECT * FROM handle_goals ORDER BY element, face");
    while (goals.next()) {
        FaceRef handle;
        handle.element = readId(goals);
        handle.face = goals.text();
        HandleGoal goal;
        goal.target.held = goals.boolean();
        goal.pinned = goals.boolean();
        goal.target.at = readPoint(goals);
        goal.target.turn = readTurn(goals);
        goal.from.at = readPoint(goals);
        goal.from.turn = readTurn(goals);
        goal.seconds = goals.real(0.0, 1e6);
        goal.elapsed = goals.real(0.0, 1e6);
        const auto element = document.elements.find(handle.element);
        require(element != document.elements.end() && element->second->handleOf(handle.face), "a handle that was moved is missing");
        require(goal.target.held || !goal.pinned, "a pinned handle is not held");
        document.handleGoals.emplace(handle, goal);
    }
}

}  // namespace imomushi
