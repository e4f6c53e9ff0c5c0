// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/effects_panel.h"

#include <QCheckBox>
#include <QEvent>
#include <QGridLayout>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "core/document/effect_meetings.h"
#include "core/live/pose_check.h"
#include "ui/models/commands.h"
#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/figure_label.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/switch.h"

namespace imomushi {
namespace {

/// Measured times are told so often: numbers that change faster cannot be read.
constexpr int kTellMs = 350;
/// A pose is looked at so long after it changed.
constexpr int kCheckMs = 400;

/// What an effect would mend, in one sentence.
QString findingText(PoseFinding::Kind kind, double measure) {
    switch (kind) {
        case PoseFinding::Kind::Fold: return EffectsPanel::tr("This pose folds the surface.");
        case PoseFinding::Kind::Crossing: return EffectsPanel::tr("In this pose an element passes through its joint.");
        case PoseFinding::Kind::Volume: return EffectsPanel::tr("In this pose the volume is off by %1 %.").arg(QLocale().toString(100.0 * std::abs(measure), 'f', 0));
        case PoseFinding::Kind::Crease: return EffectsPanel::tr("This pose creases the surface at a joint.");
        case PoseFinding::Kind::Twist: break;
    }
    return {};
}

/// How a setting is shown and dragged: times below a second in ms, steps of a twentieth of the default's power of ten.
NumberField::Spec specOf(EffectKind effect, const EffectProperty& property, int part) {
    static const Effects atFirst;
    const double* standard = atFirst[effect].values.data() + Effects::valueOffset(effect, property.name);
    NumberField::Spec spec;
    spec.low = property.low;
    spec.high = property.high;
    spec.standard = standard[part];
    double size = 0.0;
    for (int i = 0; i < property.size; ++i) size = std::max(size, std::abs(standard[i]));
    if (size == 0.0) size = property.unit == "Pa" ? 1000.0 : 0.2;
    if (property.unit == "s" && size < 1.0) {
        spec.factor = 1000.0;
        spec.unit = QStringLiteral("ms");
    } else if (property.unit == "m/s^2") {
        spec.unit = QStringLiteral("m/s²");
    } else {
        spec.unit = QString::fromUtf8(property.unit.data(), qsizetype(property.unit.size()));
    }
    const double power = std::pow(10.0, std::floor(std::log10(size * spec.factor)));
    spec.step = power / 20.0;
    spec.decimals = std::max(0, 2 - int(std::lround(std::log10(power))));
    if (property.whole) {
        spec.step = 1.0;
        spec.decimals = 0;
    }
    return spec;
}

}  // namespace

EffectsPanel::EffectsPanel(StudioDocument& document, QWidget* parent) : QScrollArea(parent), document_(document) {
    setWidgetResizable(true);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFrameShape(QFrame::NoFrame);
    const auto soon = [this] {
        if (scheduled_) return;
        scheduled_ = true;
        QMetaObject::invokeMethod(this, &EffectsPanel::refresh, Qt::QueuedConnection);
    };
    connect(&document, &StudioDocument::structureChanged, this, soon);
    connect(&document, &StudioDocument::responsesChanged, this, soon);
    connect(&document, &StudioDocument::underWayChanged, this, soon);
    connect(&document, &StudioDocument::fileChanged, this, soon);
    connect(&document, &StudioDocument::frameStepped, this, [this] {
        stepped_.start();
        if (!tell_.isActive() && isVisible()) tell_.start();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, &EffectsPanel::rebuild);
    tell_.setInterval(kTellMs);
    connect(&tell_, &QTimer::timeout, this, [this] {
        showPrices();
        if (stepped_.elapsed() > kTellMs) tell_.stop();
    });
    check_.setInterval(kCheckMs);
    check_.setSingleShot(true);
    connect(&check_, &QTimer::timeout, this, &EffectsPanel::checkPose);
    connect(&watches_, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed) checkPose();
    });
    const auto look = [this] {
        if (!check_.isActive() && isVisible()) check_.start();
    };
    connect(&document, &StudioDocument::poseChanged, this, look);
    connect(&document, &StudioDocument::frameStepped, this, look);
    connect(&document, &StudioDocument::structureChanged, this, look);
    rebuild();
}

EffectsPanel::~EffectsPanel() = default;

void EffectsPanel::changeEvent(QEvent* event) {
    QScrollArea::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) rebuild();
}

