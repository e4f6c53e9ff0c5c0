// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/input_deck.h"

#include <QFileSystemWatcher>
#include <QSettings>
#include <algorithm>
#include <utility>

#include "core/document/cycle.h"
#include "core/document/document_change.h"
#include "core/input/key_names.h"
#include "core/live/direct_names.h"
#include "core/live/input_feed.h"
#include "ui/models/commands.h"
#include "ui/models/mapping_texts.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

// Where senders of both usually send to.
constexpr int kOscPort = 9000, kVmcPort = 39539;
constexpr int kLargestPort = 65535;
constexpr int kRateMs = 1000;
constexpr const char* kSources = "live/sources";
/// What was plugged in is ready a moment later, ms.
constexpr int kReadyMs = 400;
/// Where the system shows that devices come and go.
constexpr const char* kDeviceFolders[] = {"/dev/input", "/dev/snd"};

/// What the window itself is called as a source.
const std::string kWindow = "window";

/// Effects go on or off.
bool switchesEffects(const Effects& before, const Effects& after) {
    for (std::size_t k = 0; k < kEffects; ++k)
        if (before.has(EffectKind(k)) != after.has(EffectKind(k))) return true;
    return false;
}

/// Nobody is overheard who did not ask for it.
bool isOnAtFirst(InputProtocol protocol) { return isOfDevices(protocol) && protocol != InputProtocol::Voice; }

}  // namespace

InputDeck::InputDeck(StudioDocument& document, TakeDeck& deck, QObject* parent) : QObject(parent), document_(document), deck_(deck) {
    load();
    timer_.setInterval(kTellMs);
    connect(&timer_, &QTimer::timeout, this, &InputDeck::tell);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        const bool driven = change.unknown || !change.elements.empty() || !change.joints.empty() || !change.bones.empty() || !change.characters.empty() || change.mappings || change.poses || change.cycles || !change.takes.empty() || (change.effects && switchesEffects(*change.effects, document_.document().effects));
        const bool devices = std::any_of(sources_.begin(), sources_.end(), [this](const Source& s) { return isOfDevices(s.protocol) && wantsDevice(s) != s.open; });
        if (devices || (driven && (listens() || feed_))) followSoon();
        // Another project is not performed by what was learned for the last one.
        if (change.unknown) {
            stopLearning();
            faders_.clear();
            thread_.forget(kWindow);
            speaks_ = false;
        }
        if (change.has(&DocumentChange::cycles)) dropFaders();
    });
    connect(&document, &StudioDocument::frameStepped, this, &InputDeck::takeHold);
    connect(&deck, &TakeDeck::changed, this, [this] {
        if (std::exchange(takeShown_, deck_.shown()) != deck_.shown() && listens()) follow();
    });
}

InputDeck::~InputDeck() {
    if (feed_) document_.performInputs(nullptr);
}

void InputDeck::load() {
    QSettings settings;
    const int count = settings.beginReadArray(QLatin1String(kSources));
    for (int i = 0; i < count && sources_.size() < kMostSources; ++i) {
        settings.setArrayIndex(i);
        Source source;
        source.name = settings.value(QStringLiteral("name")).toString().toStdString();
        const auto protocol = protocolNamed(settings.value(QStringLiteral("protocol")).toString().toStdString());
        source.port = settings.value(QStringLiteral("port")).toInt();
        source.network = settings.value(QStringLiteral("network")).toBool();
        source.device = settings.value(QStringLiteral("device")).toString().toStdString();
        const bool known = std::any_of(sources_.begin(), sources_.end(), [&](const Source& s) { return s.name == source.name; });
        if (!protocol || source.name.empty() || !InputName::fits(source.name) || known || source.port < 0 || source.port > kLargestPort) continue;
        source.protocol = *protocol;
        source.on = isOfDevices(*protocol) && settings.value(QStringLiteral("on"), isOnAtFirst(*protocol)).toBool();
        sources_.push_back(std::move(source));
    }
    settings.endArray();
    for (const auto& [protocol, port] : {std::pair(InputProtocol::Osc, kOscPort), std::pair(InputProtocol::Vmc, kVmcPort), std::pair(InputProtocol::Pad, 0), std::pair(InputProtocol::Midi, 0), std::pair(InputProtocol::Keys, 0), std::pair(InputProtocol::Voice, 0)}) {
        Source source;
        source.name = protocolName(protocol);
        if (std::any_of(sources_.begin(), sources_.end(), [&](const Source& s) { return s.name == source.name; })) continue;
        source.protocol = protocol;
        source.port = port;
        source.on = isOnAtFirst(protocol);
        sources_.push_back(std::move(source));
    }
    packets_.resize(sources_.size());
}

