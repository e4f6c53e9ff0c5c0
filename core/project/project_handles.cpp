// SPDX-License-Identifier: GPL-3.0-or-later

#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kHandleTables = R"(
CREATE TABLE handles (element INTEGER, position INTEGER, face TEXT, point BLOB, radius REAL, bone INTEGER, at_end INTEGER, PRIMARY KEY (element, position));
CREATE TABLE handle_goals (element INTEGER, face TEXT, held INTEGER, pinned INTEGER, at BLOB, turn BLOB, from_at BLOB, from_turn BLOB, seconds REAL,
    elapsed REAL, PRIMARY KEY (element, face));
)";

}  // namespace

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
        const Eigen::Vector4d turn = g.target.rotation.coeffs(), from = g.from.rotation.coeffs();
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
        readColumns(rows, handle.face, handle.point, Within{handle.radius, 0.0, kMaxCoordinate});
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
        HandleGoal goal;
        readColumns(goals, handle.face, goal.target.held, goal.pinned, goal.target.at, goal.target.rotation, goal.from.at, goal.from.rotation,
                    Within{goal.seconds, 0.0, 1e6}, Within{goal.elapsed, 0.0, 1e6});
        const auto element = document.elements.find(handle.element);
        require(element != document.elements.end() && element->second->handleOf(handle.face), "a handle that was moved is missing");
        require(goal.target.held || !goal.pinned, "a pinned handle is not held");
        document.handleGoals.emplace(handle, goal);
    }
}

}  // namespace imomushi
