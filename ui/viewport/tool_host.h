// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <memory>

#include "core/proposal/proposal.h"
#include "ui/models/studio_document.h"
#include "ui/tools/tool.h"

namespace imomushi {

class ProposalTool;

/// The tool that the pointer has, and how one follows another.
class ToolHost : public QObject {
    Q_OBJECT
public:
    explicit ToolHost(StudioDocument& document, QObject* parent = nullptr);
    ~ToolHost() override;

    [[nodiscard]] Tool& tool() const { return *tool_; }
    [[nodiscard]] ToolKind kind() const { return kind_; }
    void setTool(ToolKind kind);
    /// What all tools follow from now on.
    void setOptions(ToolOptions options);
    /// Lets the tool say again what it needs.
    void begin() { tool_->begin(); }
    /// A gesture is open: commands from elsewhere must wait or cancel() it first.
    [[nodiscard]] bool busy() const { return tool_->busy(); }
    /// Takes back what is unfinished (Esc).
    void cancel();
    /// Steps of the tool's own come before those of the document. False: it has none.
    bool undo();
    bool redo();
    /// If the tool is over(), chooses the select tool after the current event.
    void leaveIfOver();

    /// Shows how a character would be made soft, to be changed, accepted or left.
    void propose(PartId character, Proposal proposal);
    /// Shows the proposal for a character again that another tool took the place of, with its steps. False: there is none.
    bool resumeProposal(PartId character);
    /// What was accepted is not done: the artist goes on.
    void handBackProposal();
    /// What is shown now; null: no proposal is.
    [[nodiscard]] const Proposal* proposal() const;

Q_SIGNALS:
    void interrupted();  ///< what the pointer did until now does not concern the tool any more
    void changed();      ///< what the tool shows and says
    void toolChanged(imomushi::ToolKind kind);
    /// A proposal was accepted: this make-soft is to be done. handBackProposal() where it is not.
    void proposalAccepted(const imomushi::Json& command);
    /// Another tool took the place of a proposal that is neither accepted nor left.
    void proposalKept();

private:
    void use(ToolKind kind, std::unique_ptr<Tool> tool);

    StudioDocument& document_;
    ToolKind kind_ = ToolKind::Select;
    std::unique_ptr<Tool> tool_;
    std::unique_ptr<ProposalTool> keptProposal_;  ///< while another tool is chosen
    ToolOptions options_;
};

}  // namespace imomushi