void InputDeck::keep() const {
    QSettings settings;
    settings.beginWriteArray(QLatin1String(kSources), int(sources_.size()));
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        settings.setArrayIndex(int(i));
        settings.setValue(QStringLiteral("name"), QString::fromStdString(sources_[i].name));
        settings.setValue(QStringLiteral("protocol"), QString::fromStdString(std::string(protocolName(sources_[i].protocol))));
        settings.setValue(QStringLiteral("port"), sources_[i].port);
        settings.setValue(QStringLiteral("network"), sources_[i].network);
        settings.setValue(QStringLiteral("device"), QString::fromStdString(sources_[i].device));
        settings.setValue(QStringLiteral("on"), isOfDevices(sources_[i].protocol) && sources_[i].on);
    }
    settings.endArray();
}

void InputDeck::open(Source& source) {
    source.heard = {};
    source.perSecond = 0.0;
    source.trouble.clear();
    if (isOfDevices(source.protocol)) {
        auto opened = openDevice(source.protocol, source.device);
        source.open = opened.has_value();
        if (opened) thread_.open({source.name, source.protocol}, std::move(*opened));
        else source.trouble = errorText(opened.error());
        return;
    }
    const auto opened = thread_.open({source.name, source.protocol}, std::uint16_t(source.port), source.network ? UdpPort::From::Anywhere : UdpPort::From::Loopback);
    source.on = source.open = opened.has_value();
    if (opened) source.port = *opened;
    else source.trouble = errorText(opened.error());
}

void InputDeck::close(Source& source) {
    thread_.close(source.name);
    source.open = false;
    source.heard = {};
    source.perSecond = 0.0;
}

void InputDeck::setOn(std::size_t index, bool on) {
    Source& source = sources_.at(index);
    if (on == source.on) return;
    source.trouble.clear();
    packets_[index] = 0;
    source.on = on;
    if (isOfDevices(source.protocol)) {
        keep();
        if (on && source.protocol == InputProtocol::Voice) lookForDevices();
        followDevices();
    } else {
        on ? open(source) : close(source);
    }
    // Who plugs in wants to see it move.
    if (source.open) {
        waits_ = Waits::No;
        holdsAnyway_ = true;
    }
    if (!hears()) stopLearning();
    follow();
    Q_EMIT changed();
}

bool InputDeck::isMapped(const std::string& source) const {
    const auto& rows = document_.document().mappings;
    return rows && std::any_of(rows->begin(), rows->end(), [&](const InputMapping& m) { return m.row.source == source; });
}

bool InputDeck::wantsDevice(const Source& source) const { return source.on && source.trouble.isEmpty() && (learning() || isMapped(source.name)); }

void InputDeck::followDevices() {
    for (Source& source : sources_)
        if (isOfDevices(source.protocol) && wantsDevice(source) != source.open) source.open ? close(source) : open(source);
}

void InputDeck::setDevice(std::size_t index, const std::string& device) {
    Source& source = sources_.at(index);
    if (device == source.device) return;
    if (source.open) close(source);
    source.device = device;
    source.trouble.clear();
    keep();
    follow();
    Q_EMIT changed();
}

void InputDeck::lookForDevices() {
    if (!watcher_) {
        watcher_ = new QFileSystemWatcher(this);
        for (const char* folder : kDeviceFolders) watcher_->addPath(QLatin1String(folder));  // false where there is none: nothing can be plugged in
        lookSoon_.setSingleShot(true);
        lookSoon_.setInterval(kReadyMs);
        connect(watcher_, &QFileSystemWatcher::directoryChanged, &lookSoon_, qOverload<>(&QTimer::start));
        connect(&lookSoon_, &QTimer::timeout, this, &InputDeck::lookForDevices);
    }
    auto seen = devices_;
    // Who does not want to be heard does not want to wait for the sound of the system either.
    const bool voices = std::ranges::any_of(sources_, [](const Source& s) { return s.protocol == InputProtocol::Voice && s.on; });
    for (const InputProtocol protocol : {InputProtocol::Pad, InputProtocol::Midi, InputProtocol::Voice})
        if (protocol != InputProtocol::Voice || voices) seen[std::size_t(protocol)] = pluggedDevices(protocol);
    if (seen == devices_) return;
    devices_ = std::move(seen);
    Q_EMIT changed();
}

bool InputDeck::anythingPlugged() const {
    return hears() || std::any_of(sources_.begin(), sources_.end(), [this](const Source& s) { return isOfDevices(s.protocol) && s.on && !devices(s.protocol).empty(); });
}

bool InputDeck::canLearn() const {
    return anythingPlugged() || std::any_of(sources_.begin(), sources_.end(), [](const Source& s) { return s.protocol == InputProtocol::Keys && s.on; });
}

