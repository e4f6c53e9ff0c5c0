// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/receiver_rows.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QIntValidator>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QMenu>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/panels/live/state_label.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/switch.h"

namespace imomushi {
namespace {

using Receiver = OutputDeck::Receiver;

QString protocolText(OutputProtocol protocol) { return protocol == OutputProtocol::Vmc ? QStringLiteral("VMC") : QStringLiteral("OSC"); }

/// What goes to a receiver, in plain words; empty: it is off.
QString stateText(const Receiver& receiver) {
    if (!receiver.trouble.isEmpty()) return receiver.trouble;
    if (!receiver.on) return {};
    if (receiver.sent.frames == 0) return ReceiverRows::tr("On. Nothing was sent yet.");
    if (receiver.protocol == OutputProtocol::Vmc && receiver.sent.bones == 0) return ReceiverRows::tr("Sent without bones: none of this character is a bone of a human, which is all that VMC knows. OSC tells of all of them.");
    if (receiver.lost > 0) return ReceiverRows::tr("Nobody takes what is sent: does the other program listen?");
    if (receiver.frames <= 1) return ReceiverRows::tr("On. What stands still is sent once a second.");
    return ReceiverRows::tr("%1 frames/s are sent.").arg(QLocale().toString(qulonglong(receiver.frames)));
}

}  // namespace

ReceiverRows::ReceiverRows(OutputDeck& outputs, QWidget* parent) : QWidget(parent), outputs_(outputs) {
    title_ = styled(new QLabel(this), "section");
    list_ = new QVBoxLayout;
    list_->setSpacing(px(6));
    add_ = named(new QPushButton(this), "addReceiver");
    add_->setProperty("flat", true);
    connect(add_, &QPushButton::clicked, this, [this] {
        QMenu menu(this);
        for (const auto protocol : {OutputProtocol::Vmc, OutputProtocol::Osc}) connect(menu.addAction(protocolText(protocol)), &QAction::triggered, this, [this, protocol] { outputs_.add(protocol); });
        menu.exec(add_->mapToGlobal(QPoint(0, add_->height())));
    });
    fill(new QVBoxLayout(this), QMargins(0, px(10), 0, 0), Spacing{px(6)}, title_, list_, Share{add_, 0, Qt::AlignLeft});
    connect(&outputs, &OutputDeck::changed, this, &ReceiverRows::follow);
    connect(&outputs, &OutputDeck::told, this, &ReceiverRows::tell);
    connect(&Appearance::instance(), &Appearance::changed, this, &ReceiverRows::rebuild);
    rebuild();
}

void ReceiverRows::rebuild() {
    for (const Row& row : rows_) row.all->deleteLater();
    rows_.clear();
    for (std::size_t i = 0; i < outputs_.receivers().size(); ++i) addRow(i);
    title_->setText(tr("Send what is performed"));
    add_->setText(tr("Add a receiver"));
    add_->setToolTip(tr("Another program is told where bones, handles and shapes are, 60 times a second or as often as the project says: an avatar by VMC, a show controller or another Imomushi by OSC."));
    follow();
}

void ReceiverRows::addRow(std::size_t i) {
    const Receiver& receiver = outputs_.receivers()[i];
    const QString name = protocolText(receiver.protocol) + QStringLiteral(" %1").arg(i + 1);
    const std::string number = std::to_string(i + 1);
    Row row;
    row.key = receiver.key;
    row.all = new QWidget(this);
    row.on = named(new Switch(row.all), ("receiver-" + number).c_str());
    row.on->setAccessibleName(tr("Send to %1", "a receiver").arg(name));
    connect(row.on, &Switch::clicked, this, [this, i] { outputs_.setOn(i, !outputs_.receivers()[i].on); });
    auto* title = styled(new QLabel(protocolText(receiver.protocol), row.all), "section");
    row.host = named(new QLineEdit(row.all), ("host-" + number).c_str());
    row.host->setAccessibleName(tr("Address of %1", "a receiver").arg(name));
    row.host->setToolTip(tr("The address of the other machine; 127.0.0.1 is this one."));
    connect(row.host, &QLineEdit::editingFinished, this, [this, i, host = row.host] { outputs_.setHost(i, host->text().trimmed().toStdString()); });
    row.port = named(new QLineEdit(row.all), ("port-of-receiver-" + number).c_str());
    row.port->setValidator(new QIntValidator(1, 65535, row.port));
    row.port->setAccessibleName(tr("Port of %1", "a receiver").arg(name));
    row.port->setFixedWidth(px(66));
    connect(row.port, &QLineEdit::editingFinished, this, [this, i, port = row.port] { outputs_.setPort(i, port->text().toInt()); });
    auto* remove = new QToolButton(row.all);
    remove->setProperty("small", true);
    remove->setIcon(themedIcon(QStringLiteral("close"), Appearance::Role::Muted));
    remove->setIconSize(QSize(px(16), px(16)));
    remove->setToolTip(tr("Remove this receiver"));
    remove->setAccessibleName(tr("Remove %1", "a receiver").arg(name));
    connect(remove, &QToolButton::clicked, this, [this, i] { QMetaObject::invokeMethod(this, [this, i] { outputs_.remove(i); }, Qt::QueuedConnection); });
    row.state = named(new QLabel(row.all), ("state-of-receiver-" + number).c_str());
    row.state->setWordWrap(true);
    row.state->setContentsMargins(row.on->sizeHint().width() + px(8), 0, 0, 0);
    fill(new QVBoxLayout(row.all), QMargins(0, 0, 0, 0), Spacing{px(2)}, fill(new QHBoxLayout, Spacing{px(8)}, row.on, title, Stretch{}, remove),
         fill(new QHBoxLayout, Spacing{px(8)}, Space{row.on->sizeHint().width()}, Share{row.host, 1}, row.port), row.state);
    list_->addWidget(row.all);
    rows_.push_back(row);
}

void ReceiverRows::follow() {
    const auto& receivers = outputs_.receivers();
    if (!std::ranges::equal(receivers, rows_, {}, &Receiver::key, &Row::key)) return rebuild();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_[i].on->setChecked(receivers[i].on);
        if (!rows_[i].host->hasFocus()) rows_[i].host->setText(QString::fromStdString(receivers[i].host));
        if (!rows_[i].port->hasFocus()) rows_[i].port->setText(QString::number(receivers[i].port));
    }
    tell();
}

void ReceiverRows::tell() {
    const auto& receivers = outputs_.receivers();
    for (std::size_t i = 0; i < rows_.size() && i < receivers.size(); ++i) showState(*rows_[i].state, stateText(receivers[i]), !receivers[i].trouble.isEmpty() || receivers[i].lost > 0);
}

void ReceiverRows::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) rebuild();
}

}  // namespace imomushi
