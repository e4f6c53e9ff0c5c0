// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/help_dialogs.h"

#include <QIcon>
#include <utility>

#include "core/document/version.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"

namespace imomushi {

ControlsDialog::ControlsDialog(const ActionSet& actions, bool blenderNavigation, QWidget* parent) : QMessageBox(parent) {
    // Keys can be changed.
    const auto keys = [&](std::initializer_list<const char*> ids) {
        QStringList found;
        for (const char* id : ids)
            if (const QKeySequence key = actions[id]->shortcut(); !key.isEmpty()) found << key.toString(QKeySequence::NativeText);
        return found.join(QStringLiteral(", "));
    };
    const std::pair<QString, QString> rows[] = {
        {tr("Turn the view"), blenderNavigation ? tr("Middle mouse button") : tr("Alt + left mouse button")},
        {tr("Move the view"), blenderNavigation ? tr("Shift + middle mouse button") : tr("Alt + middle mouse button")},
        {tr("Nearer, farther"), blenderNavigation ? tr("Wheel") : tr("Wheel, Alt + right mouse button")},
        {tr("Select"), tr("Click, or drag a box from nothing; Shift adds")},
        {tr("Take back what is unfinished"), tr("Esc or right mouse button")},
        {tr("Frame all, frame the selection"), keys({"frame-all", "frame-selection"})},
        {tr("Views along the axes"), QStringLiteral("1, 3, 7, 5")},
        {tr("Tools"), keys({"tool-select", "tool-face", "tool-bone", "tool-pose", "tool-touch"})},
        {tr("Propose bones and cuts"), keys({"propose"})},
        {tr("Precompute"), keys({"precompute"})},
        {tr("Record, play"), keys({"record", "play"})},
        {tr("Search commands"), keys({"search"})},
    };
    QString text = QStringLiteral("<table cellspacing='0' cellpadding='5' style='font-weight:400'>");
    for (const auto& [what, how] : rows) text += QStringLiteral("<tr><td style='padding-right:28px'>%1</td><td><b>%2</b></td></tr>").arg(what.toHtmlEscaped(), how.toHtmlEscaped());
    setWindowTitle(tr("Mouse and keys"));
    setTextFormat(Qt::RichText);
    setText(text + QStringLiteral("</table>"));
    addButton(tr("Close"), QMessageBox::RejectRole);
}

AboutDialog::AboutDialog(QWidget* parent) : QMessageBox(parent) {
    setWindowTitle(tr("About Imomushi"));
    setIconPixmap(QIcon(QStringLiteral(":/icons/imomushi.svg")).pixmap(QSize(px(64), px(64)), devicePixelRatioF()));
    setTextFormat(Qt::RichText);
    setText(QStringLiteral("<b>Imomushi %1</b><p style='font-weight:400'>%2</p><p style='font-weight:400'>%3</p>")
                .arg(QLatin1String(kVersion), tr("Articulated elastic characters in real time.").toHtmlEscaped(),
                     tr("Free software under the GNU General Public License, version 3 or later.").toHtmlEscaped()));
    addButton(tr("Close"), QMessageBox::RejectRole);
}

}  // namespace imomushi
