// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/help_dialogs.h"

#include <QDialogButtonBox>
#include <QIcon>
#include <QPushButton>
#include <QScreen>
#include <QTextBrowser>
#include <QVBoxLayout>
#include <utility>
#include <vector>

#include "core/project/version.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/scrolled.h"

namespace imomushi {

ControlsDialog::ControlsDialog(const ActionSet& actions, bool blenderNavigation, QWidget* parent) : QDialog(parent) {
    using Rows = std::vector<std::pair<QString, QString>>;
    const Rows mouse = {
        {tr("Turn the view"), blenderNavigation ? tr("Middle mouse button") : tr("Alt + left mouse button")},
        {tr("Move the view"), blenderNavigation ? tr("Shift + middle mouse button") : tr("Alt + middle mouse button")},
        {tr("Nearer, farther"), blenderNavigation ? tr("Wheel") : tr("Wheel, Alt + right mouse button")},
        {tr("Select"), tr("Click, or drag a box from nothing, with Ctrl a loop; Shift adds")},
        {tr("Let go of what is dragged or pinned"), tr("Double click with the drag tool")},
        {tr("Take back what is unfinished"), tr("Esc or right mouse button")},
    };
    const Rows view = {
        {tr("Views along the axes"), QStringLiteral("1, 3, 7; Ctrl+1, Ctrl+3, Ctrl+7")},
        {tr("With or without perspective"), QStringLiteral("5")},
        {tr("Turn by 15°"), tr("4, 6, 8, 2 of the keypad")},
        {tr("The end of a bone behind the one under the pointer"), tr("Tab, or a second click")},
        {tr("Pin what is under the pointer, with the drag tool"), QStringLiteral("P")},
        {tr("While dragging: along one axis"), QStringLiteral("X, Y, Z")},
        {tr("While dragging: across an axis"), QStringLiteral("Shift+X, Y, Z")},
        {tr("While dragging: how far, how much"), tr("Numbers, like 12 cm, 30°, *1.5 or 1/3; Tab, Backspace, Enter")},
        {tr("While dragging: turn"), tr("R or wheel")},
        {tr("While dragging the end of a bone: the trunk leans, too, or stays upright"), QStringLiteral("B")},
        {tr("While dragging: finer, in steps"), tr("Shift, Ctrl")},
        {tr("While dragging flesh: keep the temporary handle"), QStringLiteral("K")},
        {tr("Without a button: move, turn and scale what is selected"), blenderNavigation ? QStringLiteral("G, R, S") : QStringLiteral("G, S")},
        {tr("The selected joint face, with its tool: larger, smaller, brush, add a flat region"), QStringLiteral("+, -, C, L")},
        {tr("Cut here, or accept a proposal"), tr("Enter")},
    };
    Rows commands;  // keys can be changed
    for (const QAction* action : actions.all())
        if (const auto keys = action->shortcuts(); !keys.isEmpty()) commands.emplace_back(commandName(*action), QKeySequence::listToString(keys, QKeySequence::NativeText).replace(QStringLiteral("; "), QStringLiteral(", ")));
    QString text;
    const auto table = [&](const QString& title, const Rows& rows) {
        text += QStringLiteral("<h3>%1</h3><table cellspacing='0' cellpadding='4' width='100%'>").arg(title.toHtmlEscaped());
        for (const auto& [what, how] : rows) text += QStringLiteral("<tr><td width='58%'>%1</td><td><b>%2</b></td></tr>").arg(what.toHtmlEscaped(), how.toHtmlEscaped());
        text += QStringLiteral("</table>");
    };
    table(tr("Mouse"), mouse);
    table(tr("Keys in the view"), view);
    table(tr("Keys of commands"), commands);
    setWindowTitle(tr("Mouse and keys"));
    auto* page = named(new QTextBrowser(this), "controls");
    page->setFrameShape(QFrame::NoFrame);
    page->setAccessibleName(windowTitle());
    page->setHtml(text);
    auto* buttons = new QDialogButtonBox(this);
    connect(buttons->addButton(tr("Close"), QDialogButtonBox::RejectRole), &QPushButton::clicked, this, &QDialog::reject);
    fill(new QVBoxLayout(this), QMargins(px(18), px(14), px(18), px(14)), Share{page, 1}, buttons);
    resize(withinScreen(*this, {px(560), px(640)}));
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
