// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/learn_bar.h"

#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QSignalBlocker>

#include "core/document/document_change.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

LearnBar::LearnBar(StudioDocument& document, InputDeck& inputs, QWidget* parent) : QWidget(parent), document_(document), inputs_(inputs) {
    choosing_ = new QWidget(this);
    thing_ = named(new QComboBox(choosing_), "thing");
    number_ = named(new QComboBox(choosing_), "number");
    for (QComboBox* box : {thing_, number_}) {
        box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        box->setMinimumContentsLength(7);
        box->setMaxVisibleItems(20);
    }
    learn_ = named(new QPushButton(choosing_), "learn");
    learn_->setProperty("primary", true);
    fill(new QHBoxLayout(choosing_), QMargins(0, 0, 0, 0), Spacing{px(6)}, Share{thing_, 1}, Share{number_, 1}, learn_);
    learning_ = new QWidget(this);
    sign_ = new QLabel(learning_);
    says_ = named(new ElidedLabel(learning_), "learning");
    use_ = named(new QPushButton(learning_), "useControl");
    stop_ = named(new QPushButton(learning_), "stopLearning");
    fill(new QHBoxLayout(learning_), QMargins(0, 0, 0, 0), Spacing{px(6)}, sign_, Share{static_cast<QLabel*>(says_), 1}, use_, stop_);
    fill(new QHBoxLayout(this), QMargins(0, 0, 0, 0), choosing_, learning_);
    connect(thing_, &QComboBox::currentIndexChanged, this, &LearnBar::fillNumbers);
    connect(learn_, &QPushButton::clicked, this, [this] {
        if (const std::string wanted = target(); !wanted.empty()) inputs_.learn(wanted);
    });
    connect(use_, &QPushButton::clicked, &inputs, &InputDeck::takeCandidate);
    connect(stop_, &QPushButton::clicked, &inputs, &InputDeck::stopLearning);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.unknown || !change.elements.empty() || !change.bones.empty() || !change.characters.empty() || change.effects || change.poses || !change.takes.empty()) fillThings();
    });
    connect(&document, &StudioDocument::selectionChanged, this, &LearnBar::followSelection);
    connect(&inputs, &InputDeck::changed, this, &LearnBar::follow);
    connect(&inputs, &InputDeck::told, this, &LearnBar::tell);
    connect(&Appearance::instance(), &Appearance::changed, this, &LearnBar::retranslate);
    retranslate();
}

std::string LearnBar::target() const {
    const int thing = thing_->currentIndex(), number = number_->currentIndex();
    if (thing < 0 || std::size_t(thing) >= things_.size()) return {};
    const auto& numbers = things_[std::size_t(thing)].numbers;
    return number < 0 || std::size_t(number) >= numbers.size() ? std::string() : numbers[std::size_t(number)].second;
}

void LearnBar::setTarget(const std::string& target) {
    for (std::size_t t = 0; t < things_.size(); ++t)
        for (std::size_t n = 0; n < things_[t].numbers.size(); ++n)
            if (things_[t].numbers[n].second == target) {
                thing_->setCurrentIndex(int(t));
                number_->setCurrentIndex(int(n));
                return;
            }
}

void LearnBar::fillThings() {
    const std::string was = target();
    things_ = drivenThings(document_.document());
    {
        const QSignalBlocker quiet(thing_);
        thing_->clear();
        for (const DrivenThing& thing : things_) thing_->addItem(themedIcon(thing.icon, Appearance::Role::Muted), thing.title);
    }
    fillNumbers();
    if (!was.empty()) setTarget(was);
    follow();
}

void LearnBar::fillNumbers() {
    const int was = number_->currentIndex();
    number_->clear();
    const int thing = thing_->currentIndex();
    if (thing < 0) return;
    for (const auto& [title, target] : things_[std::size_t(thing)].numbers) number_->addItem(title);
    // Handles and bones are raised and lowered at first.
    const bool place = things_[std::size_t(thing)].icon == u"handle" || things_[std::size_t(thing)].icon == u"bone";
    number_->setCurrentIndex(was > 0 && was < number_->count() ? was : std::min(place ? 1 : 0, number_->count() - 1));
}

void LearnBar::followSelection() {
    if (document_.selection().size() != 1) return;
    const std::string meant = targetOf(document_.document(), document_.selection().front());
    if (meant.empty()) return;
    // The same number of another thing, where it was chosen already.
    const int number = number_->currentIndex(), before = thing_->currentIndex();
    setTarget(meant);
    const bool alike = before >= 0 && thing_->currentIndex() >= 0 && things_[std::size_t(before)].icon == things_[std::size_t(thing_->currentIndex())].icon && things_[std::size_t(before)].icon == u"handle";
    if (alike) number_->setCurrentIndex(number);
}

void LearnBar::follow() {
    choosing_->setVisible(!inputs_.learning());
    learning_->setVisible(inputs_.learning());
    thing_->setEnabled(!things_.empty());
    number_->setEnabled(!things_.empty());
    learn_->setEnabled(!things_.empty() && inputs_.canLearn());
    learn_->setToolTip(things_.empty()      ? tr("There is no handle, no bone and no shape that could be driven.")
                       : !inputs_.canLearn() ? tr("Plug in a device, or switch on a source first.")
                                            : tr("Press, then move the control that is to drive this."));
    tell();
}

void LearnBar::tell() {
    if (!inputs_.learning()) return;
    const auto& found = inputs_.candidate();
    use_->setEnabled(found.has_value());
    const QString target = targetText(document_.document(), inputs_.learnedTarget()).text();
    if (!found) return says_->setText(tr("Move the control that is to drive “%1” …").arg(target));
    InputMapping heard;
    heard.row.source = found->source;
    heard.row.channel = found->channel;
    heard.row.component = found->component;
    const QLocale locale;
    says_->setText(tr("%1, from %2 to %3 …", "a control that moves, its range").arg(channelText(heard), locale.toString(found->low, 'g', 3), locale.toString(found->high, 'g', 3)));
}

void LearnBar::retranslate() {
    thing_->setAccessibleName(tr("What is to be driven"));
    number_->setAccessibleName(tr("Which number of it"));
    learn_->setText(tr("Learn"));
    learn_->setMinimumHeight(learn_->minimumSizeHint().height());  // letters of another language may be higher
    use_->setText(tr("Use it"));
    stop_->setText(tr("Cancel"));
    sign_->setPixmap(themedIcon(QStringLiteral("learn"), Appearance::Role::Accent).pixmap(QSize(px(18), px(18)), devicePixelRatioF()));
    fillThings();
}

void LearnBar::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
