// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/next_steps.h"

#include <QAction>
#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "core/commands/proposal_commands.h"
#include "ui/models/selection_commands.h"
#include "ui/models/studio_document.h"
#include "ui/viewport/axis_ball.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr int kMargin = 16;  // to the edges of the view
constexpr const char *kWithKey = "withKey", *kWithoutKey = "withoutKey";  // properties of buttons: their texts
constexpr const char* kActions[] = {"import", "open", "make-soft", "tool-handle", "tool-face", "tool-bone"};  // whose keys are told

/// A text with the key that does the same.
QString withKey(const QString& text, const QAction& action) {
    const QString keys = action.shortcut().toString(QKeySequence::NativeText);
    return keys.isEmpty() ? text : QStringLiteral("%1  (%2)").arg(text, keys);
}

}  // namespace

NextSteps::NextSteps(StudioDocument& document, const ActionSet& actions, QMenu* samples, QWidget* view)
    : QFrame(view), document_(document), actions_(actions), samples_(samples), view_(view) {
    view->installEventFilter(this);
    connect(&document, &StudioDocument::structureChanged, this, [this] { QMetaObject::invokeMethod(this, &NextSteps::follow, Qt::QueuedConnection); });
    connect(&document, &StudioDocument::historyChanged, this, [this] { QMetaObject::invokeMethod(this, &NextSteps::follow, Qt::QueuedConnection); });
    connect(&Appearance::instance(), &Appearance::changed, this, &NextSteps::rebuild);
    for (const char* id : kActions) connect(actions[id], &QAction::changed, this, [this] { QMetaObject::invokeMethod(this, &NextSteps::follow, Qt::QueuedConnection); });
    rebuild();
}

QString NextSteps::keys() const {
    QStringList keys;
    for (const char* id : kActions) keys << actions_[id]->shortcut().toString();
    return keys.join(u' ');
}

NextSteps::Wanted NextSteps::wanted() const {
    const Document& d = document_.document();
    if (waiting_) return {};
    if (d.elements.empty()) return {d.bones.empty() ? Step::Begin : Step::None, 0};
    const auto open = [&](PartId id) { return !closed_.contains(id); };
    for (const auto& [id, character] : d.characters)
        if (open(id) && canBecomeSoft(d, *character)) return {Step::Soften, id};
    for (const auto& [id, element] : d.elements)
        if (open(id) && !element->piece && element->faces.empty()) return {Step::Hold, id};
    const PartId first = d.elements.begin()->first;
    const auto handled = [](const auto& e) { return !e.second->handles.empty(); };
    const auto faced = [](const auto& e) { return !e.second->faces.empty(); };
    const bool missing = d.bones.empty() && std::any_of(d.elements.begin(), d.elements.end(), faced) && std::none_of(d.elements.begin(), d.elements.end(), handled);
    return missing && open(first) ? Wanted{Step::Bones, first} : Wanted{};
}

void NextSteps::follow() {
    if (document_.document().elements.empty()) closed_.clear();
    const Wanted now = wanted();
    const Document& d = document_.document();
    const std::string name = now.step == Step::Soften ? d.characters.at(now.subject)->name : now.step == Step::Hold ? d.elements.at(now.subject)->name : std::string();
    if (now == shown_ && name == name_ && keys() == keys_) return;
    rebuild();
}

void NextSteps::setWaiting(bool waiting) {
    waiting_ = waiting;
    follow();
}

void NextSteps::setDropping(bool dropping) {
    dropping_ = dropping;
    update();
}

void NextSteps::retranslate() { rebuild(); }

