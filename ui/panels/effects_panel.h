// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QScrollArea>
#include <QTimer>
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "ui/jobs/watch_job.h"
#include "ui/models/gesture.h"
#include "ui/models/studio_document.h"
#include "ui/widgets/number_field.h"

class QGridLayout;
class QLabel;
class QPushButton;
class QVBoxLayout;

namespace imomushi {

class FigureLabel;
class Switch;

/// What the scene asks for beyond the static pose: one row per effect with its switch and its price, predicted while it is off and measured while frames
/// pass; settings of what is on.
class EffectsPanel : public QScrollArea {
    Q_OBJECT
public:
    explicit EffectsPanel(StudioDocument& document, QWidget* parent = nullptr);
    ~EffectsPanel() override;
    /// Brings the row of an effect into sight.
    void reveal(EffectKind effect);
    /// Another project: what was offered or dismissed was so for the last one.
    void forgetOffers();
    /// What effects cost, on or off now.
    void setCosts(const std::array<EffectCost, kEffects>& costs);

signals:
    void precomputeWanted();
    void copyWanted(const std::vector<imomushi::EffectKind>& effects);  ///< their settings
    void pasteWanted();

protected:
    void changeEvent(QEvent* event) override;
    void contextMenuEvent(QContextMenuEvent* event) override;
    void showEvent(QShowEvent* event) override;
    void hideEvent(QHideEvent* event) override;
    bool event(QEvent* event) override;

private:
    struct Row {
        Switch* button = nullptr;
        FigureLabel* price = nullptr;
        QWidget* needs = nullptr;      ///< the line that says that a precompute is needed
        QLabel* needsText = nullptr;
        QPushButton* precompute = nullptr;  ///< the same line, to be clicked
        QVBoxLayout* layout = nullptr;
        QWidget* offer = nullptr;      ///< the line that says that it would mend the pose; null: no pose calls for such an effect
        QLabel* offerText = nullptr;
        QPushButton* take = nullptr;   ///< one click takes it
        QPushButton* compare = nullptr;  ///< while it is held, the pose is shown with the effect
        bool dismissed = false;
        bool open = false;             ///< frequencies and times are shown
        QWidget* settings = nullptr;   ///< null: off, or there are none
        std::vector<std::function<void()>> refreshers;
    };

    void rebuild();
    void refresh();        ///< takes over what the document says
    void showPrices();
    void buildOffer(EffectKind effect);
    void checkPose();      ///< offers what mends the pose that is shown
    void compare(EffectKind effect, bool on);
    void addAutomatic(Row& row, QGridLayout& grid, EffectKind effect);
    void buildSettings(EffectKind effect);
    void addNumber(Row& row, QGridLayout& grid, EffectKind effect, const EffectProperty& property, int part);
    void addElements(Row& row, QGridLayout& grid, EffectKind effect);
    void turn(EffectKind effect, bool on);
    [[nodiscard]] Row& row(EffectKind effect) { return rows_[std::size_t(effect)]; }

    StudioDocument& document_;
    std::array<Row, kEffects> rows_;
    std::array<EffectCost, kEffects> costs_;
    FigureLabel* sum_ = nullptr;
    std::unique_ptr<Gesture> gesture_, comparison_;
    QTimer tell_, check_;
    WatchJob watches_;
    QElapsedTimer stepped_;            ///< since the last frame
    bool scheduled_ = false, known_ = false;
};

}  // namespace imomushi
