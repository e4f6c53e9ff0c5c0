// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Makes elements soft soon after a change: each that has joint faces or handles, and no response that fits it, is solved on the solver mesh "draft" in the background, in a
/// fraction of a second, one on each processor. An element whose response lacks patches alone, as where flesh meets, takes the draft's patches. A draft counts as out of date until the element is precomputed as its settings say. Elements of more than kLargest
/// vertices wait for that.
class DraftJob : public BackgroundJob {
    Q_OBJECT
public:
    explicit DraftJob(StudioDocument& document, QObject* parent = nullptr);

    static constexpr int kLargest = 100'000;

    /// While it is off, elements are soft when they are precomputed.
    void setEnabled(bool on);
    [[nodiscard]] bool enabled() const { return enabled_; }
    /// The element has no response that fits, and gets one.
    [[nodiscard]] bool awaits(PartId element) const { return enabled_ && wants(element); }

signals:
    /// There are elements to make soft.
    void drafting();
    /// All elements have a response that fits, or cannot have one.
    void drafted();

private:
    struct Work;
    void follow();
    [[nodiscard]] bool wants(PartId element) const;
    /// Begins with those that wait now.
    void start();
    /// Uses what is done by now, where the element still asks for it.
    void takeDone() override;
    /// Responses of inputOfDraft().
    void bring(const std::vector<std::pair<PartId, StoredResponse>>& responses);

    StudioDocument& document_;
    std::set<ContentKey> failed_;
    std::shared_ptr<Work> work_;
    QTimer soon_;  // while changes follow each other, nothing is begun
    QElapsedTimer changed_;  // the last time
    bool draftingTold_ = false;      // drafting(), and not drafted() since
    bool enabled_ = true;
};

}  // namespace imomushi
