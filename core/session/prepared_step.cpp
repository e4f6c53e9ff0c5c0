// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/prepared_step.h"

#include <cassert>
#include <utility>

#include "core/base/try.h"
#include "core/document/document_change.h"
#include "core/session/session_access.h"

namespace imomushi {

bool PreparedStep::fits(const Document& document) const { return differInPoseAtMost(before, document); }

Result<PreparedStep> prepareStep(const CommandRegistry& registry, Project project, const std::vector<Json>& commands, const std::function<void(Session&)>& arrange, const Progress& progress) {
    PreparedStep made{project.document, {}, {}, {}, {}, {}, {}, nullptr};
    const auto known = project.responses;
    Session session(registry);
    if (arrange) arrange(session);
    SessionAccess(session).replace(std::move(project), {}, true, Json{{"do", "open"}});
    if (commands.size() > 1) session.beginGesture();
    for (std::size_t i = 0; i < commands.size(); ++i) {
        const double each = 1.0 / static_cast<double>(commands.size());
        IMOMUSHI_TRY(made.answer, session.execute(commands[i], progress.part(each * static_cast<double>(i), each * static_cast<double>(i + 1))));
    }
    session.endGesture();
    if (session.steps().size() != 1) return fail("internal", "What is prepared makes one step of the history.");
    made.after = session.document();
    made.step = session.steps().front();
    made.lines = session.script();
    made.lines.erase(made.lines.begin());  // it says where the document came from
    assert(!made.lines.empty());
    for (auto& [element, response] : session.project().responses)
        if (const auto before = known.find(element); before == known.end() || !(before->second.key == response.key) || before->second.response != response.response) made.responses.emplace_back(element, std::move(response));
    made.character = session.releaseCharacter();
    made.derived = session.responses().derived();
    return made;
}

std::shared_ptr<const BuiltCharacter> buildCharacter(const CommandRegistry& registry, Project project) {
    Session session(registry);
    SessionAccess(session).replace(std::move(project), {}, true, Json{{"do", "open"}});
    return session.releaseCharacter();
}

}  // namespace imomushi
