// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>

#include "core/base/hash.h"
#include "core/project/sqlite.h"
#include "core/project/stored_response.h"
#include "core/reduction/element_response.h"

// Responses as rows of two tables, "responses" and "touch_responses". Everything of a response is kept but the times of its precompute (the same work gives the
// same bytes) and the warping of its faces, which follows from the mesh. All throw DatabaseError.

namespace imomushi {

/// As read, before addWarping().
struct ResponseRow {
    ContentKey key, shape;
    std::shared_ptr<ElementResponse> response;
};

void createResponseTables(Database& db);
/// Their ids are 1, 2, ...
void writeResponses(Database& db, std::span<const StoredResponse> responses);
/// By id, checked in themselves: sizes agree, all numbers are finite. `keep` false: only to check them, without their matrices.
std::map<std::int64_t, ResponseRow> readResponses(Database& db, bool keep = true);
/// Whether the bases of `response` have warping columns.
[[nodiscard]] bool hasWarping(const ElementResponse& response);
/// Works out the warping of the faces again. `faces`: those of the response, on `body`.
void addWarping(ElementResponse& response, const TriangleMesh& body, std::span<const JointFace> faces);

}  // namespace imomushi
