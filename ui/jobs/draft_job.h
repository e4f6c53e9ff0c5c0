// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Makes elements soft soon after their handles changed: solved on a coarse body in the background (some seconds: strips and bubbles make its 400 vertices five times as
/// many nodes). The answer is used, as one that is out of date, until the element is precomputed as its settings say. Elements larger than kLargest wait for that.
class DraftJob : public BackgroundJob {
    Q_OBJECT
public:
    explicit DraftJob(StudioDocument& document, QObject* parent = nullptr);

    /// Vertices of the decimated body, and of the body up to which one is made.
    static constexpr int kVertices = 400, kLargest = 100'000;

signals:
    /// All elements whose handles changed have a draft, or cannot have one.
    void drafted();

private:
    struct Work;
    void follow(const DocumentChange& change);
    void next();

    StudioDocument& document_;
    std::vector<PartId> waiting_;
    std::shared_ptr<Work> work_;
};

}  // namespace imomushi
