// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/base/hash.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// A response and what it answers.
struct StoredResponse {
    ContentKey key, shape;  ///< of all that it depends on; and of mesh, solver mesh, faces and basis alone, for which it fits with another nu too
    std::shared_ptr<const ElementResponse> response;
};

}  // namespace imomushi