void InputDeck::setPort(std::size_t index, int port) {
    Source& source = sources_.at(index);
    port = std::clamp(port, 0, kLargestPort);
    if (port == source.port && source.trouble.isEmpty()) return;
    const bool on = source.on || !source.trouble.isEmpty();
    if (source.on) close(source);
    source.port = port;
    source.trouble.clear();
    keep();
    if (on) return setOn(index, true);
    Q_EMIT changed();
}

void InputDeck::setNetwork(std::size_t index, bool network) {
    Source& source = sources_.at(index);
    if (network == source.network) return;
    const bool on = source.on;
    if (on) close(source);
    source.network = network;
    keep();
    if (on) return setOn(index, true);
    Q_EMIT changed();
}

void InputDeck::add(InputProtocol protocol) {
    if (sources_.size() >= kMostSources) return;
    Source source;
    source.protocol = protocol;
    const auto taken = [&](const auto& is) { return std::any_of(sources_.begin(), sources_.end(), is); };
    source.name = protocolName(protocol);
    for (int i = 2; taken([&](const Source& s) { return s.name == source.name; }); ++i) source.name = std::string(protocolName(protocol)) + std::to_string(i);
    source.on = isOnAtFirst(protocol);
    if (!isOfDevices(protocol)) {
        source.port = protocol == InputProtocol::Vmc ? kVmcPort : kOscPort;
        while (taken([&](const Source& s) { return s.port == source.port; })) ++source.port;
    }
    sources_.push_back(std::move(source));
    packets_.push_back(0);
    keep();
    Q_EMIT changed();
}

void InputDeck::remove(std::size_t index) {
    setOn(index, false);
    sources_.erase(sources_.begin() + std::ptrdiff_t(index));
    packets_.erase(packets_.begin() + std::ptrdiff_t(index));
    keep();
    Q_EMIT changed();
}

void InputDeck::closePorts() {
    stopLearning();
    for (std::size_t i = 0; i < sources_.size(); ++i)
        if (!isOfDevices(sources_[i].protocol)) setOn(i, false);
}

// ---- performing ----------------------------------------------------------------------------------------------------------

InputDeck::Waits InputDeck::waits() const { return waits_ != Waits::No ? waits_ : takeShown_ ? Waits::Take : feed_ ? Waits::No : Waits::NoCharacter; }

void InputDeck::followSoon() {
    if (std::exchange(scheduled_, true)) return;
    QMetaObject::invokeMethod(this, &InputDeck::follow, Qt::QueuedConnection);
}

void InputDeck::follow() {
    scheduled_ = false;
    followDevices();
    const bool had = feed_ != nullptr;
    // What was performed becomes the document's, which the new feed begins from.
    if (had) document_.performInputs(nullptr);
    const std::shared_ptr<InputFeed> before = std::exchange(feed_, nullptr);
    meters_.clear();
    std::vector<std::string> names;
    if (listens() && !deck_.shown() && document_.session().character()) {
        std::vector<std::string> osc;
        for (const Source& source : sources_)
            if (source.open && source.protocol == InputProtocol::Osc) osc.push_back(source.name);
        feed_ = std::make_shared<InputFeed>(InputDriver(document_.document(), document_.session().plan(), osc, speaks_ ? std::span(&kWindow, 1) : std::span<const std::string>(), before ? &before->driver() : nullptr));
        names = nameMessages(document_.document());
        document_.performInputs(feed_);
    }
    thread_.feed(feed_, std::move(names));
    thread_.hold(waits_ != Waits::No);
    std::vector<InputRow> rows;
    std::vector<MappedTarget> happens;
    for (auto& [row, target] : triggerRows(document_.document(), triggers_)) {
        rows.push_back(std::move(row));
        happens.push_back(target);
    }
    thread_.triggers(std::move(rows), [this, happens = std::move(happens)](std::size_t row) { QMetaObject::invokeMethod(this, [this, what = happens[row]] { happen(what); }, Qt::QueuedConnection); });
    if (listens() != timer_.isActive()) listens() ? timer_.start() : timer_.stop();
    if (had != (feed_ != nullptr)) Q_EMIT changed();
}

void InputDeck::happen(const MappedTarget& what) {
    switch (what.kind) {
        case MappedTarget::Kind::LetGo: return letGo();
        case MappedTarget::Kind::PlayTake:
            if (deck_.recording() || !document_.document().takes.contains(what.take)) return;
            deck_.choose(what.take);
            deck_.show(deck_.from());
            return deck_.setPlaying(true);
        case MappedTarget::Kind::StopTake:
            if (deck_.shown() && deck_.take() && deck_.take()->id == what.take) deck_.leave();
            return;
        default: return;
    }
}

