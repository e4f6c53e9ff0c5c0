// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QRgb>

#include "ui/models/studio_document.h"

namespace imomushi {

/// The colour of recording, in the view and in panels; white on it has a contrast of 4.6 : 1.
inline constexpr QRgb kRecordRed = 0xffd8383e;

/// What records takes and plays one of them. The view steps its frames: advance() while playing().
class TakeDeck : public QObject {
    Q_OBJECT
public:
    explicit TakeDeck(StudioDocument& document, QObject* parent = nullptr);

    /// The take that is chosen, null: none. Valid until the document changes.
    [[nodiscard]] const Take* take() const;
    /// Chooses a take and shows its beginning; 0: none.
    void choose(PartId take);
    [[nodiscard]] double time() const { return time_; }  ///< s, of the chosen take
    [[nodiscard]] int frame() const;                     ///< at time(), from 0
    /// The chosen take is what is seen.
    [[nodiscard]] bool shown() const { return shown_; }
    /// The shown take has what effects added; false: its poses alone, as the character has changed.
    [[nodiscard]] bool exact() const { return exact_; }
    /// Shows the chosen take at a time (s), and does not play on.
    void show(double time);
    /// Frames later (or earlier), and does not play on.
    void step(int frames);
    /// Back to the character as it is posed.
    void leave();

    [[nodiscard]] bool playing() const { return playing_; }
    /// From time() on, from the beginning where that is the end.
    void setPlaying(bool playing);
    [[nodiscard]] bool looping() const { return looping_; }
    void setLooping(bool looping);
    /// One frame of playing, so many seconds later.
    void advance(double seconds);

    [[nodiscard]] bool canRecord() const;
    [[nodiscard]] bool recording() const { return recording_; }
    /// Into a new take with a name of its own.
    void startRecording();
    /// The take becomes the chosen one. Nothing where nothing is recorded.
    void stopRecording();

Q_SIGNALS:
    void changed();  ///< the chosen take, its time, playing or recording
    void said(const QString& text);  ///< worth a line: one translated sentence

private:
    bool play(double time);
    void follow();

    StudioDocument& document_;
    PartId take_ = 0;
    double time_ = 0.0;
    bool shown_ = false, exact_ = true, playing_ = false, looping_ = false, recording_ = false;
    bool acting_ = false;           ///< what the document says now was done here
    std::size_t recorded_ = 0;      ///< frames
};

}  // namespace imomushi
