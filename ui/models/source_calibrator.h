// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>
#include <optional>
#include <string>
#include <vector>

#include "core/live/calibrated_rows.h"
#include "ui/models/input_deck.h"

namespace imomushi {

/// Calibrates a source in a pose: counts down, so that who performs can go and take it, and measures what the source says for a moment, whether inputs move something or wait.
class SourceCalibrator : public QObject {
    Q_OBJECT
public:
    static constexpr int kCountdownMs = 3000, kMeasureMs = 500;
    enum class State { Idle, Counting, Measuring };

    SourceCalibrator(StudioDocument& document, InputDeck& inputs, QObject* parent = nullptr);

    /// `pose`: a kept one; empty: rest.
    void begin(const std::string& source, const std::string& pose);
    void cancel();
    [[nodiscard]] State state() const { return state_; }
    [[nodiscard]] int secondsLeft() const { return secondsLeft_; }
    [[nodiscard]] const std::string& source() const { return source_; }
    [[nodiscard]] const std::string& pose() const { return pose_; }
    /// Why the last one came to nothing; empty: it did not.
    [[nodiscard]] const QString& trouble() const { return trouble_; }
    void forgetTrouble() { trouble_.clear(); }
    /// The source is heard, and something that it drives has a place in a pose.
    [[nodiscard]] bool canCalibrate(const InputDeck::Source& source) const;
    /// The poses that a source is calibrated in, with what is left.
    [[nodiscard]] std::vector<CalibratedRows::OfPose> posesOf(const std::string& source) const;
    void clear(const std::string& source, const std::string& pose);
    /// ms, from begin() until it measures.
    void setCountdown(int ms) { countdown_ = ms; }

Q_SIGNALS:
    void changed();  ///< the state, seconds that are left, or what is calibrated

private:
    void tick();
    void measure();
    void finish();
    void stop();

    StudioDocument& document_;
    InputDeck& inputs_;
    State state_ = State::Idle;
    std::string source_, pose_;
    QString trouble_;
    int countdown_ = kCountdownMs, secondsLeft_ = 0;
    QElapsedTimer since_;
    QTimer timer_;
    mutable std::optional<CalibratedRows> rows_;  // none: not asked for since the document changed
};

/// "1.2°, 14 mm, 3 %": of the kinds that there are.
QString residualText(const CalibrationResidual& residual);
/// Of several poses the most of each.
CalibrationResidual mostOf(const std::vector<CalibratedRows::OfPose>& poses);
/// For people.
QString poseText(const std::string& pose);

}  // namespace imomushi
