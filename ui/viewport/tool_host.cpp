// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/tool_host.h"

#include <optional>
#include <utility>

#include "ui/models/failures.h"
#include "ui/tools/proposal_tool.h"

namespace imomushi {

ToolHost::ToolHost(StudioDocument& document, QObject* parent) : QObject(parent), document_(document), tool_(makeTool(ToolKind::Select, document)) {}

ToolHost::~ToolHost() {
    attempt([this] { tool_->cancel(); });  // a gesture that is taken back changes the document
}

void ToolHost::setTool(ToolKind kind) {
    if (kind != kind_) use(kind, makeTool(kind, document_));
}

void ToolHost::setOptions(ToolOptions options) {
    options_ = std::move(options);
    tool_->setOptions(options_);
    Q_EMIT changed();
}

void ToolHost::cancel() {
    Q_EMIT interrupted();
    tool_->cancel();
    Q_EMIT changed();
}

bool ToolHost::undo() {
    const bool own = tool_->hasSteps();
    if (own) tool_->undo();
    Q_EMIT changed();
    return own;
}

bool ToolHost::redo() {
    const bool own = tool_->hasSteps();
    if (own) tool_->redo();
    Q_EMIT changed();
    return own;
}

void ToolHost::leaveIfOver() {
    if (!tool_->over()) return;
    QMetaObject::invokeMethod(
        this,
        [this] {
            if (tool_->over()) setTool(ToolKind::Select);
        },
        Qt::QueuedConnection);
}

void ToolHost::use(ToolKind kind, std::unique_ptr<Tool> tool) {
    Q_EMIT interrupted();
    tool_->cancel();
    bool kept = false;
    if (auto* proposal = dynamic_cast<ProposalTool*>(tool_.get()); proposal && !proposal->dropped()) {
        kept = !proposal->over() && !proposal->handedOver();
        (void)tool_.release();
        keptProposal_.reset(proposal);
    }
    tool_ = std::move(tool);
    tool_->setOptions(options_);
    kind_ = kind;
    document_.setHovered(std::nullopt);
    Q_EMIT changed();
    Q_EMIT toolChanged(kind);
    if (kept) Q_EMIT proposalKept();
    tool_->begin();
}

// ---- proposals ---------------------------------------------------------------------------------------------------------

void ToolHost::propose(PartId character, Proposal proposal) {
    ProposalTool::Host host;
    host.accept = [this](const Json& command) { Q_EMIT proposalAccepted(command); };
    host.changed = [this] { Q_EMIT changed(); };
    use(ToolKind::Proposal, std::make_unique<ProposalTool>(document_, character, std::move(proposal), std::move(host)));
}

bool ToolHost::resumeProposal(PartId character) {
    const auto fits = [&](const ProposalTool* tool) { return tool && !tool->over() && tool->character() == character; };
    if (fits(dynamic_cast<const ProposalTool*>(tool_.get()))) return true;
    if (!fits(keptProposal_.get())) return false;
    keptProposal_->handBack();  // it may have been accepted, and that undone
    use(ToolKind::Proposal, std::move(keptProposal_));
    return true;
}

void ToolHost::handBackProposal() {
    if (auto* tool = dynamic_cast<ProposalTool*>(tool_.get()); tool && tool->handedOver()) tool->handBack();
    Q_EMIT changed();
}

const Proposal* ToolHost::proposal() const {
    const auto* tool = dynamic_cast<const ProposalTool*>(tool_.get());
    return tool ? &tool->proposal() : nullptr;
}

}  // namespace imomushi
