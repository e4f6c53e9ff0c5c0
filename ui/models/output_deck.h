// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QTimer>
#include <string>
#include <vector>

#include "core/live/sending_thread.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Sends the performance to other programs: avatars and show controllers that listen. Whom is kept for the next time; nobody is sent anything until the artist switches it on.
class OutputDeck : public QObject {
    Q_OBJECT
public:
    static constexpr std::size_t kMostReceivers = 16;
    static constexpr int kTellMs = 1000;

    struct Receiver {
        int key = 0;               ///< tells them apart as long as the program runs
        OutputProtocol protocol = OutputProtocol::Vmc;
        std::string host = "127.0.0.1";
        int port = 0;
        bool on = false;
        QString trouble;           ///< why it could not be switched on; empty: it could
        SendingThread::Sent sent;
        std::uint64_t frames = 0, lost = 0;  ///< frames, and packets that nobody took, in the last second
    };

    explicit OutputDeck(StudioDocument& document, QObject* parent = nullptr);
    ~OutputDeck() override;

    [[nodiscard]] const std::vector<Receiver>& receivers() const { return receivers_; }
    void setOn(std::size_t receiver, bool on);
    // One that is on is sent to anew. Errors of an address are its trouble.
    void setHost(std::size_t receiver, const std::string& host);
    void setPort(std::size_t receiver, int port);
    /// One more, on this machine, at the port where such programs listen.
    void add(OutputProtocol protocol);
    void remove(std::size_t receiver);

Q_SIGNALS:
    void changed();  ///< receivers
    void told();     ///< what was sent; only while something is sent

private:
    void load();
    void keep() const;
    void open(Receiver& receiver);
    void follow();
    void followSoon();
    void tell();

    StudioDocument& document_;
    std::vector<Receiver> receivers_;
    SendingThread thread_;
    int keys_ = 0;
    bool paused_ = false;          // the character could not be built
    bool scheduled_ = false;
    QTimer timer_;
};

}  // namespace imomushi
