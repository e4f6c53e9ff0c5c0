// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/meetings.h"

#include "core/session/session_access.h"

namespace imomushi {

Result<void> pressWhatMet(SessionAccess& access, std::set<PartId>& known, Json& met, const Progress& progress) {
    const Document& document = access.document();
    const std::set<PartId>& now = document.effects[EffectKind::Contact].elements;
    if (now.size() == known.size()) return {};
    for (const PartId id : now) {
        if (known.contains(id)) continue;
        if (auto computed = access.responses.compute(id, progress); !computed) return tl::unexpected(computed.error());
        met.push_back(document.elements.at(id)->name);
    }
    known = now;
    access.changedResponses();
    return {};
}

}  // namespace imomushi