void InputDeck::takeMeters() {
    if (feed_ && feed_->takeMeters()) meters_ = feed_->meters();
    if (triggers_.empty()) return;
    const auto& rows = document_.document().mappings;
    meters_.resize(rows ? rows->size() : 0);
    const auto happened = thread_.triggerMeters();
    for (std::size_t i = 0; i < triggers_.size() && i < happened.size(); ++i)
        if (triggers_[i] < meters_.size()) meters_[triggers_[i]] = happened[i];
}

void InputDeck::takeHold() {
    if (!feed_ || waits_ != Waits::No || !document_.session().inputsWait() || document_.inGesture()) return;
    // Whoever takes back what inputs hold does not want it held again at once.
    if (!holdsAnyway_ && canRedo()) return wait(Waits::Undone);
    holdsAnyway_ = false;
    if (!document_.holdInputs()) wait(Waits::Refused);
}

void InputDeck::wait(Waits why) {
    waits_ = why;
    thread_.hold(why != Waits::No);
    // What moves nothing runs nothing either: goOn() makes a new feed.
    if (why == Waits::Undone || why == Waits::Refused) {
        document_.performInputs(nullptr);
        feed_.reset();
        for (auto& [cycle, faders] : faders_) {
            faders.amount = 0.0;
            sayFaders(cycle, faders);
        }
    }
    Q_EMIT changed();
}

void InputDeck::letGo() {
    stopLearning();
    if (!listens()) return;
    faders_.clear();
    thread_.forget(kWindow);
    wait(Waits::LetGo);  // first: nothing more is given
    letGoAt_ = document_.session().position();
    if (feed_) feed_->letGo();
    else if (!takeShown_ && !document_.inGesture()) (void)document_.releaseInputs();
}

bool InputDeck::canRedo() const {
    const Session& session = document_.session();
    return session.position() < int(session.steps().size());
}

InputDeck::CycleFaders InputDeck::cycleFaders(const std::string& cycle) const {
    const auto known = faders_.find(cycle);
    return known == faders_.end() ? CycleFaders() : known->second;
}

void InputDeck::playCycle(const std::string& cycle, const CycleFaders& to) {
    faders_.insert_or_assign(cycle, to);
    if (!speaks_ && to.amount == 0.0) return;
    // Who draws a fader up wants to see it move.
    if (to.amount != 0.0) {
        holdsAnyway_ = true;
        if (waits_ != Waits::No || takeShown_) goOn();
    }
    if (!std::exchange(speaks_, true)) {
        follow();
        Q_EMIT changed();
    }
    sayFaders(cycle, to);
}

void InputDeck::sayFaders(const std::string& cycle, const CycleFaders& faders) {
    for (const auto& [number, value] : {std::pair("/speed", faders.speed), std::pair("/amount", faders.amount)}) {
        InputValue said;
        said.source = InputName(kWindow);
        said.channel = InputName("/imomushi/cycle/" + cycle + number);
        said.numbers[0] = value;
        said.count = 1;
        thread_.say(said);
    }
}

void InputDeck::dropFaders() {
    const std::size_t gone = std::erase_if(faders_, [this](const auto& fader) { return !cycleNamed(document_.document(), fader.first); });
    if (gone == 0) return;
    thread_.forget(kWindow);
    for (const auto& [cycle, faders] : faders_) sayFaders(cycle, faders);
    speaks_ = !faders_.empty();
}

void InputDeck::goOn() {
    // What was let go meanwhile was not given: a new feed begins from what controls say now.
    holdsAnyway_ = true;
    wait(Waits::No);
    if (deck_.shown() && !deck_.recording()) deck_.leave();
    if (!feed_) follow();
}

void InputDeck::tell() {
    takeMeters();
    takeHold();  // a gesture may have been in the way when the last step was made
    // What was taken back may be done again, unless all inputs were stopped since.
    if (feed_ && !document_.inGesture() && (letGoAt_ == document_.session().position() || !canRedo()) && document_.inputsLeft() && document_.releaseInputs()) follow();
    const bool rate = !rated_.isValid() || rated_.elapsed() >= kRateMs;
    const double seconds = rated_.isValid() ? 1e-3 * double(rated_.elapsed()) : 1.0;
    if (rate) rated_.start();
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        const auto heard = thread_.heard(sources_[i].name);
        if (!heard) continue;
        sources_[i].heard = *heard;
        if (!rate) continue;
        sources_[i].perSecond = double(heard->counts.packets - std::min(packets_[i], heard->counts.packets)) / seconds;
        packets_[i] = heard->counts.packets;
    }
    if (learning()) {
        candidate_ = thread_.learned();
        if (candidate_ && candidate_->settled) takeCandidate();
    }
    Q_EMIT told();
}

}  // namespace imomushi
