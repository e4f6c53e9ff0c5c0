// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <semaphore>
#include <thread>
#include <vector>

#include "core/base/triple_buffer.h"
#include "core/input/udp_target.h"
#include "core/live/frame_writer.h"

namespace imomushi {

/// Sends what a performance shows to other programs, on a thread of its own, for as long as there are targets. Frames that come faster than they are sent are left out; one that stays is sent again each second, so that receivers know that
/// somebody is there. All functions but give() are for one thread, that of the window.
class SendingThread {
public:
    /// What was sent to a target since it was added.
    struct Sent {
        std::uint64_t frames = 0, packets = 0;
        std::uint64_t lost = 0;  ///< packets that the system did not take
        std::size_t bones = 0;   ///< that each frame tells of
        bool operator==(const Sent&) const = default;
    };
    SendingThread() = default;
    ~SendingThread() { stop(); }
    SendingThread(const SendingThread&) = delete;
    SendingThread& operator=(const SendingThread&) = delete;

    /// `key`: tells targets apart.
    void add(int key, OutputProtocol protocol, UdpTarget target);
    void remove(int key);
    [[nodiscard]] bool sends() const { return !targets_.empty(); }
    [[nodiscard]] std::optional<Sent> sent(int key) const;
    /// Frames are of this document from now on, and of the character that its plan makes. What was given before is not sent.
    void follow(const Document& document, const CharacterPlan& plan);
    /// Nothing is sent until follow().
    void pause();

    /// On the thread that has the live character: it shows something else. Neither locks nor fails; takes memory only for the first frame of a character.
    void give(const LiveCharacter& live);

private:
    struct Target {
        int key = 0;
        OutputProtocol protocol = OutputProtocol::Vmc;
        UdpTarget to;
        std::optional<FrameWriter> writer;
        Sent sent;
    };
    struct Given {
        ShownFrame frame;
        std::uint64_t of = 0;  // followed_
    };
    void run();
    void stop();
    void serve();

    std::vector<Target> targets_;
    mutable std::mutex mutex_;  // targets_; who gives frames does not take it
    TripleBuffer<Given> frames_;
    std::atomic<std::uint64_t> followed_{0};
    std::counting_semaphore<> given_{0};
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::atomic<bool> over_{false};
    std::thread thread_;
};

}  // namespace imomushi