void NextSteps::rebuild() {
    shown_ = wanted();
    keys_ = keys();
    // Whatever had the focus in here is about to go.
    if (content_) {
        content_->hide();
        content_->deleteLater();
        content_ = nullptr;
    }
    setVisible(shown_.step != Step::None);
    name_.clear();
    if (shown_.step == Step::None) return;
    const Document& d = document_.document();
    const bool begin = shown_.step == Step::Begin;
    content_ = new QWidget(this);
    auto* text = text_ = new QLabel(content_);
    auto* buttons = buttons_ = new QHBoxLayout;
    buttons->setSpacing(px(8));
    const auto button = [&](const char* name, const QString& label, const char* icon, bool primary) {
        auto* b = new QPushButton(themedIcon(QLatin1String(icon), primary ? Appearance::Role::OnAccent : Appearance::Role::Text), label, content_);
        b->setProperty(kWithKey, label);
        b->setObjectName(QLatin1String(name));
        b->setIconSize(QSize(px(18), px(18)));
        b->setProperty("primary", primary);
        buttons->addWidget(b);
        return b;
    };
    const auto trigger = [&](const char* name, const QString& label, const char* icon, const char* action, bool primary) {
        QAction* a = actions_[action];
        auto* b = button(name, withKey(label, *a), icon, primary);
        b->setProperty(kWithoutKey, label);
        connect(b, &QPushButton::clicked, a, &QAction::trigger);
    };
    QString title;
    const auto soft = [&](bool primary) {
        auto* b = button("nextSoft", withKey(tr("Make it soft"), *actions_["make-soft"]), "soft", primary);
        b->setProperty(kWithoutKey, tr("Make it soft"));
        connect(b, &QPushButton::clicked, this, [this, id = shown_.subject] { Q_EMIT makeSoftWanted(id); });
    };
    switch (shown_.step) {
        case Step::Begin:
            title = tr("Drop a mesh or a project here");
            trigger("nextImport", tr("Import a mesh…"), "import", "import", true);
            button("nextSample", tr("Open a sample"), "character", false)->setMenu(samples_);
            trigger("nextOpen", tr("Open a project…"), "open", "open", false);
            break;
        case Step::Soften:
            name_ = d.characters.at(shown_.subject)->name;
            title = tr("“%1” is not soft yet.").arg(QString::fromStdString(name_));
            soft(true);
            trigger("nextHandle", tr("Place a handle"), "handle", "tool-handle", false);
            trigger("nextCut", tr("Cut it"), "cut", "tool-face", false);
            break;
        case Step::Hold:
            name_ = d.elements.at(shown_.subject)->name;
            title = tr("“%1” has nothing to be moved by yet.").arg(QString::fromStdString(name_));
            trigger("nextFace", tr("Place a joint face"), "face", "tool-face", true);
            trigger("nextHandle", tr("Place a handle"), "handle", "tool-handle", false);
            if (canBecomeSoft(d, *d.elements.at(shown_.subject))) soft(false);
            break;
        case Step::Bones:
            title = tr("Bones move joint faces.");
            trigger("nextBones", tr("Place bones"), "bone", "tool-bone", true);
            break;
        case Step::None:
            break;
    }
    text->setText(title);
    setAccessibleName(title);
    auto* outer = begin ? static_cast<QBoxLayout*>(new QVBoxLayout(content_)) : new QHBoxLayout(content_);
    words_ = nullptr;
    outer->setContentsMargins(px(begin ? 36 : 16), px(begin ? 30 : 9), px(begin ? 36 : 8), px(begin ? 32 : 9));
    outer->setSpacing(px(begin ? 14 : 16));
    if (begin) {
        text->setProperty("role", "title");
        text->setAlignment(Qt::AlignHCenter);
        auto* sign = new QLabel(content_);
        sign->setPixmap(themedIcon(QStringLiteral("import"), Appearance::Role::Muted).pixmap(QSize(px(40), px(40)), devicePixelRatioF()));
        sign->setAlignment(Qt::AlignHCenter);
        auto* note = new QLabel(tr("Any mesh can become a soft character: OBJ, PLY, STL, glTF, FBX, DAE."), content_);
        note->setProperty("role", "muted");
        note->setAlignment(Qt::AlignHCenter);
        for (QLabel* label : {sign, text, note}) outer->addWidget(label);
        outer->addSpacing(px(4));
        outer->addLayout(buttons);
    } else {
        words_ = new QBoxLayout(QBoxLayout::LeftToRight);
        words_->setSpacing(px(8));
        words_->addWidget(text);
        words_->addSpacing(px(8));
        words_->addLayout(buttons);
        outer->addLayout(words_);
        auto* close = new QToolButton(content_);
        close->setProperty("small", true);
        close->setIcon(themedIcon(QStringLiteral("close"), Appearance::Role::Muted));
        close->setToolTip(tr("Close"));
        close->setAccessibleName(tr("Close"));
        connect(close, &QToolButton::clicked, this, [this] {
            closed_.insert(shown_.subject);
            follow();
        });
        outer->addWidget(close, 0, Qt::AlignTop);
    }
    content_->show();
    place();
}

void NextSteps::place() {
    if (!content_) return;
    QSize room = view_->size() - QSize(2 * px(kMargin), 2 * px(kMargin));
    // Beside the ball of axes; words go over the buttons where a row has no room, and buttons over each other, at last without their keys, where that is not enough.
    if (words_) {
        room.setWidth(static_cast<int>(AxisBall::area(view_->width(), Appearance::instance().scale()).left()) - 2 * px(kMargin));
        const auto arrange = [&](QBoxLayout::Direction words, QBoxLayout::Direction buttons, const char* label) {
            for (auto* b : content_->findChildren<QPushButton*>()) b->setText(b->property(label).toString());
            words_->setDirection(words);
            buttons_->setDirection(buttons);
            text_->setWordWrap(buttons == QBoxLayout::TopToBottom);
            return content_->sizeHint().width() <= room.width();
        };
        using enum QBoxLayout::Direction;
        (void)(arrange(LeftToRight, LeftToRight, kWithKey) || arrange(TopToBottom, LeftToRight, kWithKey) || arrange(TopToBottom, TopToBottom, kWithKey) || arrange(TopToBottom, TopToBottom, kWithoutKey));
    }
    content_->layout()->activate();
    QSize size = content_->sizeHint().boundedTo(room);
    if (content_->layout()->hasHeightForWidth()) size.setHeight(std::min(room.height(), content_->layout()->totalHeightForWidth(size.width())));
    content_->setGeometry(QRect({}, size));
    const int left = std::min((view_->width() - size.width()) / 2, px(kMargin) + room.width() - size.width());
    setGeometry(left, words_ ? px(kMargin) : (view_->height() - size.height()) / 2, size.width(), size.height());
    raise();
}

void NextSteps::paintEvent(QPaintEvent*) {
    using Role = Appearance::Role;
    const bool begin = shown_.step == Step::Begin;
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    QColor edge = themeColor(begin ? dropping_ ? Role::Accent : Role::Muted : Role::Line);
    if (begin && !dropping_) edge.setAlphaF(0.45f);
    QPen pen(edge, begin ? dropping_ ? 2.5 : 1.5 : 1.0);
    if (begin) pen.setDashPattern({5.0, 4.0});
    p.setPen(pen);
    QColor fill = themeColor(Role::Panel);
    if (begin) fill.setAlphaF(0.86f);
    p.setBrush(fill);
    p.drawRoundedRect(QRectF(rect()).adjusted(1, 1, -1, -1), px(12), px(12));
}

bool NextSteps::eventFilter(QObject* watched, QEvent* event) {
    if (watched == view_ && event->type() == QEvent::Resize) place();
    return QFrame::eventFilter(watched, event);
}

}  // namespace imomushi