void EffectsPanel::showEvent(QShowEvent* event) {
    QScrollArea::showEvent(event);
    if (!check_.isActive()) check_.start();
}

// The button that is held cannot be let go of any more.
void EffectsPanel::hideEvent(QHideEvent* event) {
    comparison_.reset();
    QScrollArea::hideEvent(event);
}

bool EffectsPanel::event(QEvent* event) {
    if (event->type() == QEvent::WindowDeactivate) comparison_.reset();
    return QScrollArea::event(event);
}

void EffectsPanel::setCosts(const std::array<EffectCost, kEffects>& costs) {
    costs_ = costs;
    known_ = true;
    if (!gesture_) showPrices();  // the end of the gesture shows them
}

void EffectsPanel::rebuild() {
    gesture_.reset();
    comparison_.reset();
    check_.start();
    auto* old = takeWidget();
    if (old) old->deleteLater();
    auto* body = new QWidget;
    usePanelBackground(body);
    setAccessibleName(tr("Effects"));
    auto* all = fill(new QVBoxLayout(body), QMargins(px(14), px(12), px(12), px(14)), Spacing{px(4)});

    auto* title = styled(new QLabel(tr("All effects"), body), "section");
    sum_ = named(new FigureLabel(body), "effectSum");
    sum_->setToolTip(tr("Processor time of one frame with all effects that are on, without drawing. At rest nothing is computed."));
    all->addLayout(fill(new QHBoxLayout, title, Stretch{}, sum_));
    auto* rule = named(new QFrame(body), "rule");
    fill(all, Space{px(2)}, rule, Space{px(2)});

    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        const QString name = QString::fromUtf8(effectName(effect).data(), qsizetype(effectName(effect).size()));
        Row& r = rows_[k];
        const bool dismissed = r.dismissed, open = r.open;
        r = {};
        r.dismissed = dismissed;
        r.open = open;
        auto* holder = new QWidget(body);
        r.layout = new QVBoxLayout(holder);
        r.layout->setContentsMargins(0, px(3), 0, px(3));
        r.layout->setSpacing(px(3));
        r.button = new Switch(holder);
        r.button->setObjectName(name);
        r.button->setAccessibleName(effectTitle(effect));
        r.button->setAccessibleDescription(effectHelp(effect));
        auto* text = new QLabel(effectTitle(effect), holder);
        r.price = new FigureLabel(holder);
        for (QWidget* w : {static_cast<QWidget*>(r.button), static_cast<QWidget*>(text)}) w->setToolTip(effectHelp(effect));
        r.layout->addLayout(fill(new QHBoxLayout, Spacing{px(9)}, r.button, text, Stretch{}, r.price));
        auto* help = styled(new QLabel(effectHelp(effect), holder), "muted");
        help->setWordWrap(true);
        help->setContentsMargins(r.button->sizeHint().width() + px(9), 0, 0, 0);
        r.layout->addWidget(help);

        r.needs = new QWidget(holder);
        auto* needs = new QHBoxLayout(r.needs);
        needs->setContentsMargins(r.button->sizeHint().width() + px(9), 0, 0, 0);
        r.needsText = styled(new QLabel(r.needs), "muted");
        auto* button = new QPushButton(r.needs);
        button->setProperty("flat", true);
        connect(button, &QPushButton::clicked, this, &EffectsPanel::precomputeWanted);
        r.precompute = button;
        fill(needs, r.needsText, button, Stretch{});
        r.needs->hide();
        r.layout->addWidget(r.needs);
        all->addWidget(holder);
        connect(r.button, &Switch::clicked, this, [this, effect] { turn(effect, !document_.turnedOn(effect)); });
    }
    all->addStretch(1);
    setWidget(body);
    refresh();
}

void EffectsPanel::reveal(EffectKind effect) {
    ensureWidgetVisible(row(effect).button->parentWidget());
    row(effect).button->setFocus(Qt::TabFocusReason);
}

void EffectsPanel::turn(EffectKind effect, bool on) {
    document_.executeSlow({commands::setEnabled(effect, on)});
    refresh();
}

void EffectsPanel::refresh() {
    scheduled_ = false;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        Row& r = rows_[k];
        const bool on = document_.document().effects.has(effect);
        if (on && r.offer && !comparison_) r.offer->hide();
        r.button->setChecked(document_.turnedOn(effect));
        if (on && !r.settings && (!effectProperties(effect).empty() || isOfElements(effect) || effectDescriptor(effect).canBeAutomatic)) buildSettings(effect);
        if (!on && r.settings) {
            gesture_.reset();
            r.refreshers.clear();
            r.settings->hide();
            r.settings->deleteLater();
            r.settings = nullptr;
        }
        for (const auto& f : r.refreshers) f();
    }
    showPrices();
}

