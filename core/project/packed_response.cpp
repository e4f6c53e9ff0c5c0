// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/packed_response.h"

#include <string>

#include "core/project/project_rows.h"
#include "core/project/response_rows.h"

namespace imomushi {

namespace {

/// "IMOR": SQLite's application id of a packed response. Its version changes with the tables.
constexpr std::int64_t kApplicationId = 0x494d4f52, kPackVersion = 4;

void createPackTables(Database& db) {
    createResponseTables(db);
    db.createPartTable();
}

}  // namespace

Result<std::vector<std::byte>> packResponse(const ElementResponse& response) {
    try {
        Database db;
        db.run(("PRAGMA application_id=" + std::to_string(kApplicationId)).c_str());
        db.run(("PRAGMA user_version=" + std::to_string(kPackVersion)).c_str());
        db.run("BEGIN");
        createPackTables(db);
        const StoredResponse one{{}, {}, std::shared_ptr<const ElementResponse>(std::shared_ptr<void>(), &response)};
        writeResponses(db, {&one, 1});
        db.seal();
        db.run("COMMIT");
        return db.file();
    } catch (const DatabaseError& error) {
        return fail("not-writable", std::string("The response could not be packed (") + error.what() + ").");
    }
}

Result<ElementResponse> unpackResponse(std::span<const std::byte> bytes, const TriangleMesh& body, std::span<const JointFace> faces) {
    try {
        Database db(bytes);
        require(db.number("PRAGMA application_id") == kApplicationId && db.number("PRAGMA user_version") == kPackVersion, "it has another format");
        Database model;
        createPackTables(model);
        (void)db.compareSchema(model);
        db.checkSeal();
        auto rows = readResponses(db);
        require(rows.size() == 1, "it does not hold one response");
        ElementResponse response = std::move(*rows.begin()->second.response);
        require(response.bases.size() == faces.size() && (response.freeVertices.empty() || response.freeVertices.back() < body.vertices.rows()), "it belongs to another element");
        addWarping(response, body, faces);
        return response;
    } catch (const DatabaseError& reason) {
        if (!reason.damaged()) return fail("not-readable", std::string("A packed response could not be read (") + reason.what() + ").");
        return fail("damaged", std::string("A packed response is damaged (") + reason.what() + "): compute it again.");
    }
}

}  // namespace imomushi
