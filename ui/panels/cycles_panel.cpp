// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/cycles_panel.h"

#include <QEvent>
#include <QGridLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QLocale>
#include <QSlider>
#include <QToolButton>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "core/document/cycle.h"
#include "ui/models/commands.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/list_keys.h"
#include "ui/widgets/number_field.h"

namespace imomushi {
namespace {

constexpr int kCycleRole = Qt::UserRole;
constexpr int kListHigh = 78, kFaderWide = 90, kBesideFaders = 12;  // pixels of the design
constexpr int kCycleName = 0, kCycleRound = 1;  // columns
// Of the faders: a hundred is the whole of a cycle, and the speed that it was made with.
constexpr int kWholeCycle = 100, kSlowestFader = -200, kFastestFader = 300;

/// Its poses were made with it, by suggest-cycles.
bool hasPosesOfItsOwn(const Cycle& cycle) {
    int number = 0;
    return std::ranges::all_of(cycle.poses, [&](const std::string& pose) { return pose == cycle.name + " " + std::to_string(++number); });
}

}  // namespace

CyclesPanel::CyclesPanel(StudioDocument& document, InputDeck& inputs, QWidget* parent) : QWidget(parent), document_(document), inputs_(inputs) {
    title_ = styled(new QLabel(this), "section");
    const auto button = [this](const char* name, const char* icon) {
        auto* made = named(new QToolButton(this), name);
        made->setIcon(themedIcon(QLatin1String(icon)));
        return made;
    };
    new_ = button("new-cycle", "new");
    suggest_ = button("suggest-cycles", "suggest");
    suggest_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    remove_ = button("remove-cycle", "trash");
    list_ = named(new QTreeWidget(this), "cycles");
    list_->setColumnCount(2);
    list_->setRootIsDecorated(false);
    list_->setUniformRowHeights(true);
    list_->setHeaderHidden(true);
    list_->setMinimumHeight(px(kListHigh));
    list_->setEditTriggers(QAbstractItemView::EditKeyPressed | QAbstractItemView::DoubleClicked);
    list_->header()->setStretchLastSection(false);
    list_->header()->setSectionResizeMode(kCycleName, QHeaderView::Stretch);
    list_->header()->setSectionResizeMode(kCycleRound, QHeaderView::ResizeToContents);
    list_->installEventFilter(this);
    empty_ = styled(new QLabel(this), "muted");
    empty_->setWordWrap(true);
    empty_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    const auto fader = [this](const char* name, int low, int high, int at) {
        auto* made = named(new QSlider(Qt::Horizontal, this), name);
        made->setRange(low, high);
        made->setValue(at);
        made->setSingleStep(5);
        made->setPageStep(25);
        made->installEventFilter(this);
        return made;
    };
    amount_ = fader("cycle-amount", 0, kWholeCycle, 0);
    speed_ = fader("cycle-speed", kSlowestFader, kFastestFader, kWholeCycle);
    amountLabel_ = new QLabel(this);
    speedLabel_ = new QLabel(this);
    amountLabel_->setBuddy(amount_);
    speedLabel_->setBuddy(speed_);
    amountNow_ = styled(new QLabel(this), "muted");
    speedNow_ = styled(new QLabel(this), "muted");
    for (QLabel* now : {amountNow_, speedNow_}) now->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    auto* faders = new QGridLayout;
    int row = 0;
    for (const auto& [label, slider, now] : {std::tuple(amountLabel_, amount_, amountNow_), std::tuple(speedLabel_, speed_, speedNow_)}) {
        faders->addWidget(label, row, 0);
        faders->addWidget(slider, row, 1);
        faders->addWidget(now, row++, 2);
        slider->setMinimumWidth(px(kFaderWide));
    }
    faders->setColumnStretch(1, 1);
    faders->setRowStretch(row, 1);
    auto* body = new QHBoxLayout;
    fill(body, Spacing{px(kBesideFaders)}, Share{list_, 2}, Share{empty_, 2}, Share{faders, 3});
    auto* head = new QHBoxLayout;
    fill(head, title_, Stretch{}, new_, suggest_, remove_);
    fill(new QVBoxLayout(this), QMargins(0, 0, 0, 0), head, Share{body, 1});

    connect(new_, &QToolButton::clicked, this, &CyclesPanel::makeNew);
    connect(suggest_, &QToolButton::clicked, this, &CyclesPanel::suggest);
    connect(remove_, &QToolButton::clicked, this, &CyclesPanel::remove);
    connect(list_, &QTreeWidget::currentItemChanged, this, [this] {
        if (!following_) followFaders();
    });
    connect(list_, &QTreeWidget::itemChanged, this, [this](QTreeWidgetItem* item, int column) {
        if (following_) return;
        // Later: the list must not change while it is told of a change.
        QMetaObject::invokeMethod(this, [this, column, cycle = item->data(kCycleName, kCycleRole).toString(), text = item->text(column)] { column == kCycleName ? rename(cycle, text) : setSeconds(cycle, text); }, Qt::QueuedConnection);
    });
    for (QSlider* slider : {amount_, speed_}) connect(slider, &QSlider::valueChanged, this, &CyclesPanel::play);
    connect(&document_, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.has(&DocumentChange::cycles)) follow();
    });
    connect(&inputs_, &InputDeck::changed, this, &CyclesPanel::followFaders);
    retranslate();
}

