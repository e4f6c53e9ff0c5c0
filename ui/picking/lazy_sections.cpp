// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/picking/lazy_sections.h"

#include <QCoreApplication>
#include <QThreadPool>
#include <chrono>
#include <utility>

namespace imomushi {
namespace {

/// Those of bodies with at most so many vertices are made while the pointer waits: 8 ms.
constexpr Eigen::Index kAtOnce = 20'000;

}  // namespace

std::shared_ptr<const SectionFinder> LazySections::of(const std::shared_ptr<const void>& owner, const TriangleMesh& body, bool wait) {
    if (owner_ != owner) {
        owner_ = owner;
        std::packaged_task<std::shared_ptr<const SectionFinder>()> make([owner, &body] { return std::make_shared<const SectionFinder>(owner, body); });
        made_ = make.get_future().share();
        if (body.vertices.rows() <= kAtOnce) {
            make();
        } else {
            auto beside = std::make_shared<decltype(make)>(std::move(make));
            QThreadPool::globalInstance()->start([beside, ready = std::weak_ptr(ready_)] {
                (*beside)();
                QMetaObject::invokeMethod(
                    QCoreApplication::instance(),
                    [ready] {
                        if (const auto alive = ready.lock()) (*alive)();
                    },
                    Qt::QueuedConnection);
            });
        }
    }
    if (!wait && made_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return nullptr;
    return made_.get();
}

}  // namespace imomushi
