// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>

#include "ui/jobs/bones_job.h"
#include "ui/models/studio_document.h"

class QWidget;

namespace imomushi {

class FileFlow;
class StepFlow;
class TakeDeck;

/// What is done with the skeleton that a character's file brought: bones that stay are chosen, clips become takes.
class RigFlow : public QObject {
    Q_OBJECT
public:
    RigFlow(StudioDocument& document, FileFlow& files, StepFlow& steps, TakeDeck& deck, QWidget* window);
    [[nodiscard]] BonesJob& job() { return job_; }

    /// Asks which bones stay, and makes the character soft by them.
    void chooseBones(const CharacterSource& character);
    /// Asks for clips, and makes takes of them.
    void takeClips(const CharacterSource& character);

signals:
    void said(const QString& message);

private:
    void askBones();

    StudioDocument& document_;
    FileFlow& files_;
    StepFlow& steps_;
    TakeDeck& deck_;
    QWidget* window_;
    BonesJob job_;
};

}  // namespace imomushi
