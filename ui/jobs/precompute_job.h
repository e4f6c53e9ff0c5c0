// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <vector>

#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// What precomputing all elements that are not fresh would cost on this machine.
struct PrecomputeEstimate {
    int elements = 0;
    double seconds = 0.0;
    double bytes = 0.0;
};

/// Precomputes the elements that are not fresh in the background, from copies of what they depend on. The document stays usable; results of elements that
/// were changed meanwhile are kept in the cache but leave the element out of date.
class PrecomputeJob : public BackgroundJob {
    Q_OBJECT
public:
    explicit PrecomputeJob(StudioDocument& document, QObject* parent = nullptr);

    [[nodiscard]] PrecomputeEstimate estimate() const;
    /// False: nothing to do.
    bool start();
    /// The element that is being computed.
    [[nodiscard]] QString element() const;

signals:
    /// A completed run could not do this element.
    void elementFailed(const QString& element, const QString& message);

private:
    struct Item;
    struct Work;
    StudioDocument& document_;
    std::shared_ptr<Work> work_;
};

}  // namespace imomushi
