// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QImage>
#include <QTimer>
#include <map>
#include <memory>
#include <string>

#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// A picture of each kept pose, drawn beside the window from a copy of the project: nothing of the document changes, and nothing is saved. What is drawn once stays until the pose or what is
/// posed changes.
class PosePictures : public BackgroundJob {
    Q_OBJECT
public:
    explicit PosePictures(StudioDocument& document, QObject* parent = nullptr);
    static constexpr int kWidth = 192, kHeight = 144;  ///< pixels
    /// Whether somebody sees them; nothing is drawn otherwise.
    void setWanted(bool wanted);

signals:
    void drawn(const QString& pose, const QImage& picture);

private:
    /// What is posed.
    struct Posed {
        std::map<PartId, std::shared_ptr<const Element>> elements;
        std::map<PartId, std::shared_ptr<const Bone>> bones;
        std::map<PartId, std::shared_ptr<const CharacterSource>> characters;
        bool operator==(const Posed&) const = default;
    };
    void follow();
    void tell();

    StudioDocument& document_;
    QTimer later_;
    Posed posed_;
    std::map<std::string, QImage> pictures_;  ///< by what a pose says but its name; null: it cannot be drawn
    bool wanted_ = false;
};

}  // namespace imomushi
