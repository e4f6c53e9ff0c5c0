// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/live_panel.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/models/commands.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kSourcesWidth = 256, kFormWidth = 312;

QFrame* wall(QWidget* parent) {
    auto* line = named(new QFrame(parent), "wall");
    line->setFixedWidth(1);
    return line;
}

}  // namespace

LivePanel::LivePanel(StudioDocument& document, InputDeck& inputs, OutputDeck& outputs, TakeDeck& deck, ActionSet& actions, QWidget* parent)
    : QWidget(parent), document_(document), inputs_(inputs), deck_(deck), actions_(actions) {
    usePanelBackground(this);
    model_ = new MappingModel(document, inputs, this);
    left_ = new QWidget(this);
    auto* ends = new QWidget(left_);
    auto* calibrator = new SourceCalibrator(document, inputs, this);
    sources_ = new SourceRows(inputs, *calibrator, ends);
    fill(new QVBoxLayout(ends), QMargins(0, 0, 0, 0), Spacing{0}, sources_, new ReceiverRows(outputs, ends), Stretch{});
    letGo_ = named(new QPushButton(left_), "letGo");
    letGo_->setIcon(themedIcon(QStringLiteral("let-go")));
    letGo_->setFocusPolicy(Qt::TabFocus);
    connect(letGo_, &QPushButton::clicked, actions["let-go"], &QAction::trigger);
    auto* scroll = new QScrollArea(left_);  // of these alone: what lets go is always seen
    scroll->setWidgetResizable(true);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setWidget(ends);
    usePanelBackground(ends);
    fill(new QVBoxLayout(left_), QMargins(0, 0, 0, 0), Spacing{8}, Share{scroll, 1}, letGo_);

    auto* middle = new QWidget(this);
    guide_ = named(new QLabel(middle), "guide");
    guide_->setWordWrap(true);
    goOn_ = named(new QPushButton(middle), "goOn");
    goOn_->setProperty("small", true);
    goOn_->setProperty("primary", true);
    connect(goOn_, &QPushButton::clicked, &inputs, &InputDeck::goOn);
    learn_ = new LearnBar(document, inputs, middle);
    view_ = named(new MappingView(*model_, middle), "mappings");
    const auto button = [&](const char* icon) {
        auto* b = new QToolButton(middle);
        b->setProperty("small", true);
        if (icon) b->setIcon(themedIcon(QLatin1String(icon)));
        b->setFocusPolicy(Qt::TabFocus);
        buttons_.push_back(b);
        return b;
    };
    up_ = named(button("up"), "mappingUp");
    down_ = named(button("down"), "mappingDown");
    remove_ = named(button("trash"), "mappingRemove");
    suggest_ = named(button("suggest"), "suggest");
    suggest_->setPopupMode(QToolButton::InstantPopup);
    auto* suggestions = new QMenu(suggest_);
    for (const char* action : {"suggest-keys", "suggest-pad", "suggest-vmc", "suggest-voice"}) suggestions->addAction(actions[action]);
    suggestions->addSeparator();
    suggestions->addAction(actions["move-by-itself"]);
    suggest_->setMenu(suggestions);
    auto *load = button(nullptr), *save = button(nullptr);
    load->setDefaultAction(actions["load-mappings"]);
    save->setDefaultAction(actions["save-mappings"]);
    connect(up_, &QToolButton::clicked, this, [this] { moveRow(-1); });
    connect(down_, &QToolButton::clicked, this, [this] { moveRow(1); });
    connect(remove_, &QToolButton::clicked, this, &LivePanel::removeRow);
    auto* top = fill(new QHBoxLayout, Spacing{2}, Share{guide_, 1}, Space{6}, goOn_, Space{6}, up_, down_, remove_, Space{6}, suggest_, load, save);
    auto* calibration = named(new CalibrationBar(document, inputs, *calibrator, middle), "calibration");
    connect(sources_, &SourceRows::calibrationWanted, calibration, &CalibrationBar::open);
    connect(calibration, &CalibrationBar::opened, learn_, &QWidget::setHidden);
    fill(new QVBoxLayout(middle), QMargins(0, 0, 0, 0), Spacing{6}, top, learn_, calibration, Share{view_, 1});

    right_ = new QWidget(this);
    form_ = new MappingForm(document, *model_, right_);
    fill(new QHBoxLayout(right_), QMargins(0, 0, 0, 0), Spacing{12}, wall(right_), Share{form_, 1});
    fill(new QHBoxLayout(this), QMargins(12, 8, 12, 8), Spacing{12}, left_, wall(this), Share{middle, 1}, right_);

    connect(view_, &MappingView::chosenChanged, this, &LivePanel::followRow);
    connect(view_, &MappingView::removeWanted, this, &LivePanel::removeRow);
    connect(view_, &MappingView::moveWanted, this, &LivePanel::moveRow);
    connect(model_, &QAbstractItemModel::modelReset, this, [this] {
        view_->choose(model_->rowOf(chosen_));
        followRow();
        follow();
    });
    connect(&inputs, &InputDeck::learned, view_, &MappingView::choose);
    connect(&inputs, &InputDeck::changed, this, &LivePanel::follow);
    connect(&inputs, &InputDeck::told, this, &LivePanel::follow);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.unknown) view_->choose(-1);  // another project
        follow();
    });
    connect(&deck, &TakeDeck::changed, this, &LivePanel::follow);
    connect(actions["record"], &QAction::changed, this, &LivePanel::follow);
    connect(&Appearance::instance(), &Appearance::changed, this, &LivePanel::takeSizes);
    takeSizes();
    retranslate();
}

