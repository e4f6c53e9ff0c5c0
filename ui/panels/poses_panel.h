// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QHash>
#include <QImage>
#include <QWidget>
#include <memory>

#include "ui/models/gesture.h"
#include "ui/models/studio_document.h"

class QBoxLayout;
class QLabel;
class QListWidget;
class QSlider;
class QToolButton;

namespace imomushi {

class ActionSet;
class CyclesPanel;
class InputDeck;

/// The kept poses: a double click or Enter poses the character, the slider leads a part of the way there while it is dragged, in one undo step. They are renamed by F2 and
/// removed by Delete. Cycles through them stand beside the list, or below it where the panel is narrow.
class PosesPanel : public QWidget {
    Q_OBJECT
public:
    /// `actions`: "keep-pose", "mirror-pose", "rest-bones" and "rest-chain" do what they say; the panel shows them as buttons.
    PosesPanel(StudioDocument& document, InputDeck& inputs, ActionSet& actions, QWidget* parent = nullptr);
    [[nodiscard]] QListWidget* list() const { return list_; }
    [[nodiscard]] QSlider* blend() const { return blend_; }
    [[nodiscard]] CyclesPanel* cycles() const { return cycles_; }
    /// What a pose looks like; null: not known yet.
    void setPicture(const QString& pose, const QImage& picture);
    /// As narrow as the wider half: the other one goes below it.
    [[nodiscard]] QSize minimumSizeHint() const override;
    [[nodiscard]] QImage picture(const QString& pose) const { return pictures_.value(pose); }

signals:
    void seen(bool visible);  ///< pictures are wanted, or not any more

protected:
    void changeEvent(QEvent* event) override;
    void showEvent(QShowEvent* event) override;
    void hideEvent(QHideEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void follow();
    void takeSizes();
    void tellChosen();
    [[nodiscard]] QIcon iconOf(const QString& pose) const;
    void retranslate();
    void menu(const QPoint& global);
    [[nodiscard]] QString chosen() const;  ///< empty: none
    void apply(double share, bool mirrored);
    void blendTo(int percent);
    void endBlend(bool keep);

    StudioDocument& document_;
    QListWidget* list_;
    QLabel* empty_;
    QLabel* blendLabel_;
    QSlider* blend_;
    QBoxLayout* halves_;
    CyclesPanel* cycles_;
    std::vector<QToolButton*> buttons_;
    std::unique_ptr<Gesture> gesture_;  ///< of the blend
    QHash<QString, QImage> pictures_;
    bool following_ = false;
};

}  // namespace imomushi