void EffectsPanel::showPrices() {
    double together = 0.0;
    bool any = false;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        const Row& r = rows_[k];
        const bool on = document_.document().effects.has(effect);
        const auto measured = on ? document_.effectMilliseconds(effect) : std::nullopt;
        if (measured) {
            together += *measured;
            any = true;
            r.price->setText(frameTimeText(*measured));
            r.price->setToolTip(tr("Measured: per frame while it moves"));
        } else {
            const QString time = frameTimeText(costs_[k].milliseconds);
            r.price->setText(!known_ || document_.document().elements.empty() ? QString() : costs_[k].milliseconds < kShownMs ? time : tr("about %1").arg(time));
            r.price->setToolTip(tr("Predicted: per frame"));
        }
        r.price->setRole(measured ? Appearance::Role::Text : Appearance::Role::Muted);
        const bool needs = known_ && costs_[k].precompute;
        if (needs) {
            const QString text = tr("Needs precompute, about %1").arg(durationText(std::max(0.1, costs_[k].seconds)));
            r.needsText->setText(text);
            r.precompute->setText(text);
        }
        r.needsText->setVisible(!on);
        r.precompute->setVisible(on);  // what is on offers it
        r.needs->setVisible(needs);
    }
    const auto frame = document_.frameMilliseconds();
    const bool moving = stepped_.isValid() && stepped_.elapsed() <= kTellMs;
    QString text;
    if (any && frame) {
        const QLocale locale;
        text = tr("%1 of %2").arg(locale.toString(together, 'f', 2), frameTimeText(*frame));
        if (!moving) text = tr("at rest · %1").arg(text);
    }
    sum_->setText(text);
    sum_->setRole(moving ? Appearance::Role::Text : Appearance::Role::Muted);
}

void EffectsPanel::buildSettings(EffectKind effect) {
    Row& r = row(effect);
    r.settings = new QWidget(r.layout->parentWidget());
    auto* grid = new QGridLayout(r.settings);
    grid->setContentsMargins(r.button->sizeHint().width() + px(9), px(2), 0, px(6));
    grid->setHorizontalSpacing(px(10));
    grid->setVerticalSpacing(px(5));
    grid->setColumnMinimumWidth(0, px(104));
    grid->setColumnStretch(1, 1);
    if (effectDescriptor(effect).canBeAutomatic) addAutomatic(r, *grid, effect);
    if (isOfElements(effect)) addElements(r, *grid, effect);
    // How fast things swing and settle is for those who ask.
    const auto fine = [](const EffectProperty& property) { return property.unit == "Hz" || property.unit == "s"; };
    const auto properties = effectProperties(effect);
    for (const EffectProperty& property : properties)
        for (int part = 0; part < property.size && !fine(property); ++part) addNumber(r, *grid, effect, property, part);
    if (std::any_of(properties.begin(), properties.end(), fine)) {
        auto* more = new QWidget(r.settings);
        auto* lines = new QGridLayout(more);
        lines->setContentsMargins(0, 0, 0, 0);
        lines->setHorizontalSpacing(px(10));
        lines->setVerticalSpacing(px(5));
        lines->setColumnMinimumWidth(0, px(104));
        lines->setColumnStretch(1, 1);
        for (const EffectProperty& property : properties)
            for (int part = 0; part < property.size && fine(property); ++part) addNumber(r, *lines, effect, property, part);
        auto* disclose = named(new QToolButton(r.settings), "fine");
        disclose->setText(tr("Frequencies and times"));
        disclose->setProperty("link", true);
        disclose->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
        disclose->setFocusPolicy(Qt::TabFocus);
        const auto show = [this, effect, more, disclose](bool open) {
            row(effect).open = open;
            more->setVisible(open);
            disclose->setIcon(themedIcon(open ? QStringLiteral("chevron-down") : QStringLiteral("chevron-right"), Appearance::Role::Muted));
            disclose->setAccessibleDescription(open ? tr("shown") : tr("hidden"));
        };
        connect(disclose, &QToolButton::clicked, this, [this, effect, show] { show(!row(effect).open); });
        grid->addWidget(disclose, grid->rowCount(), 0, 1, 2, Qt::AlignLeft);
        grid->addWidget(more, grid->rowCount(), 0, 1, 2);
        show(r.open);
    }
    r.layout->addWidget(r.settings);
}

