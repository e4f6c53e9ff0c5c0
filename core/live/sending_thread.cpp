// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/sending_thread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/live/live_character.h"

namespace imomushi {

namespace {

constexpr std::chrono::seconds kAgain(1);

}  // namespace

void SendingThread::add(int key, OutputProtocol protocol, UdpTarget target) {
    stop();
    targets_.push_back({key, protocol, std::move(target), std::nullopt, {}});
    run();
}

void SendingThread::remove(int key) {
    stop();
    std::erase_if(targets_, [&](const Target& target) { return target.key == key; });
    run();
}

std::optional<SendingThread::Sent> SendingThread::sent(int key) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(targets_, key, &Target::key);
    return found == targets_.end() ? std::nullopt : std::optional(found->sent);
}

void SendingThread::follow(const Document& document, const CharacterPlan& plan) {
    const std::lock_guard lock(mutex_);
    for (Target& target : targets_) target.sent.bones = target.writer.emplace(target.protocol, document, plan).bones();
    ++followed_;
}

void SendingThread::pause() {
    const std::lock_guard lock(mutex_);
    for (Target& target : targets_) target.writer.reset();
    ++followed_;
}

void SendingThread::give(const LiveCharacter& live) {
    showFrame(live, frames_.back().frame);
    frames_.back().of = followed_;
    frames_.publish();
    given_.release();
}

void SendingThread::run() {
    if (targets_.empty()) return;
    over_ = false;
    thread_ = std::thread([this] { serve(); });
}

void SendingThread::stop() {
    if (!thread_.joinable()) return;
    over_ = true;
    given_.release();
    thread_.join();
}

void SendingThread::serve() {
    while (!over_) {
        (void)given_.try_acquire_for(kAgain);
        while (given_.try_acquire()) {}  // the latest frame counts
        (void)frames_.take();
        const Given& given = frames_.front();
        const std::lock_guard lock(mutex_);
        if (over_ || given.of != followed_ || given.of == 0) continue;
        const double time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        for (Target& target : targets_) {
            if (!target.writer) continue;
            ++target.sent.frames;
            target.writer->write(given.frame, time, [&](std::span<const std::byte> packet) {
                ++target.sent.packets;
                if (!target.to.send(packet)) ++target.sent.lost;
            });
        }
    }
}

}  // namespace imomushi
