// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/mapping_form.h"

#include <QComboBox>
#include <QEvent>
#include <QGridLayout>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>
#include <cmath>
#include <numbers>
#include <utility>

#include "ui/models/commands.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/switch.h"

namespace imomushi {
namespace {

constexpr double kLongestSmoothing = 2.0;  // s, of the time constant
constexpr double kHalfTurns = 16.0 * std::numbers::pi;

/// A filter as how late it is, s; 0: none.
double smoothingOf(const InputMapping& m) { return m.row.filter.delay(); }
void setSmoothing(InputMapping& m, double seconds) { m.row.filter.hertz = seconds > 0.0 ? std::min(InputMapping::kLargestHertz, 1.0 / (2.0 * std::numbers::pi * seconds)) : 0.0; }

NumberField::Spec spec(double low, double high, double step, int decimals, const QString& unit = {}, double factor = 1.0, std::optional<double> standard = {}) {
    NumberField::Spec made;
    made.low = low;
    made.high = high;
    made.step = step;
    made.decimals = decimals;
    made.unit = unit;
    made.factor = factor;
    made.standard = standard;
    return made;
}

}  // namespace

MappingForm::MappingForm(StudioDocument& document, MappingModel& model, QWidget* parent) : QWidget(parent), document_(document), model_(model) {
    new QVBoxLayout(this);
    layout()->setContentsMargins(0, 0, 0, 0);
    connect(&model, &QAbstractItemModel::dataChanged, this, &MappingForm::refresh);
    connect(&model, &QAbstractItemModel::modelReset, this, &MappingForm::refresh);
    connect(&Appearance::instance(), &Appearance::changed, this, &MappingForm::rebuild);
    rebuild();
}

void MappingForm::show(int row) {
    const InputMapping* m = model_.mapping(row);
    if (gesture_ && !(m && shown_ && m->sameLine(line_))) gesture_.reset();  // what is being edited is of another row
    shown_ = m != nullptr;
    filled_ = false;
    if (m) line_ = *m;
    if (m && targetText(document_.document(), m->target).unit != unit_) return rebuild();
    refresh();
}

void MappingForm::execute(const std::function<void(InputMapping&)>& change) {
    const InputMapping* m = mapping();
    if (!m) return;
    InputMapping made = *m;
    change(made);
    if (!(made == *m)) document_.execute(commands::mapInput(made));
}

NumberField* MappingForm::addNumber(int row, int column, const QString& label, const char* name, const QString& help, NumberField::Spec of, Get get, Set set) {
    auto* field = named(new NumberField(std::move(of), body_), name);
    field->setAccessibleName(label);
    field->setToolTip(help);
    field->setMinimumWidth(px(58));
    field->setSizePolicy(QSizePolicy::Ignored, field->sizePolicy().verticalPolicy());  // both columns are alike
    grid_->addWidget(field, row, column);
    connect(field, &NumberField::editStarted, this, [this] { gesture_ = std::make_unique<Gesture>(document_); });
    connect(field, &NumberField::valueEdited, this, [this, set = std::move(set)](double value) { execute([&](InputMapping& m) { set(m, value); }); });
    connect(field, &NumberField::editEnded, this, [this](bool keep) {
        if (keep && gesture_) gesture_->commit();
        gesture_.reset();
        filled_ = false;
        refresh();
    });
    refreshers_.push_back([field, get = std::move(get)](const InputMapping& m) { field->setValue(get(m)); });
    return field;
}

void MappingForm::rebuild() {
    gesture_.reset();
    filled_ = false;
    refreshers_.clear();
    if (body_) body_->deleteLater();
    body_ = new QWidget(this);
    const TargetText target = targetText(document_.document(), line_.target);
    unit_ = target.unit;
    title_ = new ElidedLabel(body_);
    styled(static_cast<QLabel*>(title_), "section");
    conflict_ = styled(new QLabel(body_), "warning");
    conflict_->setWordWrap(true);
    grid_ = new QGridLayout;
    grid_->setHorizontalSpacing(px(6));
    grid_->setVerticalSpacing(px(5));
    const auto label = [this](int row, int column, const QString& text) {
        auto* l = styled(new QLabel(text, body_), "muted");
        grid_->addWidget(l, row, column, Qt::AlignLeft | Qt::AlignVCenter);
    };

    label(0, 0, tr("Control"));
    const double largest = InputValue::kLargest;
    // A range is never empty: the end that is not edited gives way.
    addNumber(0, 1, tr("Control from"), "inLow", tr("Where the range of the control begins."), spec(-largest, largest, 0.01, 3), [](const InputMapping& m) { return m.row.curve.inLow; },
              [](InputMapping& m, double v) { m.row.curve.inLow = v, m.row.curve.inHigh = std::max(m.row.curve.inHigh, v + 1e-3); });
    addNumber(0, 2, tr("Control to"), "inHigh", tr("Where the range of the control ends."), spec(-largest, largest, 0.01, 3), [](const InputMapping& m) { return m.row.curve.inHigh; },
              [](InputMapping& m, double v) { m.row.curve.inHigh = v, m.row.curve.inLow = std::min(m.row.curve.inLow, v - 1e-3); });

    label(1, 0, tr("Becomes"));
    const bool angle = unit_ == u"°";
    const double reach = angle ? kHalfTurns : 1e6;
    const auto outSpec = spec(-reach, reach, angle ? 1.0 : 0.01, angle ? 0 : 3, unit_, target.factor);
    addNumber(1, 1, tr("Becomes from"), "outLow", tr("What the beginning of the range becomes, from rest."), outSpec, [](const InputMapping& m) { return m.row.curve.outLow; }, [](InputMapping& m, double v) { m.row.curve.outLow = v; });
    addNumber(1, 2, tr("Becomes to"), "outHigh", tr("What the end of the range becomes, from rest."), outSpec, [](const InputMapping& m) { return m.row.curve.outHigh; }, [](InputMapping& m, double v) { m.row.curve.outHigh = v; });
    auto* invert = named(new QToolButton(body_), "invert");
    invert->setProperty("small", true);
    invert->setIcon(themedIcon(QStringLiteral("swap")));
    invert->setIconSize(QSize(px(17), px(17)));
    invert->setToolTip(tr("Turn the direction round"));
    invert->setAccessibleName(invert->toolTip());
    connect(invert, &QToolButton::clicked, this, [this] { execute([](InputMapping& m) { std::swap(m.row.curve.outLow, m.row.curve.outHigh); }); });
    grid_->addWidget(invert, 1, 3);

    label(2, 0, tr("Curve"));
    addNumber(2, 1, tr("Curve"), "exponent", tr("1: straight. More: finer near the beginning, or near the middle of a control that has its rest there."), spec(1.0 / InputMapping::kLargestExponent, InputMapping::kLargestExponent, 0.02, 2, {}, 1.0, 1.0),
              [](const InputMapping& m) { return m.row.curve.exponent; }, [](InputMapping& m, double v) { m.row.curve.exponent = v; });
    addNumber(2, 2, tr("Dead zone"), "deadZone", tr("Dead zone: this part of the range, next to its beginning or middle, counts as that."), spec(0.0, InputMapping::kLargestDeadZone, 0.5, 0, QStringLiteral("%"), 100.0, 0.0),
              [](const InputMapping& m) { return m.row.curve.deadZone; }, [](InputMapping& m, double v) { m.row.curve.deadZone = v; });

    label(3, 0, tr("Smoothing"));
    addNumber(3, 1, tr("Smoothing"), "smoothing", tr("How late what stands still is followed; 0: nothing is smoothed. What moves fast is followed sooner, by the number beside."), spec(0.0, kLongestSmoothing, 1.0, 0, QStringLiteral("ms"), 1000.0, 0.0), smoothingOf, setSmoothing);
    addNumber(3, 2, tr("Reaction"), "reaction", tr("Reaction: the more, the sooner fast motion is followed (Hz per unit of the control and second)."), spec(0.0, InputMapping::kLargestHertz, 0.05, 2, {}, 1.0, 0.0),
              [](const InputMapping& m) { return m.row.filter.reaction; }, [](InputMapping& m, double v) { m.row.filter.reaction = v; });

    label(4, 0, tr("Spring"));
    addNumber(4, 1, tr("Spring"), "spring", tr("What is driven hangs on a spring that swings so fast; 0: no spring."), spec(0.0, InputMapping::kFastestSpring, 0.05, 1, QStringLiteral("Hz"), 1.0, 0.0), [](const InputMapping& m) { return m.row.spring.hertz; },
              [](InputMapping& m, double v) { m.row.spring.hertz = v; });
    addNumber(4, 2, tr("Damping of the spring"), "springDamping", tr("Damping: at 100 % it does not swing beyond."), spec(Spring::kLeastDamping, 1.0, 0.5, 0, QStringLiteral("%"), 100.0, Spring().damping), [](const InputMapping& m) { return m.row.spring.damping; },
              [](InputMapping& m, double v) { m.row.spring.damping = v; });

    label(5, 0, tr("In silence"));
    silence_ = named(new QComboBox(body_), "silence");
    silence_->addItems({tr("Holds"), tr("Glides to rest"), tr("Next row")});
    silence_->setAccessibleName(tr("In silence"));
    silence_->setToolTip(tr("What happens when nothing is heard for longer than the time beside."));
    silence_->setMinimumWidth(px(58));
    silence_->setSizePolicy(QSizePolicy::Ignored, silence_->sizePolicy().verticalPolicy());
    connect(silence_, &QComboBox::activated, this, [this](int i) { execute([i](InputMapping& m) { m.row.silence = InputRow::Silence(i); }); });
    refreshers_.push_back([this](const InputMapping& m) { silence_->setCurrentIndex(int(m.row.silence)); });
    grid_->addWidget(silence_, 5, 1);
    addNumber(5, 2, tr("Silent after"), "after", tr("Silent after so many seconds; 0: never."), spec(0.0, InputMapping::kLongestAfter, 0.05, 1, QStringLiteral("s"), 1.0, 0.0), [](const InputMapping& m) { return m.row.after; },
              [](InputMapping& m, double v) { m.row.after = v; });

    label(6, 0, tr("A press"));
    auto* press = named(new QComboBox(body_), "press");
    press->addItems({tr("Counts while it is held"), tr("Switches on and off")});
    press->setAccessibleName(tr("A press"));
    press->setToolTip(tr("A button that is pressed counts while it is held, or switches: pressed once it is on, pressed again it is off."));
    press->setSizePolicy(QSizePolicy::Ignored, press->sizePolicy().verticalPolicy());
    press->setEnabled(!target.trigger);
    connect(press, &QComboBox::activated, this, [this](int i) { execute([i](InputMapping& m) { m.row.toggles = i == 1; }); });
    refreshers_.push_back([press](const InputMapping& m) { press->setCurrentIndex(m.row.toggles ? 1 : 0); });
    grid_->addWidget(press, 6, 1, 1, 2);

    label(7, 0, tr("Other side"));
    auto* mirror = named(new Switch(body_), "mirror");
    mirror->setAccessibleName(tr("Other side"));
    const bool sided = !otherSideOfTarget(line_.target).empty();
    mirror->setEnabled(sided);
    mirror->setToolTip(sided ? tr("The same part of the other side does the same, mirrored, where no row of its own drives it.") : tr("What this row drives has no other side: names of sides end in .L and .R, or say left and right."));
    connect(mirror, &Switch::clicked, this, [this] { execute([](InputMapping& m) { m.mirrored = !m.mirrored; }); });
    refreshers_.push_back([mirror](const InputMapping& m) { mirror->setChecked(m.mirrored); });
    grid_->addWidget(mirror, 7, 1, Qt::AlignLeft);
    for (const int column : {1, 2}) grid_->setColumnStretch(column, 1);

    fill(new QVBoxLayout(body_), QMargins(0, 0, 0, 0), Spacing{px(6)}, title_, grid_, conflict_, Stretch{});
    layout()->addWidget(body_);
    refresh();
}

void MappingForm::refresh() {
    const int row = model_.rowOf(line_);
    const InputMapping* m = shown_ ? model_.mapping(row) : nullptr;
    body_->setVisible(m != nullptr);
    if (!m) return;
    const QString title = QStringLiteral("%1 → %2").arg(channelText(*m), targetText(document_.document(), m->target).text());
    if (title_->text() != title) title_->setText(title);
    const QString conflict = model_.conflict(row);
    if (conflict_->text() != conflict) conflict_->setText(conflict);
    conflict_->setVisible(!conflict.isEmpty());
    if (filled_ && *m == line_) return;  // meters alone have moved
    line_ = *m;
    filled_ = true;
    for (const auto& show : refreshers_) show(*m);
}

void MappingForm::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) rebuild();
}

}  // namespace imomushi
