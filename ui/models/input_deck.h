// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/document/input_mapping.h"
#include "core/input/devices.h"
#include "core/input/key_port.h"
#include "core/live/hearing_thread.h"
#include "ui/models/studio_document.h"
#include "ui/models/take_deck.h"

class QFileSystemWatcher;

namespace imomushi {

/// Performs the character by what devices and other programs say: who is listened to, the way of values into the performance, and learning which control drives what. Ports are open only while
/// a source is switched on, for programs of this machine alone unless the artist opens one to the network. A device of a source that is switched on is open only while a row of the document
/// maps that source, or while somebody learns.
class InputDeck : public QObject {
    Q_OBJECT
public:
    /// Meters and counts are told so often: 25 times a second.
    static constexpr int kTellMs = 40;
    static constexpr std::size_t kMostSources = 16;

    /// Somebody who may send, or a device. Who they are is kept for the next time; only devices are switched on then.
    struct Source {
        std::string name;          ///< as mappings call it
        InputProtocol protocol = InputProtocol::Osc;
        int port = 0;
        bool network = false;      ///< other machines may send, too
        std::string device;        ///< of a source of devices: as openDevice() takes it
        bool on = false;
        bool open = false;         ///< its port, or its device
        QString trouble;           ///< why it could not be switched on; empty: it could
        HearingThread::Heard heard;
        double perSecond = 0.0;    ///< packets, over the last second
    };
    /// Why inputs move nothing, though somebody is listened to.
    enum class Waits { No, LetGo, Undone, Refused, Take, NoCharacter };

    InputDeck(StudioDocument& document, TakeDeck& deck, QObject* parent = nullptr);
    ~InputDeck() override;

    [[nodiscard]] const std::vector<Source>& sources() const { return sources_; }
    /// Somebody may move something: a port or a device is open, or the window plays cycles itself.
    [[nodiscard]] bool listens() const { return hears() || speaks_; }
    [[nodiscard]] bool hears() const { return thread_.hears(); }
    /// Opens or closes its port, or lets its device be heard or not.
    void setOn(std::size_t source, bool on);
    /// What is named by a row of the document's table.
    [[nodiscard]] bool isMapped(const std::string& source) const;
    /// See HearingThread: while inputs wait, too.
    void measure(const std::string& source) { thread_.measure(source); }
    [[nodiscard]] std::optional<SourceMeasure> measured() const { return thread_.measured(); }
    // A source that is on is opened anew.
    void setPort(std::size_t source, int port);
    void setNetwork(std::size_t source, bool network);
    void setDevice(std::size_t source, const std::string& device);
    /// One more, under a name of its own.
    void add(InputProtocol protocol);
    void remove(std::size_t source);
    /// Devices stay open where rows name them.
    void closePorts();
    /// Devices that were there when somebody looked last. From the first look on, what is plugged in and out is seen by itself.
    [[nodiscard]] const std::vector<PluggedDevice>& devices(InputProtocol protocol) const { return devices_[std::size_t(protocol)]; }
    void lookForDevices();
    /// Somebody is listened to, or a device that may be heard is plugged in; the keyboard is not asked for.
    [[nodiscard]] bool anythingPlugged() const;
    /// The same, or the keyboard may be heard.
    [[nodiscard]] bool canLearn() const;
    /// A key of the keyboard (isKeyName()) drives something, or may be learned: it is to be given to KeyBoard::say(), and does nothing else.
    [[nodiscard]] bool wantsKey(std::string_view key) const;
    /// A row that is heard and no trigger has this key, whether inputs wait or not.
    [[nodiscard]] bool drivesByKey(std::string_view key) const;

    [[nodiscard]] Waits waits() const;
    /// Everything that inputs move glides to rest, and they move nothing more until goOn(). For panic.
    void letGo();
    void goOn();

    /// Faders of a cycle: how much there is of it, 0 ... 1, and how fast it runs, 1 as it was made.
    struct CycleFaders {
        double amount = 0.0, speed = 1.0;
    };
    /// Plays a cycle as a controller would, from the window itself; rows of the document's table win over it. A cycle that no fader plays is at rest.
    void playCycle(const std::string& cycle, const CycleFaders& to);
    [[nodiscard]] CycleFaders cycleFaders(const std::string& cycle) const;

    /// Of each row of the document's table; empty: inputs do not perform.
    [[nodiscard]] const std::vector<InputMeter>& meters() const { return meters_; }

    /// Looks for the control that moves, for a row that drives `target`; the row is made when that is clear.
    void learn(const std::string& target);
    void stopLearning();
    [[nodiscard]] bool learning() const { return !target_.empty(); }
    [[nodiscard]] const std::string& learnedTarget() const { return target_; }
    /// What has moved farthest so far.
    [[nodiscard]] const std::optional<ControlLearner::Found>& candidate() const { return candidate_; }
    /// Makes the row of the candidate at once.
    void takeCandidate();

Q_SIGNALS:
    void changed();   ///< sources, whether inputs move something, or whether somebody learns
    void told();      ///< meters, counts of sources or the candidate; only while somebody is listened to
    void learned(int row);  ///< of the document's table

private:
    void load();
    void keep() const;
    void open(Source& source);
    /// Opens and closes devices as rows and learning want it.
    void followDevices();
    [[nodiscard]] bool wantsDevice(const Source& source) const;
    void close(Source& source);
    /// Gives the performance a feed for the document as it is, or takes it away where nothing is to be performed.
    void follow();
    void followSoon();
    void takeHold();
    void tell();
    void wait(Waits why);
    [[nodiscard]] bool canRedo() const;
    /// A row of an open keyboard has this key, or the stick that it belongs to, and `acts`.
    [[nodiscard]] bool hasKey(std::string_view key, const std::function<bool(const InputMapping&)>& acts) const;
    /// A row let it happen.
    void happen(const MappedTarget& what);
    void sayFaders(const std::string& cycle, const CycleFaders& faders);
    /// Of cycles that are not there any more.
    void dropFaders();
    /// Of rows of the feed, and of those that let something happen.
    void takeMeters();

    StudioDocument& document_;
    TakeDeck& deck_;
    std::vector<Source> sources_;
    std::vector<std::uint64_t> packets_;  // of each source when rates were taken last
    std::array<std::vector<PluggedDevice>, kInputProtocols> devices_;  // by protocol
    QFileSystemWatcher* watcher_ = nullptr;  // from the first look on
    QTimer lookSoon_;
    KeyBoard keyboard_;
    HearingThread thread_;
    std::shared_ptr<InputFeed> feed_;
    std::vector<InputMeter> meters_;
    std::vector<std::size_t> triggers_;   // places in the document's table of rows that let something happen
    Waits waits_ = Waits::No;       // LetGo, Undone, Refused or No
    std::optional<int> letGoAt_;  // the position in the history where all inputs were stopped last
    bool holdsAnyway_ = false;      // the artist went on after undoing
    bool takeShown_ = false, scheduled_ = false;
    bool speaks_ = false;           // the window plays cycles, or did
    std::map<std::string, CycleFaders> faders_;  // by cycle, as they were left
    std::string target_;
    std::optional<ControlLearner::Found> candidate_;
    QTimer timer_;
    QElapsedTimer rated_;
};

}  // namespace imomushi
