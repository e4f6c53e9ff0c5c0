// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/source_rows.h"

#include <QComboBox>
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

#include "ui/models/mapping_texts.h"
#include "ui/panels/live/state_label.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/switch.h"

namespace imomushi {
namespace {

using Source = InputDeck::Source;

QString countText(std::uint64_t count) { return QLocale().toString(qulonglong(count)); }

/// What is wanted of a device, for people.
QString wantedText(const Source& source) {
    if (!source.device.empty()) return QString::fromStdString(deviceName(source.protocol, source.device));
    if (source.protocol == InputProtocol::Voice) return SourceRows::tr("a microphone");
    return source.protocol == InputProtocol::Midi ? SourceRows::tr("a MIDI device") : SourceRows::tr("a game controller");
}

/// How the keyboard is.
QString keyText(const Source& source) {
    return source.open ? SourceRows::tr("Keys of rows move the character while this window is in front. They do nothing else then.") : SourceRows::tr("Ready. Keys are heard while you learn, and where rows name them.");
}

/// How a device is.
QStringList deviceParts(const InputDeck& inputs, const Source& source) {
    const QString device = QString::fromStdString(source.heard.device);
    if (source.open && device.isEmpty()) return {SourceRows::tr("Waits for %1 to be plugged in.", "a device").arg(wantedText(source))};
    if (source.open) return {source.heard.counts.packets == 0 ? SourceRows::tr("%1 is here. Nothing was moved yet.", "a device").arg(device) : SourceRows::tr("%1: %2 packets/s.", "a device").arg(device, QLocale().toString(source.perSecond, 'f', 0))};
    if (inputs.devices(source.protocol).empty()) return {SourceRows::tr("None is plugged in.")};
    return {SourceRows::tr("Ready. It is opened while you learn, and for rows that name it.")};
}

/// What comes from a source, in plain words; empty: it is off.
QString stateText(const InputDeck& inputs, const Source& source) {
    if (!source.trouble.isEmpty()) return source.trouble;
    if (!source.on) return {};
    const auto& heard = source.heard;
    QStringList parts;
    if (source.protocol == InputProtocol::Keys) parts << keyText(source);
    else if (isOfDevices(source.protocol)) parts = deviceParts(inputs, source);
    else if (heard.counts.packets == 0 && heard.refused == 0)
        return source.network ? SourceRows::tr("Listening. Any machine may send to port %1.").arg(source.port) : SourceRows::tr("Listening. Programs on this machine may send to 127.0.0.1, port %1.").arg(source.port);
    else if (heard.senders == 0) parts << SourceRows::tr("Silent: no sender is heard now.");
    else parts << SourceRows::tr("%1 packets/s from %n sender(s).", nullptr, heard.senders).arg(QLocale().toString(source.perSecond, 'f', 0));
    if (heard.counts.malformed > 0) parts << SourceRows::tr("Broken packets, left out: %1.").arg(countText(heard.counts.malformed));
    if (heard.lost > 0) parts << SourceRows::tr("Packets that came too fast: %1.").arg(countText(heard.lost));
    if (heard.refused > 0) parts << SourceRows::tr("Too many senders; packets of the others, left out: %1.").arg(countText(heard.refused));
    return parts.join(u' ');
}

bool troubled(const Source& source) { return !source.trouble.isEmpty() || source.heard.counts.malformed > 0 || source.heard.lost > 0 || source.heard.refused > 0; }

}  // namespace

SourceRows::SourceRows(InputDeck& inputs, SourceCalibrator& calibrator, QWidget* parent) : QWidget(parent), inputs_(inputs), calibrator_(calibrator) {
    list_ = new QVBoxLayout;
    list_->setSpacing(px(6));
    add_ = named(new QPushButton(this), "addSource");
    add_->setProperty("flat", true);
    connect(add_, &QPushButton::clicked, this, [this] {
        QMenu menu(this);
        for (const InputProtocol protocol : {InputProtocol::Osc, InputProtocol::Vmc, InputProtocol::Pad, InputProtocol::Midi, InputProtocol::Voice}) connect(menu.addAction(protocolText(protocol)), &QAction::triggered, this, [this, protocol] { inputs_.add(protocol); });
        menu.exec(add_->mapToGlobal(QPoint(0, add_->height())));
    });
    fill(new QVBoxLayout(this), QMargins(0, 0, 0, 0), Spacing{px(6)}, list_, Share{add_, 0, Qt::AlignLeft}, Stretch{});
    connect(&inputs, &InputDeck::changed, this, &SourceRows::follow);
    connect(&inputs, &InputDeck::told, this, &SourceRows::tell);
    connect(&calibrator, &SourceCalibrator::changed, this, &SourceRows::followCalibrations);
    connect(&Appearance::instance(), &Appearance::changed, this, &SourceRows::rebuild);
    rebuild();
}

void SourceRows::rebuild() {
    for (const Row& row : rows_) row.all->deleteLater();
    rows_.clear();
    names_.clear();
    for (std::size_t i = 0; i < inputs_.sources().size(); ++i) addRow(i);
    add_->setText(tr("Add a source"));
    follow();
}

void SourceRows::addRow(std::size_t i) {
    const Source& source = inputs_.sources()[i];
    const QString name = QString::fromStdString(source.name), protocol = protocolText(source.protocol);
    Row row;
    row.all = new QWidget(this);
    row.on = named(new Switch(row.all), ("source-" + source.name).c_str());
    row.on->setAccessibleName(tr("Listen to %1", "a source").arg(name));
    connect(row.on, &Switch::clicked, this, [this, i] { inputs_.setOn(i, !inputs_.sources()[i].on); });
    auto* title = styled(new QLabel(protocol, row.all), "section");
    auto* called = styled(new QLabel(name.compare(protocol, Qt::CaseInsensitive) == 0 ? QString() : name, row.all), "muted");
    auto* top = fill(new QHBoxLayout, Spacing{px(8)}, row.on, title, called, Stretch{});
    if (!isOfDevices(source.protocol)) addPort(row, i, *top);
    else if (source.protocol != InputProtocol::Keys) addDevice(row, i);
    if (source.name != protocolName(source.protocol)) {  // one that was added
        auto* remove = new QToolButton(row.all);
        remove->setProperty("small", true);
        remove->setIcon(themedIcon(QStringLiteral("close"), Appearance::Role::Muted));
        remove->setIconSize(QSize(px(16), px(16)));
        remove->setToolTip(tr("Remove this source"));
        remove->setAccessibleName(tr("Remove %1", "a source").arg(name));
        connect(remove, &QToolButton::clicked, this, [this, i] { QMetaObject::invokeMethod(this, [this, i] { inputs_.remove(i); }, Qt::QueuedConnection); });
        top->addWidget(remove);
    }
    row.state = named(new QLabel(row.all), ("state-" + source.name).c_str());
    row.state->setWordWrap(true);
    row.state->setContentsMargins(row.on->sizeHint().width() + px(8), 0, 0, 0);
    auto* all = fill(new QVBoxLayout(row.all), QMargins(0, 0, 0, 0), Spacing{px(2)}, top);
    if (row.device) fill(all, fill(new QHBoxLayout, Space{row.on->sizeHint().width() + px(8)}, Share{row.device, 1}));
    all->addWidget(row.state);
    row.calibrate = named(new QPushButton(row.all), ("calibrate-" + source.name).c_str());
    row.calibrate->setProperty("flat", true);
    connect(row.calibrate, &QPushButton::clicked, this, [this, name = source.name] { Q_EMIT calibrationWanted(name); });
    fill(all, fill(new QHBoxLayout, Space{row.on->sizeHint().width() + px(8)}, Share{row.calibrate, 0, Qt::AlignLeft}, Stretch{}));
    list_->addWidget(row.all);
    rows_.push_back(row);
    names_.push_back(source.name);
}

void SourceRows::addPort(Row& row, std::size_t i, QHBoxLayout& top) {
    const Source& source = inputs_.sources()[i];
    const QString name = QString::fromStdString(source.name);
    auto* portName = styled(new QLabel(tr("Port"), row.all), "muted");
    row.port = named(new QLineEdit(row.all), ("port-" + source.name).c_str());
    row.port->setValidator(new QIntValidator(0, 65535, row.port));
    row.port->setAccessibleName(tr("Port of %1", "a source").arg(name));
    row.port->setFixedWidth(px(66));
    portName->setBuddy(row.port);
    connect(row.port, &QLineEdit::editingFinished, this, [this, i, port = row.port] {
        if (const QString typed = port->text(); !typed.isEmpty()) inputs_.setPort(i, typed.toInt());
        port->setText(QString::number(inputs_.sources()[i].port));
    });
    row.network = named(new QToolButton(row.all), ("network-" + source.name).c_str());
    row.network->setCheckable(true);
    row.network->setProperty("small", true);
    row.network->setIcon(themedIcon(QStringLiteral("network")));
    row.network->setIconSize(QSize(px(18), px(18)));
    row.network->setAccessibleName(tr("Other machines may send, too"));
    connect(row.network, &QToolButton::clicked, this, [this, i](bool checked) { inputs_.setNetwork(i, checked); });
    for (QWidget* part : std::initializer_list<QWidget*>{portName, row.port, row.network}) top.addWidget(part);
}

void SourceRows::addDevice(Row& row, std::size_t i) {
    const Source& source = inputs_.sources()[i];
    row.device = named(new QComboBox(row.all), ("device-" + source.name).c_str());
    row.device->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    row.device->setMinimumContentsLength(6);
    row.device->setAccessibleName(tr("Device of %1", "a source").arg(QString::fromStdString(source.name)));
    connect(row.device, &QComboBox::activated, this, [this, i, box = row.device](int chosen) { inputs_.setDevice(i, box->itemData(chosen).toString().toStdString()); });
}

/// The first one, those that are plugged in, and the one that is wanted where that is not.
void SourceRows::fillDevices(QComboBox& box, const InputDeck::Source& source) {
    QList<std::pair<QString, QString>> items{{tr("The first one"), QString()}};
    bool there = source.device.empty();
    for (const PluggedDevice& device : inputs_.devices(source.protocol)) {
        const std::pair item(QString::fromStdString(device.name), QString::fromStdString(device.device));
        if (!items.contains(item)) items << item;  // two alike are told apart by nothing
        there = there || device.device == source.device;
    }
    if (!there) items << std::pair(tr("%1 (not here)", "a device").arg(wantedText(source)), QString::fromStdString(source.device));
    bool same = box.count() == items.size();
    for (int i = 0; same && i < box.count(); ++i) same = box.itemText(i) == items[i].first && box.itemData(i).toString() == items[i].second;
    if (!same) {
        box.clear();
        for (const auto& [name, device] : items) box.addItem(name, device);
    }
    box.setCurrentIndex(box.findData(QString::fromStdString(source.device)));
}

void SourceRows::follow() {
    const auto& sources = inputs_.sources();
    if (sources.size() != rows_.size() || !std::equal(sources.begin(), sources.end(), names_.begin(), [](const Source& s, const std::string& name) { return s.name == name; })) return rebuild();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_[i].on->setChecked(sources[i].on);
        if (rows_[i].device) {
            fillDevices(*rows_[i].device, sources[i]);
            continue;
        }
        if (!rows_[i].port) continue;
        if (!rows_[i].port->hasFocus()) rows_[i].port->setText(QString::number(sources[i].port));
        rows_[i].network->setChecked(sources[i].network);
        rows_[i].network->setToolTip(sources[i].network ? tr("Every machine that reaches this one may send. Click: programs on this machine alone.") : tr("Programs on this machine alone may send. Click: open the port to the network."));
    }
    tell();
    followCalibrations();
}

void SourceRows::followCalibrations() {
    const auto& sources = inputs_.sources();
    for (std::size_t i = 0; i < rows_.size() && i < sources.size(); ++i) {
        QPushButton& button = *rows_[i].calibrate;
        button.setVisible(calibrator_.canCalibrate(sources[i]));
        if (!button.isVisibleTo(rows_[i].all)) continue;
        const auto poses = calibrator_.posesOf(sources[i].name);
        const QString off = residualText(mostOf(poses));  // empty: rows map other channels by now
        button.setText(poses.empty() ? tr("Calibrate…") : off.isEmpty() ? tr("Calibrated…") : tr("Calibrated, off by %1…").arg(off));
        button.setToolTip(tr("What this source says in a pose of yours becomes that pose of the character: who stands turned or leans, or wears a sensor askew, is put right."));
    }
}

void SourceRows::tell() {
    const auto& sources = inputs_.sources();
    for (std::size_t i = 0; i < rows_.size() && i < sources.size(); ++i) showState(*rows_[i].state, stateText(inputs_, sources[i]), troubled(sources[i]));
}

void SourceRows::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) rebuild();
}

}  // namespace imomushi
