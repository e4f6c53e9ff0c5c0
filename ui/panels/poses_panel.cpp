// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/poses_panel.h"

#include <QEvent>
#include <QIcon>
#include <QKeyEvent>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "core/document/kept_pose.h"
#include "ui/models/commands.h"
#include "ui/panels/cycles_panel.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/list_keys.h"

namespace imomushi {
namespace {

constexpr int kNameRole = Qt::UserRole;
/// As many as there are keys for.
constexpr int kKeyed = 9;
constexpr int kPictureWide = 64, kPictureHigh = 48, kRoom = 24;  // pixels of the design
constexpr int kBetweenHalves = 16, kBlendWide = 80, kBesideBlend = 8;  // the same
constexpr int kPosesMargin = 8;  // pixels

}  // namespace

PosesPanel::PosesPanel(StudioDocument& document, InputDeck& inputs, ActionSet& actions, QWidget* parent) : QWidget(parent), document_(document) {
    list_ = named(new QListWidget(this), "poses");
    list_->setEditTriggers(QAbstractItemView::EditKeyPressed);
    // Tiles: many are seen where the dock is wide and low.
    list_->setViewMode(QListView::IconMode);
    list_->setMovement(QListView::Static);
    list_->setResizeMode(QListView::Adjust);
    list_->setTextElideMode(Qt::ElideRight);
    list_->setUniformItemSizes(true);
    list_->setSelectionMode(QAbstractItemView::ExtendedSelection);
    list_->installEventFilter(this);
    list_->setContextMenuPolicy(Qt::CustomContextMenu);
    empty_ = styled(new QLabel(this), "muted");
    empty_->setWordWrap(true);
    blendLabel_ = new QLabel(this);
    blend_ = named(new QSlider(Qt::Horizontal, this), "blend");
    blend_->setRange(0, 100);
    blendLabel_->setBuddy(blend_);
    auto* row = new QHBoxLayout;
    for (const char* id : {"keep-pose", "mirror-pose", "rest-bones", "rest-chain"}) {
        auto* button = new QToolButton(this);
        button->setDefaultAction(actions[id]);
        // In words what is there first; the others say what they do, and cycles have their place beside.
        button->setToolButtonStyle(buttons_.empty() ? Qt::ToolButtonTextBesideIcon : Qt::ToolButtonIconOnly);
        buttons_.push_back(button);
        row->addWidget(button);
    }
    blend_->setMinimumWidth(px(kBlendWide));
    fill(row, Space{px(kBesideBlend)}, blendLabel_, Share{blend_, 1});
    cycles_ = new CyclesPanel(document, inputs, this);
    auto* poses = fill(new QVBoxLayout, row, Share{list_, 1}, Share{empty_, 1});
    halves_ = new QBoxLayout(QBoxLayout::LeftToRight, this);
    usePanelBackground(this);
    fill(halves_, QMargins(kPosesMargin, kPosesMargin, kPosesMargin, kPosesMargin), Spacing{px(kBetweenHalves)}, Share{poses, 1}, Share{cycles_, 1});

    connect(list_, &QListWidget::itemActivated, this, [this] { apply(1.0, false); });
    connect(list_, &QListWidget::itemChanged, this, [this](QListWidgetItem* item) {
        if (following_) return;
        const QString name = item->text();
        // Later: the list must not change while it is told of a change.
        QMetaObject::invokeMethod(this, [this, was = item->data(kNameRole).toString(), name] {
            if (!document_.execute(commands::renamePose(was.toStdString(), name.toStdString()))) follow();
        }, Qt::QueuedConnection);
    });
    connect(list_, &QListWidget::currentRowChanged, this, [this] { blend_->setEnabled(!chosen().isEmpty()); });
    connect(list_, &QListWidget::itemSelectionChanged, this, [this] {
        if (!following_) tellChosen();
    });
    connect(list_, &QWidget::customContextMenuRequested, this, [this](const QPoint& at) { menu(list_->viewport()->mapToGlobal(at)); });
    connect(blend_, &QSlider::valueChanged, this, &PosesPanel::blendTo);
    connect(blend_, &QSlider::sliderReleased, this, [this] { endBlend(true); });
    blend_->installEventFilter(this);
    connect(&document_, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.has(&DocumentChange::poses)) follow();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, &PosesPanel::takeSizes);
    takeSizes();
    retranslate();
}

QString PosesPanel::chosen() const {
    const QListWidgetItem* item = list_->currentItem();
    return item ? item->data(kNameRole).toString() : QString();
}

void PosesPanel::follow() {
    const QString before = chosen();
    // Pictures of poses that are gone go.
    QHash<QString, QImage> known;
    for (const KeptPose& pose : keptPoses(document_.document()))
        if (const QString name = QString::fromStdString(pose.name); pictures_.contains(name)) known.insert(name, pictures_.value(name));
    pictures_ = std::move(known);
    following_ = true;
    list_->clear();
    int place = 0;
    for (const KeptPose& pose : keptPoses(document_.document())) {
        const QString name = QString::fromStdString(pose.name);
        auto* item = new QListWidgetItem(name, list_);
        item->setFlags(item->flags() | Qt::ItemIsEditable);
        item->setData(kNameRole, name);
        item->setIcon(iconOf(name));
        if (place < kKeyed) item->setToolTip(tr("Double click or Alt+%1: pose the character so").arg(place + 1));
        ++place;
        if (name == before) list_->setCurrentItem(item);
    }
    following_ = false;
    tellChosen();
    list_->setVisible(place > 0);
    empty_->setVisible(place == 0);
    blend_->setEnabled(!chosen().isEmpty());
}

