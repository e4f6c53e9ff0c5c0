// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Precomputes the elements that are not fresh in the background, from copies of what they depend on. The document stays usable; results of elements that
/// were changed meanwhile are kept in the store but leave the element out of date. What is done when it is cancelled is kept.
class PrecomputeJob : public BackgroundJob {
    Q_OBJECT
public:
    explicit PrecomputeJob(StudioDocument& document, QObject* parent = nullptr);

    /// False: nothing to do.
    bool start();
    /// The element that is being computed.
    [[nodiscard]] QString element() const;
    /// How many elements the last run brought into the document.
    [[nodiscard]] int kept() const { return kept_; }

signals:
    /// This element could not be done.
    void elementFailed(const QString& element, const QString& message);

private:
    struct Item;
    struct Work;
    /// Takes what the items that are done came to into the document.
    void keep(const Work& work);
    StudioDocument& document_;
    std::shared_ptr<Work> work_;
    int kept_ = 0;
};

}  // namespace imomushi
