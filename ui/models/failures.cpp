// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/failures.h"

#include <QAbstractEventDispatcher>
#include <new>
#include <utility>

namespace imomushi {
namespace {

QString textOf(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const std::bad_alloc&) {
        return Failures::tr("There is not enough memory to do or draw this. Your work is safe. Close other programs, or choose a coarser solver mesh.");
    } catch (const std::exception& e) {
        return Failures::tr("An error happened inside the program, and it gave up what it was doing: %1. Please report it.")
            .arg(QString::fromUtf8(e.what()));
    } catch (...) {
        return Failures::tr("An error happened inside the program, and it gave up what it was doing: %1. Please report it.").arg(QStringLiteral("?"));
    }
}

}  // namespace

Failures& Failures::instance() {
    static Failures failures;
    return failures;
}

void Failures::listen() {
    const auto* loop = QAbstractEventDispatcher::instance();
    connect(loop, &QAbstractEventDispatcher::awake, this, &Failures::say, Qt::UniqueConnection);
    connect(loop, &QAbstractEventDispatcher::aboutToBlock, this, &Failures::say, Qt::UniqueConnection);
}

void Failures::note(std::exception_ptr failure) noexcept {
    {
        const std::lock_guard lock(mutex_);
        noted_ = std::move(failure);
    }
    if (auto* loop = QAbstractEventDispatcher::instance(thread())) loop->wakeUp();
}

void Failures::say() {
    std::exception_ptr failure;
    {
        const std::lock_guard lock(mutex_);
        failure = std::exchange(noted_, nullptr);
    }
    if (!failure) return;
    try {
        Q_EMIT failed(textOf(failure));
    } catch (const std::exception&) {  // the loop turns again, and then there may be memory for saying it
        const std::lock_guard lock(mutex_);
        if (!noted_) noted_ = std::move(failure);
    }
}

}  // namespace imomushi
