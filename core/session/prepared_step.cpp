// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/prepared_step.h"

#include <cassert>
#include <utility>

#include "core/base/try.h"
#include "core/document/document_change.h"
#include "core/session/session_access.h"

namespace imomushi {

bool PreparedStep::fits(const Document& document) const { return differInPoseAtMost(before, document); }

Result<PreparedStep> prepareStep(const CommandRegistry& registry, Project project, const Json& command, const std::function<void(Session&)>& arrange, const Progress& progress) {
    PreparedStep made{command, project.document, {}, {}, {}, {}, {}, nullptr};
    const auto known = project.responses;
    Session session(registry);
    if (arrange) arrange(session);
    SessionAccess(session).replace(std::move(project), {}, true, Json{{"do", "open"}});
    IMOMUSHI_TRY(auto answer, session.execute(command, progress));
    if (session.steps().size() != 1) return fail("internal", "A command that is prepared makes one step of the history.");
    made.answer = std::move(answer);
    made.after = session.document();
    made.step = session.steps().front();
    made.lines = session.script();
    made.lines.erase(made.lines.begin());  // it says where the document came from
    assert(!made.lines.empty());
    for (auto& [element, response] : session.project().responses)
        if (const auto before = known.find(element); before == known.end() || !(before->second.key == response.key) || before->second.response != response.response) made.responses.emplace_back(element, std::move(response));
    made.character = session.releaseCharacter();
    return made;
}

std::shared_ptr<const BuiltCharacter> buildCharacter(const CommandRegistry& registry, Project project) {
    Session session(registry);
    SessionAccess(session).replace(std::move(project), {}, true, Json{{"do", "open"}});
    return session.releaseCharacter();
}

}  // namespace imomushi