void EffectsPanel::addAutomatic(Row& r, QGridLayout& grid, EffectKind effect) {
    const bool meets = canWait(effect);
    auto* box = named(new QCheckBox(meets ? tr("Only on what comes near") : tr("Only where a pose calls for it"), r.settings), "automatic");
    box->setToolTip(meets ? tr("Elements are precomputed for it when they first come near others, and cost nothing before.")
                          : tr("Turns on by itself, element by element, before anything folds. Until then it costs nothing."));
    grid.addWidget(box, grid.rowCount(), 0, 1, 2);
    connect(box, &QCheckBox::clicked, this, [this, effect, meets](bool automatic) {
        // On the elements that it has: naming one of them keeps the others.
        const Document& d = document_.document();
        const auto& chosen = d.effects[effect].elements;
        std::optional<std::string> target;
        for (const auto& [id, element] : d.elements)
            if (chosen.contains(id) && !meets) target = element->name;
        document_.executeSlow({commands::enable(effect, target, automatic)});
        refresh();
    });
    r.refreshers.push_back([this, box, effect] { box->setChecked(document_.document().effects[effect].automatic); });
}

void EffectsPanel::buildOffer(EffectKind effect) {
    Row& r = row(effect);
    r.offer = named(new QWidget(r.layout->parentWidget()), "offer");
    auto* all = new QVBoxLayout(r.offer);
    fill(all, QMargins(r.button->sizeHint().width() + px(9), 0, 0, px(4)), Spacing{px(4)});
    r.offerText = new QLabel(r.offer);
    r.offerText->setWordWrap(true);
    auto* dismiss = named(new QToolButton(r.offer), "dismiss");
    dismiss->setText(QStringLiteral("✕"));
    dismiss->setAutoRaise(true);
    dismiss->setAccessibleName(tr("Not now"));
    dismiss->setToolTip(tr("Not now"));
    all->addLayout(fill(new QHBoxLayout, Share{r.offerText, 1}, Share{dismiss, 0, Qt::AlignTop}));
    auto* line = fill(new QHBoxLayout, Spacing{px(6)});
    const bool automatic = effectDescriptor(effect).canBeAutomatic;
    r.take = new QPushButton(tr("Turn on"), r.offer);
    r.take->setToolTip(automatic ? tr("Turns it on only where a pose calls for it.") : effectHelp(effect));
    r.compare = new QPushButton(tr("Hold to compare"), r.offer);
    r.compare->setToolTip(tr("Shows the pose with the effect while you press."));
    r.take->setObjectName(QStringLiteral("take"));
    r.compare->setObjectName(QStringLiteral("compare"));
    for (QPushButton* button : {r.take, r.compare}) line->addWidget(button);
    line->addStretch(1);
    all->addLayout(line);
    r.layout->addWidget(r.offer);
    connect(r.take, &QPushButton::clicked, this, [this, effect, automatic] {
        document_.executeSlow({commands::enable(effect, {}, automatic ? std::optional(true) : std::nullopt)});
        refresh();
    });
    connect(r.compare, &QPushButton::pressed, this, [this, effect] { compare(effect, true); });
    connect(r.compare, &QPushButton::released, this, [this, effect] { compare(effect, false); });
    connect(dismiss, &QToolButton::clicked, this, [this, effect] {
        row(effect).dismissed = true;
        row(effect).offer->hide();
    });
}

void EffectsPanel::forgetOffers() {
    for (Row& r : rows_) {
        r.dismissed = false;
        if (r.offer) r.offer->hide();
    }
}

void EffectsPanel::compare(EffectKind effect, bool on) {
    comparison_.reset();
    if (!on) return;
    comparison_ = std::make_unique<Gesture>(document_);
    document_.execute(commands::enable(effect), true);
}

void EffectsPanel::checkPose() {
    if (comparison_ || gesture_ || !isVisible() || watches_.running()) return;
    if (auto missing = document_.session().missingWatches(); !missing.empty()) return watches_.start(std::move(missing));
    const auto findings = document_.session().checkPose();
    const auto mend = findings ? mendOf(*findings) : std::nullopt;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        Row& r = row(effect);
        const bool wanted = mend == effect && !r.dismissed && !document_.document().effects.has(effect);
        if (wanted && !r.offer) buildOffer(effect);
        if (!r.offer) continue;
        // It stays until it is answered, also where the pose does not call for it any more.
        if (!wanted && !r.dismissed && !document_.document().effects.has(effect) && r.offer->isVisibleTo(this)) continue;
        if (wanted) {
            const auto first = std::find_if(findings->begin(), findings->end(), [&](const PoseFinding& f) { return f.mend == effect; });
            r.offerText->setText(findingText(first->kind, first->measure));
        }
        r.offer->setVisible(wanted);
    }
}

