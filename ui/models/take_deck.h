// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QRgb>
#include <QTimer>

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

    /// Between which times (s) the chosen take is played, and what trim() keeps of it: at first all.
    [[nodiscard]] double from() const { return from_; }
    [[nodiscard]] double to() const { return to_; }
    [[nodiscard]] bool marked() const { return from_ > 0.0 || to_ < length_; }  ///< that is not the whole take
    /// Sets the span to the frames nearest to these times (s). The end that changes stays at least one frame away from the other.
    void setSpan(double from, double to);
    void trim();
    /// Under a name of its own; the copy becomes the chosen take.
    void duplicate();
    void remove();

    [[nodiscard]] bool playing() const { return playing_; }
    /// From time() on, from from() where that is the end or outside.
    void setPlaying(bool playing);
    [[nodiscard]] bool looping() const { return looping_; }
    void setLooping(bool looping);
    /// One frame of playing, so many seconds later.
    void advance(double seconds);

    [[nodiscard]] bool canRecord() const;
    [[nodiscard]] bool recording() const { return recording_; }
    /// Into a new take with a name of its own, after the count where there is one.
    void startRecording();
    /// The take becomes the chosen one; a count that is going on is given up. Nothing where nothing is recorded.
    void stopRecording();
    /// Recording starts after three seconds.
    [[nodiscard]] bool countsIn() const { return countsIn_; }
    void setCountsIn(bool counts);
    [[nodiscard]] int counting() const { return counting_; }  ///< s left; 0: no count is going on

Q_SIGNALS:
    void changed();  ///< the chosen take, its time, playing or recording
    /// A take is there now, of so many seconds.
    void recorded(const QString& take, double seconds);
    void said(const QString& text);  ///< worth a line: one translated sentence

private:
    bool play(double time);
    void follow();
    void forgetSpan();
    void beginRecording();

    StudioDocument& document_;
    PartId take_ = 0;
    double time_ = 0.0, from_ = 0.0, to_ = 0.0;
    double length_ = 0.0;  // s, of the chosen take when it was last looked at
    QTimer count_;
    int counting_ = 0;
    bool countsIn_ = false;
    bool shown_ = false, exact_ = true, playing_ = false, looping_ = false, recording_ = false;
    bool acting_ = false;           ///< what the document says now was done here
};

}  // namespace imomushi
