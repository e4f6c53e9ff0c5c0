// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/inspector/inspector_panel.h"

#include <QEvent>
#include <QScrollBar>
#include <QVBoxLayout>
#include <utility>

#include "ui/models/paths.h"
#include "ui/panels/inspector/inspector_forms.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

using Kind = SelectionItem::Kind;
constexpr int kLiveMs = 120;

}  // namespace

InspectorPanel::InspectorPanel(StudioDocument& document, QWidget* parent) : QScrollArea(parent), document_(document), host_(new QWidget(this)) {
    fill(new QVBoxLayout(host_), QMargins());
    setWidget(host_);
    setWidgetResizable(true);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFrameShape(QFrame::NoFrame);
    connect(&document, &StudioDocument::selectionChanged, this, &InspectorPanel::updateSoon);
    connect(&document, &StudioDocument::structureChanged, this, &InspectorPanel::updateSoon);
    connect(&document, &StudioDocument::poseChanged, this, &InspectorPanel::updateSoon);
    connect(&document, &StudioDocument::responsesChanged, this, &InspectorPanel::updateSoon);
    connect(&document, &StudioDocument::underWayChanged, this, &InspectorPanel::updateSoon);
    connect(&document, &StudioDocument::estimated, this, &InspectorPanel::updateSoon);
    connect(&document, &StudioDocument::fileChanged, this, &InspectorPanel::updateSoon);
    // Positions that change with every frame are told a few times a second.
    live_.setSingleShot(true);
    live_.setInterval(kLiveMs);
    connect(&live_, &QTimer::timeout, this, &InspectorPanel::update);
    connect(&document, &StudioDocument::frameStepped, this, [this] {
        if (!live_.isActive() && isVisible() && !shown_.empty() && shown_.back().kind == Kind::Endpoint) live_.start();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, [this] {
        built_ = false;
        updateSoon();
    });
    update();
}

void InspectorPanel::changeEvent(QEvent* event) {
    QScrollArea::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) {
        built_ = false;
        update();
    }
}

void InspectorPanel::updateSoon() {
    if (scheduled_) return;
    scheduled_ = true;
    QMetaObject::invokeMethod(this, &InspectorPanel::update, Qt::QueuedConnection);
}

void InspectorPanel::update() {
    scheduled_ = false;
    if (built_ && shown_ == document_.selection()) {
        form_->refresh();
    } else {
        rebuild();
    }
}

void InspectorPanel::rebuild() {
    const int scrolled = shown_ == document_.selection() ? verticalScrollBar()->value() : 0;  // other rows of the same thing: stay where one looks
    shown_ = document_.selection();
    built_ = true;
    if (form_) {
        // It may be that one of its buttons waits for a dialog. Hidden it costs nothing; to take it out of the window would style all of its parts anew.
        form_->retire();
        form_->hide();
        host_->layout()->removeWidget(form_);
        form_->deleteLater();
    }
    setAccessibleName(tr("Properties"));
    form_ = makeForm();
    static_cast<QVBoxLayout*>(form_->layout())->addStretch(1);
    connect(form_, &InspectorForm::rowsChanged, this, [this] {
        built_ = false;
        updateSoon();
    });
    connect(form_, &InspectorForm::precomputeWanted, this, &InspectorPanel::precomputeWanted);
    connect(form_, &InspectorForm::placeWanted, this, &InspectorPanel::placeWanted);
    if (std::exchange(partShown_, false)) Q_EMIT partWanted(0, {});
    connect(form_, &InspectorForm::partWanted, this, [this](PartId character, const std::vector<std::int32_t>& triangles) {
        partShown_ = !triangles.empty();
        Q_EMIT partWanted(partShown_ ? character : 0, triangles);
    });
    host_->layout()->addWidget(form_);
    form_->refresh();
    verticalScrollBar()->setValue(scrolled);
}

InspectorForm* InspectorPanel::makeForm() {
    // What is alike is edited together: the kind of the last one selected leads.
    InspectorForm::Items alike;
    for (const SelectionItem& item : shown_)
        if (item.kind == shown_.back().kind && (elementOf(document_.document(), item) || boneOf(document_.document(), item) || characterOf(document_.document(), item))) alike.push_back(item);
    if (alike.empty()) return new CharacterForm(document_, host_);
    switch (alike.back().kind) {
        case Kind::Element: return new ElementForm(document_, alike, host_);
        case Kind::Face:
            if (handleOf(document_.document(), alike.back())) return new HandleForm(document_, alike.back(), host_);
            return new FaceForm(document_, alike.back(), host_);
        case Kind::Bone: return new BoneForm(document_, alike, host_);
        case Kind::Character: return new WholeCharacterForm(document_, alike.back(), host_);
        case Kind::Cut: return new CutForm(document_, alike.back(), host_);
        case Kind::Endpoint: break;
    }
    return new EndpointForm(document_, alike.back(), host_);
}

}  // namespace imomushi