void LivePanel::takeSizes() {
    left_->setFixedWidth(px(kSourcesWidth));
    right_->setFixedWidth(px(kFormWidth));
    letGo_->setIconSize(QSize(px(17), px(17)));
    for (QToolButton* b : buttons_) b->setIconSize(QSize(px(18), px(18)));
}

QString LivePanel::guide() const {
    const bool heard = std::any_of(inputs_.sources().begin(), inputs_.sources().end(), [](const InputDeck::Source& s) { return s.open && (s.heard.counts.packets > 0 || !s.heard.device.empty()); });
    if (!inputs_.listens()) return inputs_.anythingPlugged() ? tr("Learn: choose what is to move, press Learn, and move a control.") : tr("Plug: plug in a game controller or a MIDI device, or switch on a source on the left and let a program send to its port. Without any, press Learn and then a key of the keyboard.");
    switch (inputs_.waits()) {
        case InputDeck::Waits::LetGo: return tr("Inputs are stopped. Press a mapped key or Continue, and they go on.");
        case InputDeck::Waits::Undone: return tr("What inputs held was undone. They move nothing until you continue.");
        case InputDeck::Waits::Refused: return tr("Inputs could not take hold of the character. They move nothing until you continue.");
        case InputDeck::Waits::Take: return tr("A take is shown. Press a mapped key or Continue, and inputs move the character.");
        case InputDeck::Waits::NoCharacter: return tr("There is no character to perform yet. Open a sample, or make a mesh soft.");
        case InputDeck::Waits::No: break;
    }
    if (inputs_.hears() && !heard) return tr("Plug: nothing has come yet. On the left is what is waited for.");
    if (model_->rowCount() == 0) return tr("Learn: choose what is to move, press Learn, and move a control.");
    const QString keys = actions_["record"]->shortcut().toString(QKeySequence::NativeText);
    if (deck_.recording()) return tr("Record: all that you see is kept.");
    return keys.isEmpty() ? tr("Play. Recording keeps what you perform as a take.") : tr("Play. %1 records what you perform as a take.", "a key").arg(keys);
}

void LivePanel::follow() {
    const QString text = guide();
    if (guide_->text() != text) guide_->setText(text);
    const auto waits = inputs_.waits();
    goOn_->setVisible(inputs_.listens() && waits != InputDeck::Waits::No && waits != InputDeck::Waits::NoCharacter);
    letGo_->setEnabled(actions_["let-go"]->isEnabled());
}

void LivePanel::followRow() {
    const int row = view_->chosen();
    const InputMapping* m = model_->mapping(row);
    chosen_ = m ? *m : InputMapping();
    form_->show(row);
    right_->setVisible(row >= 0);
    up_->setEnabled(row > 0);
    down_->setEnabled(row >= 0 && row + 1 < model_->rowCount());
    remove_->setEnabled(row >= 0);
}

void LivePanel::removeRow() {
    const int row = view_->chosen();
    const InputMapping* m = model_->mapping(row);
    if (!m) return;
    // The next one is chosen.
    if (const InputMapping* next = model_->mapping(row + 1) ? model_->mapping(row + 1) : model_->mapping(row - 1)) chosen_ = *next;
    document_.execute(commands::unmapInput(InputMapping(*m)));
}

void LivePanel::moveRow(int by) {
    const int row = view_->chosen(), to = row + by;
    const InputMapping* m = model_->mapping(row);
    if (!m || !model_->mapping(to)) return;
    document_.execute(commands::mapInput(InputMapping(*m), std::size_t(to)));
}

void LivePanel::retranslate() {
    left_->setAccessibleName(tr("Sources"));
    view_->setAccessibleName(tr("Mappings"));
    up_->setToolTip(tr("Move this row up. Of rows that drive the same, the upper one wins."));
    down_->setToolTip(tr("Move this row down"));
    remove_->setToolTip(tr("Remove this row"));
    suggest_->setToolTip(tr("Map a source to whatever the character has: limbs, poses, shapes"));
    for (QToolButton* b : {up_, down_, remove_, suggest_}) b->setAccessibleName(b->toolTip());
    goOn_->setText(tr("Continue"));
    const QString keys = actions_["let-go"]->shortcut().toString(QKeySequence::NativeText);
    letGo_->setText(keys.isEmpty() ? tr("Stop every input") : QStringLiteral("%1  (%2)").arg(tr("Stop every input"), keys));
    letGo_->setToolTip(tr("Everything that inputs move glides to rest, and they move nothing more until you continue."));
    model_->refresh();
    followRow();
    follow();
}

void LivePanel::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    inputs_.lookForDevices();
}

void LivePanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