void EffectsPanel::addNumber(Row& r, QGridLayout& grid, EffectKind effect, const EffectProperty& property, int part) {
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    QString title = effectPropertyTitle(property);
    if (property.size > 1) title += QStringLiteral(" %1").arg(QLatin1String(kAxes[part]));
    auto* label = styled(new QLabel(title, r.settings), "muted");
    auto* field = new NumberField(specOf(effect, property, part), r.settings);
    field->setObjectName(QString::fromUtf8(property.name.data(), qsizetype(property.name.size())));
    field->setAccessibleName(title);
    label->setToolTip(effectPropertyHelp(property));
    field->setAccessibleDescription(effectPropertyHelp(property));
    field->setSizePolicy(QSizePolicy::Ignored, field->sizePolicy().verticalPolicy());
    label->setBuddy(field);
    const int line = grid.rowCount();
    grid.addWidget(label, line, 0);
    grid.addWidget(field, line, 1);

    const auto at = std::size_t(Effects::valueOffset(effect, property.name));
    connect(field, &NumberField::editStarted, this, [this] { gesture_ = std::make_unique<Gesture>(document_); });
    connect(field, &NumberField::valueEdited, this, [this, effect, &property, at, part](double value) {
        const auto& present = document_.document().effects[effect].values;
        std::vector<double> values(present.begin() + std::ptrdiff_t(at), present.begin() + std::ptrdiff_t(at) + property.size);
        values[std::size_t(part)] = value;
        document_.execute(commands::set(effect, property, values));
    });
    connect(field, &NumberField::editEnded, this, [this](bool keep) {
        if (keep && gesture_) gesture_->commit();
        gesture_.reset();
        refresh();
        showPrices();
    });
    r.refreshers.push_back([this, field, effect, at, part] { field->setValue(document_.document().effects[effect].values[at + std::size_t(part)]); });
}

void EffectsPanel::addElements(Row& r, QGridLayout& grid, EffectKind effect) {
    auto* label = styled(new QLabel(tr("Works on"), r.settings), "muted");
    auto* button = new QPushButton(r.settings);
    button->setProperty("field", true);
    button->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    button->setAccessibleName(tr("Works on"));
    label->setBuddy(button);
    const int line = grid.rowCount();
    grid.addWidget(label, line, 0);
    grid.addWidget(button, line, 1);
    auto* menu = new QMenu(button);
    menu->setWindowFlag(Qt::NoDropShadowWindowHint);
    button->setMenu(menu);
    connect(menu, &QMenu::aboutToShow, this, [this, menu, effect] {
        menu->clear();
        const Document& d = document_.document();
        QAction* everywhere = menu->addAction(tr("All elements"), this, [this, effect] { document_.executeSlow({commands::enable(effect)}); });
        everywhere->setCheckable(true);
        everywhere->setChecked(d.effects[effect].elements.empty());
        menu->addSeparator();
        for (const auto& [id, element] : d.elements) {
            const bool has = document_.turnedOn(effect, id);
            QString text = QString::fromStdString(element->name);
            text.replace(u'&', QStringLiteral("&&"));
            QAction* action = menu->addAction(text, this, [this, effect, has, target = element->name] {
                document_.executeSlow({commands::setEnabled(effect, !has, target)});
            });
            action->setCheckable(true);
            action->setChecked(has);
        }
    });
    r.refreshers.push_back([this, button, effect] {
        const Document& d = document_.document();
        const auto& chosen = d.effects[effect].elements;
        const auto some = std::count_if(d.elements.begin(), d.elements.end(), [&](const auto& e) { return chosen.contains(e.first); });
        const bool waits = waitsToMeet(d.effects, effect);
        button->setEnabled(!waits);  // it finds them by itself
        button->setText(!chosen.empty() ? tr("%1 of %2").arg(some).arg(d.elements.size()) : waits ? tr("None yet") : tr("All"));
        button->setToolTip(waits && chosen.empty() ? tr("No element has come near another one yet.") : QString());
    });
}

}  // namespace imomushi
