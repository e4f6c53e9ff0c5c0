// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/packed_response.h"

#include <array>
#include <string>

#include "core/document/project_rows.h"
#include "core/document/response_rows.h"

namespace imomushi {

namespace {

/// "IMOR": SQLite's application id of a packed response. Its version changes with the tables: 2 has "filled_responses", where the response has something to say there, and 3
/// arrays in parts too.
constexpr std::int64_t kApplicationId = 0x494d4f52, kPackVersion = 3;

constexpr std::array<const char*, 4> kPackedTables = {"responses", "touch_responses", "filled_responses", "value_parts"};
[[nodiscard]] std::span<const char* const> packedTables(std::int64_t version) { return std::span<const char* const>(kPackedTables).first(static_cast<std::size_t>(version) + 1); }

}  // namespace

Result<std::vector<std::byte>> packResponse(const ElementResponse& response) {
    try {
        Database db;
        db.run(("PRAGMA application_id=" + std::to_string(kApplicationId)).c_str());
        db.run("BEGIN");
        db.run("CREATE TABLE info (digest TEXT)");
        createResponseTable(db);
        createTouchTable(db);
        if (saysFilling(response)) createFilledTable(db);
        const StoredResponse one{{}, {}, std::shared_ptr<const ElementResponse>(std::shared_ptr<void>(), &response)};
        writeResponses(db, {&one, 1});
        if (db.divided() && !saysFilling(response)) createFilledTable(db);
        const std::int64_t version = db.divided() ? kPackVersion : saysFilling(response) ? 2 : 1;
        db.run(("PRAGMA user_version=" + std::to_string(version)).c_str());
        RowWriter(db, "INSERT INTO info VALUES (?)").row(db.digest(packedTables(version)));
        db.run("COMMIT");
        return db.file();
    } catch (const DatabaseError& error) {
        return fail("not-writable", std::string("The response could not be packed (") + error.what() + ").");
    }
}

Result<ElementResponse> unpackResponse(std::span<const std::byte> bytes, const TriangleMesh& body, std::span<const JointFace> faces) {
    try {
        Database db(bytes);
        const std::int64_t version = db.number("PRAGMA user_version");
        require(db.number("PRAGMA application_id") == kApplicationId && version >= 1 && version <= kPackVersion, "it has another format");
        RowReader info(db, "SELECT digest FROM info");
        require(info.next() && info.text() == db.digest(packedTables(version)), "its content does not match its digest");
        auto rows = readResponses(db, {true, version >= 2});
        require(rows.size() == 1, "it does not hold one response");
        ElementResponse response = std::move(*rows.begin()->second.response);
        require(response.bases.size() == faces.size() && (response.freeVertices.empty() || response.freeVertices.back() < body.vertices.rows()), "it belongs to another element");
        addWarping(response, body, faces);
        return response;
    } catch (const DatabaseError& reason) {
        return fail("damaged", std::string("A packed response is damaged (") + reason.what() + "): compute it again.");
    }
}

}  // namespace imomushi