QString CyclesPanel::chosen() const {
    const QTreeWidgetItem* item = list_->currentItem();
    return item ? item->data(kCycleName, kCycleRole).toString() : QString();
}

void CyclesPanel::choose(const QString& cycle) {
    for (int i = 0; i < list_->topLevelItemCount(); ++i)
        if (list_->topLevelItem(i)->data(kCycleName, kCycleRole).toString() == cycle) list_->setCurrentItem(list_->topLevelItem(i));
}

void CyclesPanel::choosePoses(const QStringList& poses) {
    poses_ = poses;
    const bool enough = poses_.size() >= qsizetype(Cycle::kFewestPoses);
    new_->setEnabled(enough);
    new_->setToolTip(enough ? tr("Make a cycle of the chosen poses, in their order") : tr("Choose two poses or more (Ctrl+click) to make a cycle of them"));
    new_->setAccessibleName(new_->toolTip());
}

void CyclesPanel::follow() {
    const QString before = chosen();
    following_ = true;
    list_->clear();
    for (const Cycle& cycle : cyclesOf(document_.document())) {
        const QString name = QString::fromStdString(cycle.name);
        QStringList poses;
        for (const std::string& pose : cycle.poses) poses << QString::fromStdString(pose);
        auto* item = new QTreeWidgetItem(list_, {name, tr("%1 s", "how long a round takes").arg(QLocale().toString(cycle.seconds, 'g', 4))});
        item->setFlags(item->flags() | Qt::ItemIsEditable);
        item->setData(kCycleName, kCycleRole, name);
        item->setToolTip(kCycleName, poses.join(QStringLiteral(" → ")));
        item->setToolTip(kCycleRound, tr("How long one round takes. Double click to change it."));
        if (name == before) list_->setCurrentItem(item);
    }
    following_ = false;
    const bool any = list_->topLevelItemCount() > 0;
    if (any && !list_->currentItem()) list_->setCurrentItem(list_->topLevelItem(0));
    list_->setVisible(any);
    empty_->setVisible(!any);
    followFaders();
}

void CyclesPanel::followFaders() {
    const bool any = !chosen().isEmpty();
    const InputDeck::CycleFaders faders = inputs_.cycleFaders(chosen().toStdString());
    const QSignalBlocker quiet(amount_), silent(speed_);
    amount_->setValue(qRound(kWholeCycle * faders.amount));
    speed_->setValue(qRound(kWholeCycle * faders.speed));
    for (QWidget* w : std::initializer_list<QWidget*>{amount_, speed_, amountLabel_, speedLabel_, amountNow_, speedNow_, remove_}) w->setEnabled(any);
    amountNow_->setText(tr("%1 %", "how much of a cycle").arg(amount_->value()));
    speedNow_->setText(tr("%1×", "how fast a cycle runs").arg(QLocale().toString(faders.speed, 'f', 2)));
}

