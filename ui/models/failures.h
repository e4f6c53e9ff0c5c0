// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>
#include <exception>
#include <mutex>

namespace imomushi {

/// Hears of work that ended by an exception: no memory, or a fault of the program. Jobs in the background, tasks of the thread pool, events of the window and pictures of the
/// view all end here: what they were doing is left out, and the studio goes on with what it had.
class Failures : public QObject {
    Q_OBJECT
public:
    /// Of the program. Made by the first who asks, on the GUI thread.
    static Failures& instance();
    /// What is noted is said whenever the event loop of this thread turns.
    void listen();
    /// Any thread; asks for no memory.
    void note(std::exception_ptr failure) noexcept;
    /// What was noted is said now. On the GUI thread.
    void say();

signals:
    void failed(const QString& why);  ///< a sentence or two, translated

private:
    std::mutex mutex_;
    std::exception_ptr noted_;  // the last one
};

/// Does the work; false: it ended by an exception, which is noted.
template <class Work>
bool attempt(Work&& work) {
    try {
        work();
        return true;
    } catch (const std::exception&) {
        Failures::instance().note(std::current_exception());
        return false;
    }
}

}  // namespace imomushi
