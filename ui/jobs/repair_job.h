// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "core/document/character_repair.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// A body that was made of a render model before a command asked for it.
struct MadeBody {
    BodySetting setting;
    Points vertices;  ///< of the model
    Triangles triangles;
    Body body;
    [[nodiscard]] bool isOf(const RenderModel& model, const BodySetting& asked) const;
};

/// Does the slow work of a command "repair" in the background: makes the bodies that it will ask for.
class RepairJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(const Document& document, const Json& repair);
    /// Of the last completed run.
    [[nodiscard]] const std::vector<MadeBody>& bodies() const { return *bodies_; }

private:
    std::shared_ptr<std::vector<MadeBody>> bodies_ = std::make_shared<std::vector<MadeBody>>();
};

}  // namespace imomushi