void CyclesPanel::play() {
    if (!chosen().isEmpty()) inputs_.playCycle(chosen().toStdString(), {double(amount_->value()) / kWholeCycle, double(speed_->value()) / kWholeCycle});
    followFaders();
}

void CyclesPanel::suggest() {
    const auto answer = document_.execute(commands::suggestCycles({{"crawl", tr("crawl", "name of a cycle").toStdString()}, {"sway", tr("sway", "name of a cycle").toStdString()}, {"breathe", tr("breathe", "name of a cycle").toStdString()}}));
    if (answer) choose(QString::fromStdString(answer->at("cycles").front().get<std::string>()));
}

void CyclesPanel::begin() {
    const auto& cycles = cyclesOf(document_.document());
    if (cycles.empty()) return;
    if (std::ranges::any_of(cycles, [this](const Cycle& cycle) { return inputs_.cycleFaders(cycle.name).amount != 0.0; })) return inputs_.goOn();
    if (chosen().isEmpty()) choose(QString::fromStdString(cycles.front().name));
    amount_->setValue(kWholeCycle / 2);
}

void CyclesPanel::makeNew() {
    std::vector<std::string> poses;
    for (const QString& pose : poses_) poses.push_back(pose.toStdString());
    const auto answer = document_.execute(commands::addCycle({}, poses));
    if (answer) choose(QString::fromStdString(answer->at("name").get<std::string>()));
}

void CyclesPanel::rename(const QString& cycle, const QString& name) {
    const InputDeck::CycleFaders faders = inputs_.cycleFaders(cycle.toStdString());
    if (!document_.execute(commands::renameCycle(cycle.toStdString(), name.toStdString()))) return follow();
    choose(name);
    // It goes on under its new name.
    inputs_.playCycle(name.toStdString(), faders);
    followFaders();
}

void CyclesPanel::setSeconds(const QString& cycle, const QString& text) {
    const auto seconds = NumberField::numberIn(text, tr("%1 s", "how long a round takes").arg(QString()).trimmed());
    if (!seconds || !document_.execute(commands::addCycle(cycle.toStdString(), {}, *seconds))) follow();
}

void CyclesPanel::remove() {
    const Cycle* cycle = cycleNamed(document_.document(), chosen().toStdString());
    if (cycle) document_.execute(commands::removeCycle(cycle->name, hasPosesOfItsOwn(*cycle)));
}

bool CyclesPanel::eventFilter(QObject* watched, QEvent* event) {
    if ((watched == amount_ || watched == speed_) && event->type() == QEvent::MouseButtonDblClick) {
        watched == amount_ ? amount_->setValue(0) : speed_->setValue(kWholeCycle);
        return true;
    }
    if (watched == list_ && takeListKey(*event, [this] { remove(); })) return true;
    return QWidget::eventFilter(watched, event);
}

void CyclesPanel::retranslate() {
    title_->setText(tr("Cycles"));
    list_->setAccessibleName(tr("Cycles"));
    empty_->setText(tr("No cycles yet: movements that repeat through kept poses. Suggest some, or choose poses and make one of them."));
    suggest_->setText(tr("Suggest"));
    suggest_->setToolTip(tr("Suggest cycles and their poses from the skeleton: crawl, sway, breathe"));
    remove_->setToolTip(tr("Remove the cycle, and the poses that were suggested with it"));
    for (QToolButton* b : {suggest_, remove_}) b->setAccessibleName(b->toolTip());
    amountLabel_->setText(tr("Amount"));
    speedLabel_->setText(tr("Speed"));
    amount_->setAccessibleName(tr("Amount of the cycle"));
    speed_->setAccessibleName(tr("Speed of the cycle"));
    amount_->setToolTip(tr("How much there is of the cycle: drag it, and the character moves. Double click: none"));
    speed_->setToolTip(tr("How fast it runs, to the left backwards. Double click: as it was made"));
    choosePoses(poses_);
    follow();
}

void CyclesPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
