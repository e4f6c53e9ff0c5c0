// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/output_deck.h"

#include <QSettings>
#include <algorithm>
#include <utility>

#include "core/document/document_change.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

// Where programs listen that avatars are sent to, and show controllers.
constexpr int kAvatarPort = 39540, kControllerPort = 9001;
constexpr int kHighestPort = 65535;
constexpr const char* kReceivers = "live/receivers";

}  // namespace

OutputDeck::OutputDeck(StudioDocument& document, QObject* parent) : QObject(parent), document_(document) {
    load();
    timer_.setInterval(kTellMs);
    connect(&timer_, &QTimer::timeout, this, &OutputDeck::tell);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        const bool other = change.unknown || !change.elements.empty() || !change.joints.empty() || !change.bones.empty() || !change.characters.empty();
        if (!(other || paused_) || !thread_.sends()) return;
        thread_.pause();  // what is there now has other names
        followSoon();
    });
}

OutputDeck::~OutputDeck() { document_.performOutputs(nullptr); }

void OutputDeck::load() {
    QSettings settings;
    const int count = settings.beginReadArray(QLatin1String(kReceivers));
    for (int i = 0; i < count && receivers_.size() < kMostReceivers; ++i) {
        settings.setArrayIndex(i);
        Receiver receiver;
        const auto protocol = outputProtocolNamed(settings.value(QStringLiteral("protocol")).toString().toStdString());
        receiver.host = settings.value(QStringLiteral("host")).toString().toStdString();
        receiver.port = settings.value(QStringLiteral("port")).toInt();
        if (!protocol || receiver.host.empty() || receiver.port < 1 || receiver.port > kHighestPort) continue;
        receiver.protocol = *protocol;
        receiver.key = ++keys_;
        receivers_.push_back(std::move(receiver));
    }
    settings.endArray();
}

void OutputDeck::keep() const {
    QSettings settings;
    settings.beginWriteArray(QLatin1String(kReceivers), int(receivers_.size()));
    for (std::size_t i = 0; i < receivers_.size(); ++i) {
        settings.setArrayIndex(int(i));
        settings.setValue(QStringLiteral("protocol"), QString::fromStdString(std::string(outputProtocolName(receivers_[i].protocol))));
        settings.setValue(QStringLiteral("host"), QString::fromStdString(receivers_[i].host));
        settings.setValue(QStringLiteral("port"), receivers_[i].port);
    }
    settings.endArray();
}

void OutputDeck::open(Receiver& receiver) {
    receiver.sent = {};
    receiver.frames = receiver.lost = 0;
    receiver.trouble.clear();
    auto opened = UdpTarget::open(receiver.host, std::uint16_t(receiver.port));
    receiver.on = opened.has_value();
    if (opened) thread_.add(receiver.key, receiver.protocol, std::move(*opened));
    else receiver.trouble = errorText(opened.error());
}

void OutputDeck::setOn(std::size_t index, bool on) {
    Receiver& receiver = receivers_.at(index);
    if (on == receiver.on) return;
    receiver.trouble.clear();
    receiver.on = on;
    if (on) open(receiver);
    else thread_.remove(receiver.key);
    follow();
    Q_EMIT changed();
}

void OutputDeck::setHost(std::size_t index, const std::string& host) {
    Receiver& receiver = receivers_.at(index);
    if (host == receiver.host || host.empty()) return Q_EMIT changed();
    const bool on = receiver.on || !receiver.trouble.isEmpty();
    setOn(index, false);
    receiver.host = host;
    keep();
    if (on) setOn(index, true);
    Q_EMIT changed();
}

void OutputDeck::setPort(std::size_t index, int port) {
    Receiver& receiver = receivers_.at(index);
    if (port == receiver.port || port < 1 || port > kHighestPort) return Q_EMIT changed();
    const bool on = receiver.on || !receiver.trouble.isEmpty();
    setOn(index, false);
    receiver.port = port;
    keep();
    if (on) setOn(index, true);
    Q_EMIT changed();
}

void OutputDeck::add(OutputProtocol protocol) {
    if (receivers_.size() >= kMostReceivers) return;
    Receiver receiver;
    receiver.key = ++keys_;
    receiver.protocol = protocol;
    receiver.port = protocol == OutputProtocol::Vmc ? kAvatarPort : kControllerPort;
    receivers_.push_back(std::move(receiver));
    keep();
    Q_EMIT changed();
}

void OutputDeck::remove(std::size_t index) {
    setOn(index, false);
    receivers_.erase(receivers_.begin() + std::ptrdiff_t(index));
    keep();
    Q_EMIT changed();
}

void OutputDeck::followSoon() {
    if (scheduled_) return;
    scheduled_ = true;
    QMetaObject::invokeMethod(this, &OutputDeck::follow, Qt::QueuedConnection);
}

void OutputDeck::follow() {
    scheduled_ = false;
    if (!thread_.sends()) {
        timer_.stop();
        document_.performOutputs(nullptr);
        return;
    }
    if (!timer_.isActive()) timer_.start();
    const auto alive = document_.session().builtCharacter();
    paused_ = !alive || !*alive;
    if (paused_) thread_.pause();
    else thread_.follow(document_.document(), document_.session().plan());
    document_.performOutputs(&thread_);
}

void OutputDeck::tell() {
    for (Receiver& receiver : receivers_) {
        const auto sent = thread_.sent(receiver.key);
        if (!sent) continue;
        receiver.frames = sent->frames - receiver.sent.frames;
        receiver.lost = sent->lost - receiver.sent.lost;
        receiver.sent = *sent;
    }
    Q_EMIT told();
}

}  // namespace imomushi