QIcon PosesPanel::iconOf(const QString& pose) const {
    const QImage picture = pictures_.value(pose);
    return picture.isNull() ? themedIcon(QStringLiteral("pose"), Appearance::Role::Muted) : QIcon(QPixmap::fromImage(picture));
}

void PosesPanel::setPicture(const QString& pose, const QImage& picture) {
    if (pictures_.value(pose).cacheKey() == picture.cacheKey()) return;
    pictures_.insert(pose, picture);
    following_ = true;
    for (int row = 0; row < list_->count(); ++row)
        if (list_->item(row)->data(kNameRole).toString() == pose) list_->item(row)->setIcon(iconOf(pose));
    following_ = false;
}

void PosesPanel::takeSizes() {
    list_->setIconSize(QSize(px(kPictureWide), px(kPictureHigh)));
    list_->setGridSize(QSize(px(kPictureWide + kRoom), px(kPictureHigh) + list_->fontMetrics().height() + px(kRoom / 2)));
    list_->setMinimumHeight(list_->gridSize().height() + 2 * list_->frameWidth());  // a row with its names
}

void PosesPanel::tellChosen() {
    QStringList poses;
    for (int row = 0; row < list_->count(); ++row)
        if (list_->item(row)->isSelected()) poses << list_->item(row)->data(kNameRole).toString();
    cycles_->choosePoses(poses);
}

void PosesPanel::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    const int beside = halves_->itemAt(0)->minimumSize().width() + halves_->spacing() + halves_->itemAt(1)->minimumSize().width() + 2 * kPosesMargin;
    halves_->setDirection(width() < beside ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
}

QSize PosesPanel::minimumSizeHint() const {
    QSize least = QWidget::minimumSizeHint();
    least.setWidth(std::max(halves_->itemAt(0)->minimumSize().width(), halves_->itemAt(1)->minimumSize().width()) + 2 * kPosesMargin);
    return least;
}

void PosesPanel::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    Q_EMIT seen(true);
}

void PosesPanel::hideEvent(QHideEvent* event) {
    QWidget::hideEvent(event);
    Q_EMIT seen(false);
}

void PosesPanel::apply(double share, bool mirrored) {
    if (!chosen().isEmpty()) document_.execute(commands::applyPose(chosen().toStdString(), share, mirrored));
}

void PosesPanel::blendTo(int percent) {
    const QString name = chosen();
    if (name.isEmpty()) return;
    // Each part of the way is one from where the drag began.
    gesture_.reset();
    if (percent == 0 || document_.inGesture()) return;
    gesture_ = std::make_unique<Gesture>(document_);
    if (!document_.execute(commands::applyPose(name.toStdString(), percent / 100.0, false))) return endBlend(false);
    if (!blend_->isSliderDown() && !blend_->hasFocus()) endBlend(true);
}

void PosesPanel::endBlend(bool keep) {
    if (gesture_ && keep) gesture_->commit({"apply-pose", chosen().toStdString()});
    gesture_.reset();
    const QSignalBlocker quiet(blend_);
    blend_->setValue(0);
}

bool PosesPanel::eventFilter(QObject* watched, QEvent* event) {
    if (watched == blend_) {
        // Arrow keys lead it, too: Enter keeps, Esc takes back, and so does leaving.
        if (event->type() == QEvent::FocusOut && gesture_ && !blend_->isSliderDown()) endBlend(true);
        if (event->type() == QEvent::WindowDeactivate && gesture_) endBlend(false);
        if (event->type() == QEvent::ShortcutOverride || event->type() == QEvent::KeyPress) {
            const int key = static_cast<QKeyEvent*>(event)->key();
            if (gesture_ && (key == Qt::Key_Return || key == Qt::Key_Enter || key == Qt::Key_Escape)) {
                event->accept();
                if (event->type() == QEvent::KeyPress) endBlend(key != Qt::Key_Escape);
                return true;
            }
        }
    }
    if (watched == list_ && takeListKey(*event, [this] {
            if (!chosen().isEmpty()) document_.execute(commands::removePose(chosen().toStdString()));
        }))
        return true;
    return QWidget::eventFilter(watched, event);
}

void PosesPanel::menu(const QPoint& global) {
    if (chosen().isEmpty()) return;
    QMenu menu(this);
    menu.addAction(tr("Pose so"), this, [this] { apply(1.0, false); });
    menu.addAction(tr("Pose so, mirrored"), this, [this] { apply(1.0, true); });
    menu.addAction(tr("Half of the way"), this, [this] { apply(0.5, false); });
    menu.addSeparator();
    menu.addAction(tr("Keep the present pose here"), this, [this] { document_.execute(commands::keepPose(chosen().toStdString())); });
    menu.addAction(tr("Rename"), this, [this] { list_->editItem(list_->currentItem()); });
    menu.addAction(tr("Remove"), this, [this] { document_.execute(commands::removePose(chosen().toStdString())); });
    menu.exec(global);
}

void PosesPanel::retranslate() {
    list_->setAccessibleName(tr("Poses"));
    empty_->setText(tr("No poses yet. Pose the character, and keep the pose."));
    blendLabel_->setText(tr("Part of the way"));
    blend_->setAccessibleName(tr("Part of the way to the chosen pose"));
    blend_->setToolTip(tr("Drag: the character goes that far to the chosen pose"));
    follow();
}

void PosesPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
