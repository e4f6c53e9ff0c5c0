// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// One response as the bytes of a file: the same response gives the same bytes. The times of the precompute are left out. Errors: "not-writable" when a
/// number is not finite.
Result<std::vector<std::byte>> packResponse(const ElementResponse& response);

/// The response that packResponse() got, bit by bit. `body`, `faces`: what it was built for. Trusts nothing in `bytes`. Errors: "damaged", "not-readable".
Result<ElementResponse> unpackResponse(std::span<const std::byte> bytes, const TriangleMesh& body, std::span<const JointFace> faces);

}  // namespace imomushi
