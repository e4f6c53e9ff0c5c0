// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/inspector/inspector_panel.h"

#include <QColorDialog>
#include <QComboBox>
#include <QEvent>
#include <QGridLayout>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QScrollBar>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "core/base/parallel.h"
#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/tools/picking.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/switch.h"

namespace imomushi {
namespace {

using Kind = SelectionItem::Kind;
constexpr int kLiveMs = 120;
constexpr double kDegrees = 180.0 / std::numbers::pi;

// Linear light to what colour dialogs and style sheets speak (IEC 61966-2-1).
double toDisplay(double c) { return std::clamp(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055, 0.0, 1.0); }

QString scientific(double value) { return value == 0.0 ? QStringLiteral("0") : QLocale().toString(value, 'e', 1); }

QString vector(const Vec3& p) {
    const QLocale locale;
    // Rounded first: a zero has no sign.
    const auto text = [&](double value) { return locale.toString(std::round(value * 1e3) / 1e3 + 0.0, 'f', 3); };
    return QStringLiteral("%1  %2  %3").arg(text(p.x()), text(p.y()), text(p.z()));
}

}  // namespace

InspectorPanel::InspectorPanel(StudioDocument& document, QWidget* parent) : QScrollArea(parent), document_(document) {
    setWidgetResizable(true);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setFrameShape(QFrame::NoFrame);
    // Several changes of one event are shown once.
    const auto soon = [this] {
        if (scheduled_) return;
        scheduled_ = true;
        QMetaObject::invokeMethod(this, &InspectorPanel::update, Qt::QueuedConnection);
    };
    connect(&document, &StudioDocument::selectionChanged, this, soon);
    connect(&document, &StudioDocument::structureChanged, this, soon);
    connect(&document, &StudioDocument::poseChanged, this, soon);
    connect(&document, &StudioDocument::responsesChanged, this, soon);
    connect(&document, &StudioDocument::fileChanged, this, soon);
    // Positions that change with every frame are told a few times a second.
    live_.setSingleShot(true);
    live_.setInterval(kLiveMs);
    connect(&live_, &QTimer::timeout, this, &InspectorPanel::update);
    connect(&document, &StudioDocument::frameStepped, this, [this] {
        if (!live_.isActive() && isVisible() && !shown_.empty() && shown_.back().kind == Kind::Endpoint) live_.start();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, [this, soon] {
        built_ = false;
        soon();
    });
    update();
}

InspectorPanel::~InspectorPanel() = default;

void InspectorPanel::changeEvent(QEvent* event) {
    QScrollArea::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) {
        built_ = false;
        update();
    }
}

const Element* InspectorPanel::element(const SelectionItem& item) const {
    const auto found = document_.document().elements.find(item.part);
    return found == document_.document().elements.end() ? nullptr : found->second.get();
}

const Bone* InspectorPanel::bone(const SelectionItem& item) const {
    const auto found = document_.document().bones.find(item.part);
    return found == document_.document().bones.end() ? nullptr : found->second.get();
}

std::string InspectorPanel::target(const SelectionItem& item) const {
    const Element* e = element(item);
    const Bone* b = bone(item);
    switch (item.kind) {
        case Kind::Element: return e ? e->name : std::string();
        case Kind::Face: return e ? e->name + "/" + item.face : std::string();
        case Kind::Bone: return b ? b->name : std::string();
        case Kind::Endpoint: return b ? b->name + (item.atEnd ? "/end" : "/start") : std::string();
    }
    return {};
}

QString InspectorPanel::place(const Bone::Place& place) const {
    if (const auto* face = std::get_if<FaceRef>(&place)) return QString::fromStdString(target({Kind::Face, face->element, face->face, false}));
    if (const auto* end = std::get_if<EndpointRef>(&place)) return QString::fromStdString(target({Kind::Endpoint, end->bone, {}, end->atEnd}));
    return vector(std::get<Vec3>(place));
}

std::optional<Vec3> InspectorPanel::at(const Bone::Place& place, int depth) const {
    if (const auto* face = std::get_if<FaceRef>(&place)) {
        const Element* e = element({Kind::Element, face->element, {}, false});
        const int i = e ? e->faceIndex(face->face) : -1;
        return i < 0 ? std::nullopt : std::optional(e->faces[std::size_t(i)].frame.origin);
    }
    if (const auto* end = std::get_if<EndpointRef>(&place)) {
        const Bone* b = bone({Kind::Bone, end->bone, {}, false});
        return b && depth < 256 ? at(end->atEnd ? b->end : b->start, depth + 1) : std::nullopt;
    }
    return std::get<Vec3>(place);
}

void InspectorPanel::update() {
    scheduled_ = false;
    if (built_ && shown_ == document_.selection()) {
        refresh();
    } else {
        rebuild();
    }
}

void InspectorPanel::refresh() {
    for (const auto& f : refreshers_) f();
}

void InspectorPanel::rebuildSoon() {
    if (gesture_) return;  // the field that is being dragged stays; its end refreshes again
    built_ = false;
    if (scheduled_) return;
    scheduled_ = true;
    QMetaObject::invokeMethod(this, &InspectorPanel::update, Qt::QueuedConnection);
}

void InspectorPanel::rebuild() {
    refreshers_.clear();
    gesture_.reset();  // what was being edited is gone
    const int scrolled = shown_ == document_.selection() ? verticalScrollBar()->value() : 0;  // other rows of the same thing: stay where one looks
    shown_ = document_.selection();
    built_ = true;
    auto* old = takeWidget();
    if (old) old->deleteLater();
    body_ = new QWidget;
    body_->setObjectName(QStringLiteral("panel"));
    body_->setAttribute(Qt::WA_StyledBackground);
    setAccessibleName(tr("Properties"));
    sections_ = new QVBoxLayout(body_);
    sections_->setContentsMargins(px(14), px(12), px(12), px(14));
    sections_->setSpacing(px(9));

    // What is alike is edited together: the kind of the last one selected leads.
    Items alike;
    for (const SelectionItem& item : shown_)
        if (item.kind == shown_.back().kind && (element(item) || bone(item))) alike.push_back(item);
    if (alike.empty()) {
        buildCharacter();
    } else {
        switch (alike.back().kind) {
            case Kind::Element: buildElements(alike); break;
            case Kind::Face: buildFace(alike.back()); break;
            case Kind::Bone: buildBones(alike); break;
            case Kind::Endpoint: buildEndpoint(alike.back()); break;
        }
    }
    sections_->addStretch(1);
    setWidget(body_);
    refresh();
    verticalScrollBar()->setValue(scrolled);
}

// ---- parts of the form ------------------------------------------------------------------------------------------------

void InspectorPanel::heading(const QString& icon, const Say& title, const QString& kind) {
    auto* row = new QHBoxLayout;
    row->setSpacing(px(10));
    auto* picture = new QLabel(body_);
    picture->setPixmap(themedIcon(icon, Appearance::Role::Accent).pixmap(QSize(px(22), px(22)), devicePixelRatioF()));
    auto* text = new QLabel(body_);
    text->setProperty("role", "title");
    text->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    auto* what = new QLabel(kind, body_);
    what->setProperty("role", "muted");
    row->addWidget(picture);
    row->addWidget(text, 1);
    row->addWidget(what);
    sections_->addLayout(row);
    refreshers_.push_back([text, title] { text->setText(title()); });
    grid_ = nullptr;
}

void InspectorPanel::section(const QString& title) {
    if (!title.isEmpty()) {
        auto* rule = new QFrame(body_);
        rule->setObjectName(QStringLiteral("rule"));
        sections_->addSpacing(px(4));
        sections_->addWidget(rule);
        auto* label = new QLabel(title, body_);
        label->setProperty("role", "section");
        sections_->addWidget(label);
    }
    grid_ = new QGridLayout;
    grid_->setHorizontalSpacing(px(10));
    grid_->setVerticalSpacing(px(7));
    grid_->setColumnMinimumWidth(0, px(104));
    grid_->setColumnStretch(1, 1);
    sections_->addLayout(grid_);
}

void InspectorPanel::addRow(const QString& label, QWidget* field) {
    if (!grid_) section({});
    auto* text = new QLabel(label, body_);
    text->setProperty("role", "muted");
    text->setBuddy(field);
    field->setAccessibleName(label);
    field->setMinimumWidth(px(90));
    field->setSizePolicy(QSizePolicy::Ignored, field->sizePolicy().verticalPolicy());
    const int row = grid_->rowCount();
    grid_->addWidget(text, row, 0, Qt::AlignLeft | Qt::AlignVCenter);
    grid_->addWidget(field, row, 1);
}

void InspectorPanel::addFact(const QString& label, Say say) {
    auto* text = new QLabel(body_);
    text->setTextInteractionFlags(Qt::TextSelectableByMouse);
    text->setWordWrap(true);
    addRow(label, text);
    refreshers_.push_back([text, say = std::move(say)] { text->setText(say()); });
}

void InspectorPanel::addName(const SelectionItem& item) {
    auto* field = new QLineEdit(body_);
    addRow(tr("Name"), field);
    const auto current = [this, item] {
        const std::string full = target(item);
        return QString::fromStdString(item.kind == Kind::Face ? item.face : full);
    };
    connect(field, &QLineEdit::editingFinished, this, [this, field, item, current] {
        const QString name = field->text().trimmed();
        if (name.isEmpty() || name == current()) {
            field->setText(current());
            return;
        }
        if (!document_.execute({{"do", "rename"}, {"target", target(item)}, {"name", name.toStdString()}})) {
            field->setText(current());
            return;
        }
        // A face is known by its name: keep it selected under the new one.
        if (item.kind == Kind::Face) document_.select({{Kind::Face, item.part, name.toStdString(), false}});
    });
    refreshers_.push_back([field, current] {
        if (!field->hasFocus()) field->setText(current());
    });
}

NumberField* InspectorPanel::addNumber(const QString& label, NumberField::Spec spec, const Items& items, Get get,
                                       std::function<Json(const SelectionItem&, double)> command) {
    auto* field = new NumberField(std::move(spec), body_);
    addRow(label, field);
    connect(field, &NumberField::editStarted, this, [this] { gesture_ = std::make_unique<Gesture>(document_); });
    connect(field, &NumberField::valueEdited, this, [this, items, command = std::move(command)](double value) {
        for (const SelectionItem& item : items)
            if (!document_.execute(command(item, value))) break;
    });
    connect(field, &NumberField::editEnded, this, [this](bool keep) {
        if (keep && gesture_) gesture_->commit();
        gesture_.reset();
        refresh();
    });
    refreshers_.push_back([field, items, get = std::move(get)] {
        std::optional<double> common;
        for (const SelectionItem& item : items) {
            const auto value = get(item);
            if (!value) continue;
            if (common && std::abs(*common - *value) > 1e-12) {
                common.reset();
                break;
            }
            common = value;
        }
        field->setValue(common);
    });
    return field;
}

void InspectorPanel::addProperty(const QString& label, NumberField::Spec spec, const Items& items, Get get, const std::string& property) {
    addNumber(label, std::move(spec), items, std::move(get), [this, property](const SelectionItem& item, double value) {
        return Json{{"do", "set"}, {"target", target(item)}, {"property", property}, {"value", value}};
    });
}

void InspectorPanel::addChoice(const QString& label, const std::vector<std::pair<QString, Json>>& choices, std::function<Json()> current,
                               std::function<void(const Json&)> set) {
    auto* box = new QComboBox(body_);
    // Long names are cut, not the form.
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(6);
    std::vector<Json> values;
    for (const auto& [text, value] : choices) {
        box->addItem(text);
        values.push_back(value);
    }
    addRow(label, box);
    const auto show = [box, values, current = std::move(current)] {
        const Json now = current();
        int index = -1;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (values[i] == now) index = int(i);
        box->setCurrentIndex(index);
    };
    connect(box, &QComboBox::activated, this, [values, set = std::move(set), show](int index) {
        set(values[std::size_t(index)]);
        show();
    });
    refreshers_.push_back(show);
}

// ---- what can be selected -----------------------------------------------------------------------------------------------

void InspectorPanel::buildCharacter() {
    heading(QStringLiteral("character"), [] { return tr("Character"); }, {});
    section({});
    const auto set = [this](const char* property) {
        return [this, property](const Json& value) { document_.execute({{"do", "set"}, {"target", "character"}, {"property", property}, {"value", value}}); };
    };
    addChoice(tr("Joint modes"),
              {{tr("Affine (9 per face)"), "affine"},
               {tr("Paper (6 per face)"), "paper"},
               {tr("Warping 6 (15 per face)"), "modes:6"},
               {tr("Warping 12 (21 per face)"), "modes:12"},
               {tr("Warping 24 (33 per face)"), "modes:24"},
               {tr("Full (3 per vertex of a face)"), "full"}},
              [this] { return Json(basisName(document_.document().settings.basis)); }, set("basis"));
    addChoice(tr("Number format"), {{tr("Float (4 bytes)"), "float"}, {tr("Half (2 bytes)"), "half"}, {tr("Integer (2 bytes)"), "int16"}},
              [this] { return Json(formatName(document_.document().settings.format)); }, set("format"));
    addFact(tr("Format error"), [this] {
        const Character* character = document_.session().character();
        return character ? tr("%1 %").arg(QLocale().toString(100.0 * character->formatError(), 'g', 2)) : QStringLiteral("–");
    });
    std::vector<std::pair<QString, Json>> threads = {{tr("All (%1)").arg(hardwareThreads()), 0}};
    for (int n = 1; n <= hardwareThreads(); ++n) threads.emplace_back(QString::number(n), n);
    addChoice(tr("Threads"), threads, [this] { return Json(document_.document().settings.threads); }, set("threads"));

    section(tr("Contents"));
    addFact(tr("Elements"), [this] { return QLocale().toString(qlonglong(document_.document().elements.size())); });
    addFact(tr("Joints"), [this] { return QLocale().toString(qlonglong(document_.document().joints.size())); });
    addFact(tr("Bones"), [this] { return QLocale().toString(qlonglong(document_.document().bones.size())); });
    addFact(tr("Vertices"), [this] {
        qlonglong vertices = 0;
        for (const auto& [id, e] : document_.document().elements) vertices += e->mesh->body.vertices.rows();
        return QLocale().toString(vertices);
    });
    addFact(tr("Precomputed"), [this] {
        int fresh = 0, all = 0;
        double bytes = 0.0;
        for (const auto& [id, e] : document_.document().elements) {
            if (e->faces.empty()) continue;
            ++all;
            if (document_.session().responseState(id) != Session::ResponseState::Fresh) continue;
            ++fresh;
            if (const auto response = document_.session().response(id)) bytes += double(response->bytes());
        }
        return all == 0 ? tr("nothing to do") : tr("%1 of %2, %3").arg(fresh).arg(all).arg(bytesText(bytes));
    });
}

void InspectorPanel::buildElements(const Items& items) {
    const SelectionItem one = items.back();
    const bool several = items.size() > 1;
    if (several) {
        heading(QStringLiteral("element"), [n = items.size()] { return tr("%n element(s)", nullptr, int(n)); }, {});
    } else {
        heading(QStringLiteral("element"), [this, one] { return QString::fromStdString(target(one)); }, tr("Element"));
        section({});
        addName(one);
    }
    section(tr("Material"));
    const auto number = [this](double Element::*member) {
        return [this, member](const SelectionItem& item) -> std::optional<double> {
            const Element* e = element(item);
            return e ? std::optional(e->*member) : std::nullopt;
        };
    };
    const Element standard;
    addProperty(tr("Poisson ratio"), {{}, 0.0, 0.5, 0.005, 3, 1.0, standard.nu}, items, number(&Element::nu), "nu");
    addProperty(tr("Stiffness"), {QStringLiteral("×"), 1e-3, 1e3, 0.02, 3, 1.0, standard.stiffness}, items, number(&Element::stiffness), "stiffness");
    addProperty(tr("Density"), {QStringLiteral("kg/m³"), 1.0, 1e5, 10.0, 1, 1.0, standard.density}, items, number(&Element::density), "density");

    auto* swatch = new QToolButton(body_);
    swatch->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    swatch->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    addRow(tr("Colour"), swatch);
    const auto display = [this, one] {
        const Element* e = element(one);
        if (!e) return QColor();
        return QColor::fromRgbF(float(toDisplay(e->color.x())), float(toDisplay(e->color.y())), float(toDisplay(e->color.z())));
    };
    connect(swatch, &QToolButton::clicked, this, [this, items, display] {
        const QColor chosen = QColorDialog::getColor(display(), this, tr("Colour of the element"));
        if (!chosen.isValid()) return;
        Gesture gesture(document_);
        for (const SelectionItem& item : items) {
            if (!document_.execute({{"do", "set"}, {"target", target(item)}, {"property", "color"}, {"value", chosen.name().toStdString()}})) return;
        }
        gesture.commit();
    });
    refreshers_.push_back([swatch, display] {
        const QColor color = display();
        swatch->setStyleSheet(QStringLiteral("background: %1; border: 1px solid %2; border-radius: %3px; min-height: %4px; padding: 0px;")
                                  .arg(color.name(), themeColor(Appearance::Role::Line).name())
                                  .arg(px(6))
                                  .arg(px(22)));
        swatch->setToolTip(color.name());
    });

    static constexpr const char* kPlanes[] = {"auto", "bisector", "element"};
    addChoice(tr("Joint planes"), {{tr("Automatic"), "auto"}, {tr("Halfway between bones"), "bisector"}, {tr("Turn with the element"), "element"}},
              [this, items] {
                  Json common;
                  for (const SelectionItem& item : items) {
                      const Element* e = element(item);
                      const Json value = e ? Json(kPlanes[int(e->jointPlanes)]) : Json();
                      if (!common.is_null() && common != value) return Json();
                      common = value;
                  }
                  return common;
              },
              [this, items](const Json& value) {
                  Gesture gesture(document_);
                  for (const SelectionItem& item : items)
                      if (!document_.execute({{"do", "set"}, {"target", target(item)}, {"property", "joint-planes"}, {"value", value}})) return;
                  gesture.commit();
              });

    buildEffects(items);

    section(tr("Mesh"));
    const auto sum = [this, items](auto count) {
        qlonglong n = 0;
        for (const SelectionItem& item : items)
            if (const Element* e = element(item)) n += qlonglong(count(*e));
        return QLocale().toString(n);
    };
    addFact(tr("Vertices"), [sum] { return sum([](const Element& e) { return e.mesh->body.vertices.rows(); }); });
    addFact(tr("Triangles"), [sum] { return sum([](const Element& e) { return e.mesh->body.triangles.rows(); }); });
    addFact(tr("Joint faces"), [sum] { return sum([](const Element& e) { return e.faces.size(); }); });
    if (several) {
        section(tr("Precompute"));
        buildSolverMesh(items);
        return;
    }
    // The mesh of an element never changes under its id; look at it once.
    if (const Element* e = element(one)) {
        const MeshFacts facts = meshFacts(e->mesh->body);
        const Vec3 size = facts.high - facts.low;
        addFact(tr("Size"), [size] { return QStringLiteral("%1 × %2 × %3").arg(lengthText(size.x()), lengthText(size.y()), lengthText(size.z())); });
        addFact(tr("Volume"), [facts] { return volumeText(facts.volume); });
    }
    buildPrecompute(one);
}

void InspectorPanel::buildEffects(const Items& items) {
    section(tr("Effects here"));
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto effect = EffectKind(k);
        if (!isOfElements(effect)) continue;
        auto* button = new Switch(body_);
        addRow(effectTitle(effect), button);
        button->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
        grid_->setAlignment(button, Qt::AlignLeft | Qt::AlignVCenter);
        button->setToolTip(effectHelp(effect));
        const auto everywhere = [this, items, effect] {
            return std::all_of(items.begin(), items.end(), [&](const SelectionItem& item) { return document_.document().effects.has(effect, item.part); });
        };
        connect(button, &Switch::clicked, this, [this, items, effect, everywhere] {
            const bool on = !everywhere();
            Gesture gesture(document_);
            for (const SelectionItem& item : items) {
                if (!element(item) || document_.document().effects.has(effect, item.part) == on) continue;
                if (!document_.execute({{"do", on ? "enable" : "disable"}, {"effect", std::string(effectName(effect))}, {"target", target(item)}})) return;
            }
            gesture.commit();
        });
        refreshers_.push_back([button, everywhere] { button->setChecked(everywhere()); });
    }
}

void InspectorPanel::buildSolverMesh(const Items& items) {
    using Mesh = SolverMeshSetting::Kind;
    // The setting that all share.
    const auto common = [this, items]() -> std::optional<SolverMeshSetting> {
        std::optional<SolverMeshSetting> found;
        for (const SelectionItem& item : items) {
            const Element* e = element(item);
            if (!e) continue;
            if (found && !(*found == e->solverMesh)) return std::nullopt;
            found = e->solverMesh;
        }
        return found;
    };
    const auto command = [this](const SelectionItem& item, const SolverMeshSetting& setting) {
        return Json{{"do", "set"}, {"target", target(item)}, {"property", "solver-mesh"}, {"value", solverMeshName(setting)}};
    };
    addChoice(tr("Solver mesh"),
              {{tr("Default"), int(Mesh::Default)}, {tr("Best"), int(Mesh::Best)}, {tr("As it is"), int(Mesh::AsIs)}, {tr("Refined"), int(Mesh::Refined)}, {tr("Decimated"), int(Mesh::Decimated)}},
              [common] {
                  const auto now = common();
                  return now ? Json(int(now->kind)) : Json();
              },
              [this, items, command](const Json& value) {
                  const auto kind = Mesh(value.get<int>());
                  Gesture gesture(document_);
                  for (const SelectionItem& item : items) {
                      const Element* e = element(item);
                      if (!e || e->solverMesh.kind == kind) continue;
                      const auto vertices = int(std::min<Eigen::Index>(e->mesh->body.vertices.rows(), SolverMeshSetting::kMost));
                      int count = 0;
                      if (kind == Mesh::Refined) count = std::min(2 * vertices, SolverMeshSetting::kMost);
                      if (kind == Mesh::Decimated) count = std::max(vertices / 2, SolverMeshSetting::kFewest);
                      if (!document_.execute(command(item, {kind, count, e->solverMesh.tolerance}))) return;
                  }
                  gesture.commit();
              });
    const auto counted = [common] {
        const auto now = common();
        return now && (now->kind == Mesh::Refined || now->kind == Mesh::Decimated);
    };
    if (counted())
        addNumber(tr("To vertices"), {{}, SolverMeshSetting::kFewest, SolverMeshSetting::kMost, 10.0, 0, 1.0, {}}, items,
                  [this](const SelectionItem& item) -> std::optional<double> {
                      const Element* e = element(item);
                      return e ? std::optional(double(e->solverMesh.count)) : std::nullopt;
                  },
                  [this, command](const SelectionItem& item, double value) {
                      const Element* e = element(item);
                      SolverMeshSetting mesh = e ? e->solverMesh : SolverMeshSetting{Mesh::Refined};
                      mesh.count = int(std::lround(value));
                      return command(item, mesh);
                  });
    // Only large meshes take notice of it.
    const auto tolerant = [this, items] {
        return std::any_of(items.begin(), items.end(), [&](const SelectionItem& item) {
            const Element* e = element(item);
            return e && (e->solverMesh.tolerance != SolverMeshSetting::kUsualTolerance || document_.session().responseEstimate(item.part).hierarchical);
        });
    };
    if (tolerant()) {
        std::vector<std::pair<QString, Json>> choices;
        for (const double tolerance : {1e-6, SolverMeshSetting::kUsualTolerance, 1e-4, 1e-3, 1e-2}) choices.emplace_back(QLocale().toString(tolerance, 'f', QLocale::FloatingPointShortest), tolerance);
        addChoice(tr("Tolerance"), choices,
                  [common] {
                      const auto now = common();
                      return now ? Json(now->tolerance) : Json();
                  },
                  [this, items, command](const Json& value) {
                      Gesture gesture(document_);
                      for (const SelectionItem& item : items) {
                          const Element* e = element(item);
                          if (!e) continue;
                          SolverMeshSetting mesh = e->solverMesh;
                          mesh.tolerance = value.get<double>();
                          if (!(mesh == e->solverMesh) && !document_.execute(command(item, mesh))) return;
                      }
                      gesture.commit();
                  });
    }
    const auto parts = [this, items] {
        std::vector<std::shared_ptr<const Element>> found;
        for (const SelectionItem& item : items)
            if (const auto part = document_.document().elements.find(item.part); part != document_.document().elements.end()) found.push_back(part->second);
        return found;
    };
    // Looked at again only when an element is another one: a drag refreshes in every frame.
    refreshers_.push_back([this, parts, counted, tolerant, seen = parts(), hadCount = counted(), hadTolerance = tolerant()]() mutable {
        if (auto now = parts(); now != seen) {
            seen = std::move(now);
            if (counted() != hadCount || tolerant() != hadTolerance) rebuildSoon();
        }
    });
}

void InspectorPanel::buildPrecompute(const SelectionItem& item) {
    section(tr("Precompute"));
    Session& session = document_.session();
    const auto faces = [this, item] {
        const Element* e = element(item);
        return e && !e->faces.empty();
    };
    const auto response = [&session, item, faces] { return faces() ? session.response(item.part) : nullptr; };
    addFact(tr("State"), [&session, item, faces] {
        if (!faces()) return tr("needs a joint face");
        switch (session.responseState(item.part)) {
            case Session::ResponseState::Fresh: return tr("Up to date");
            case Session::ResponseState::Stale: return tr("Out of date");
            case Session::ResponseState::None: break;
        }
        return tr("Not yet");
    });
    if (!faces()) {
        refreshers_.push_back([this, faces] {
            if (faces()) rebuildSoon();
        });
        return;
    }
    buildSolverMesh({item});

    const auto percent = [](double share) { return tr("%1 %").arg(QLocale().toString(100.0 * share, 'g', 2)); };
    const auto sharedWith = [this, &session, item, faces]() -> const Element* {
        const auto* shared = faces() ? session.sharedResponse(item.part) : nullptr;
        return shared ? element({Kind::Element, shared->from, {}, false}) : nullptr;
    };
    const auto addShared = [this, sharedWith] {
        if (sharedWith()) addFact(tr("Shared with"), [sharedWith] { return sharedWith() ? QString::fromStdString(sharedWith()->name) : QString(); });
    };
    const auto now = response();
    if (now) {
        // A fresh response is found by its content: these do not change while it stays fresh.
        const auto fact = [this, response](const QString& label, std::function<QString(const ElementResponse&)> say) {
            addFact(label, [response, say = std::move(say)] {
                const auto r = response();
                return r ? say(*r) : QStringLiteral("–");
            });
        };
        fact(tr("Estimated error"), [percent](const ElementResponse& r) { return r.quality.error < 0.0 ? tr("not known") : percent(r.quality.error); });
        if (now->quality.decimated) {
            fact(tr("Mapping error"), [percent](const ElementResponse& r) { return percent(r.quality.mappingError); });
            fact(tr("Shape error"), [percent](const ElementResponse& r) { return percent(r.quality.shapeError); });
        }
        fact(tr("Time taken"), [](const ElementResponse& r) { return r.quality.seconds > 0.0 ? durationText(r.quality.seconds) : tr("not known"); });  // files do not tell
        addShared();
        fact(tr("Solved with"), [](const ElementResponse& r) {
            const QLocale locale;
            const QString vertices = tr("%1 vertices").arg(locale.toString(r.quality.solverVertices));
            return r.quality.solverNodes == r.quality.solverVertices ? vertices : tr("%1, %2 nodes").arg(vertices, locale.toString(r.quality.solverNodes));
        });
        fact(tr("Columns"), [](const ElementResponse& r) { return QLocale().toString(r.columns()); });
        fact(tr("Memory"), [](const ElementResponse& r) { return bytesText(double(r.bytes())); });
        fact(tr("Residual"), [](const ElementResponse& r) { return scientific(r.quality.solve.residual); });
        fact(tr("Condition"), [](const ElementResponse& r) { return scientific(r.quality.solve.rcond); });
        fact(tr("Asymmetry"), [](const ElementResponse& r) { return tr("%1 %").arg(QLocale().toString(100.0 * r.quality.asymmetry, 'f', 2)); });
    } else {
        // Measured on the reference bodies (see solvedBody()); only solving tells of the others.
        addFact(tr("Typical error"), [this, item, percent] {
            const Element* e = element(item);
            switch (e ? e->solverMesh.kind : SolverMeshSetting::Kind::Refined) {
                case SolverMeshSetting::Kind::Default: return tr("below %1").arg(percent(0.02));
                case SolverMeshSetting::Kind::Best: return tr("below %1").arg(percent(0.01));
                case SolverMeshSetting::Kind::AsIs: return tr("up to %1").arg(percent(0.23));
                default: return tr("known afterwards");
            }
        });
        addFact(tr("Will take"), [&session, item, faces] {
            if (!faces()) return QStringLiteral("–");
            const ResponseEstimate estimate = session.responseEstimate(item.part);
            return tr("about %1, %2").arg(durationText(estimate.seconds), bytesText(double(estimate.bytes)));
        });
        addShared();
        auto* button = new QPushButton(themedIcon(QStringLiteral("precompute"), Appearance::Role::OnAccent), tr("Precompute"), body_);
        button->setProperty("primary", true);
        connect(button, &QPushButton::clicked, this, &InspectorPanel::precomputeWanted);
        sections_->addWidget(button);
    }
    // Which rows there are follows the state.
    const auto rows = [faces, response, sharedWith] {
        const auto r = response();
        return std::tuple(faces(), r != nullptr, r && r->quality.decimated, sharedWith() != nullptr);
    };
    refreshers_.push_back([this, rows, had = rows()] {
        if (rows() != had) rebuildSoon();
    });
}

void InspectorPanel::buildFace(const SelectionItem& item) {
    heading(QStringLiteral("face"), [item] { return QString::fromStdString(item.face); }, tr("Joint face"));
    section({});
    addName(item);
    const auto face = [this, item]() -> const JointFace* {
        const Element* e = element(item);
        const int i = e ? e->faceIndex(item.face) : -1;
        return i < 0 ? nullptr : &e->faces[std::size_t(i)];
    };
    const auto fact = [this, face](const QString& label, std::function<QString(const JointFace&)> say) {
        addFact(label, [face, say = std::move(say)] { return face() ? say(*face()) : QString(); });
    };
    addFact(tr("Element"), [this, item] { return QString::fromStdString(target({Kind::Element, item.part, {}, false})); });
    addFact(tr("Joined with"), [this, item] {
        QStringList others;
        for (const auto& [id, joint] : document_.document().joints) {
            const FaceRef me{item.part, item.face};
            if (std::find(joint->faces.begin(), joint->faces.end(), me) == joint->faces.end()) continue;
            for (const FaceRef& other : joint->faces)
                if (other != me) others << QString::fromStdString(target({Kind::Face, other.element, other.face, false}));
        }
        return others.isEmpty() ? tr("nothing") : others.join(QStringLiteral(", "));
    });
    section(tr("Patch"));
    fact(tr("Vertices"), [](const JointFace& f) { return QLocale().toString(qlonglong(f.vertices.size())); });
    fact(tr("Area"), [](const JointFace& f) { return tr("%1 cm²").arg(QLocale().toString(f.area * 1e4, 'g', 4)); });
    fact(tr("Size"), [](const JointFace& f) { return lengthText(2.0 * f.size); });
    fact(tr("Planarity error"), [](const JointFace& f) {
        return f.flat() ? tr("%1 (flat)").arg(lengthText(f.planarityError)) : tr("%1 (not flat: three more columns)").arg(lengthText(f.planarityError));
    });
    section(tr("Frame"));
    fact(tr("Origin (m)"), [](const JointFace& f) { return vector(f.frame.origin); });
    fact(tr("Normal"), [](const JointFace& f) { return vector(f.frame.axes.col(2)); });
}

void InspectorPanel::buildBones(const Items& items) {
    const SelectionItem one = items.back();
    const bool several = items.size() > 1;
    if (several) {
        heading(QStringLiteral("bone"), [n = items.size()] { return tr("%n bone(s)", nullptr, int(n)); }, {});
    } else {
        heading(QStringLiteral("bone"), [this, one] { return QString::fromStdString(target(one)); }, tr("Bone"));
        section({});
        addName(one);
        const Document& d = document_.document();
        // A bone cannot hang on itself or on what hangs on it.
        std::set<PartId> below = {one.part};
        for (bool grew = true; grew;) {
            grew = false;
            for (const auto& [id, b] : d.bones)
                if (below.contains(b->parent) && below.insert(id).second) grew = true;
        }
        std::vector<std::pair<QString, Json>> parents = {{tr("automatic"), ""}};
        for (const auto& [id, b] : d.bones)
            if (!below.contains(id)) parents.emplace_back(QString::fromStdString(b->name), b->name);
        addChoice(tr("Parent"), parents,
                  [this, one] {
                      const Bone* b = bone(one);
                      const Bone* p = b ? bone({Kind::Bone, b->parent, {}, false}) : nullptr;
                      return Json(p ? p->name : "");
                  },
                  [this, one](const Json& value) { document_.execute({{"do", "edit-bone"}, {"name", target(one)}, {"parent", value}}); });
        std::vector<std::pair<QString, Json>> elements = {{tr("none"), ""}};
        for (const auto& [id, e] : d.elements) elements.emplace_back(QString::fromStdString(e->name), e->name);
        addChoice(tr("Runs through"), elements,
                  [this, one] {
                      const Bone* b = bone(one);
                      const Element* e = b ? element({Kind::Element, b->element, {}, false}) : nullptr;
                      return Json(e ? e->name : "");
                  },
                  [this, one](const Json& value) { document_.execute({{"do", "edit-bone"}, {"name", target(one)}, {"element", value}}); });
    }
    section(tr("Rest"));
    if (!several) {
        addFact(tr("Length"), [this, one] {
            const Bone* b = bone(one);
            const auto from = b ? at(b->start) : std::nullopt, to = b ? at(b->end) : std::nullopt;
            return from && to ? lengthText((*to - *from).norm()) : QStringLiteral("–");
        });
        addFact(tr("Start"), [this, one] { return bone(one) ? place(bone(one)->start) : QString(); });
        addFact(tr("End"), [this, one] { return bone(one) ? place(bone(one)->end) : QString(); });
    }
    const auto number = [this](double Bone::*member) {
        return [this, member](const SelectionItem& item) -> std::optional<double> {
            const Bone* b = bone(item);
            return b ? std::optional(b->*member) : std::nullopt;
        };
    };
    const Bone standard;
    addProperty(tr("Roll"), {QStringLiteral("°"), -std::numbers::pi, std::numbers::pi, 1.0, 1, kDegrees, standard.roll}, items, number(&Bone::roll), "roll");
    section(tr("Stretch limits"));
    addProperty(tr("Shortest"), {QStringLiteral("%"), 0.01, 1.0, 1.0, 0, 100.0, standard.minStretch}, items, number(&Bone::minStretch), "min-stretch");
    addProperty(tr("Longest"), {QStringLiteral("%"), 1.0, 10.0, 1.0, 0, 100.0, standard.maxStretch}, items, number(&Bone::maxStretch), "max-stretch");
}

void InspectorPanel::buildEndpoint(const SelectionItem& item) {
    heading(QStringLiteral("pose"), [this, item] { return QString::fromStdString(target(item)); }, tr("Endpoint"));
    section({});
    const auto held = [this, item]() -> const Held* {
        const auto found = document_.document().held.find(EndpointRef{item.part, item.atEnd});
        return found == document_.document().held.end() ? nullptr : &found->second;
    };
    addFact(tr("State"), [held] {
        const Held* h = held();
        return !h ? tr("free") : h->pinned ? tr("pinned") : tr("held");
    });
    addFact(tr("At rest (m)"), [this, item] {
        const Bone* b = bone(item);
        const auto p = b ? at(item.atEnd ? b->end : b->start) : std::nullopt;
        return p ? vector(*p) : QStringLiteral("–");
    });
    const auto shown = [this, item] { return endpointPosition(document_.session(), {item.part, item.atEnd}); };
    addFact(tr("Now (m)"), [shown] { return shown() ? vector(*shown()) : QStringLiteral("–"); });
    section(tr("Target"));
    const auto now = [held, shown]() -> std::optional<Vec3> {
        const Held* h = held();
        return h ? std::optional(h->target) : shown();
    };
    static constexpr const char* kAxes[] = {"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis) {
        addNumber(QLatin1String(kAxes[axis]), {QStringLiteral("m"), -1e6, 1e6, 0.005, 4, 1.0, {}}, {item},
                  [now, axis](const SelectionItem&) -> std::optional<double> {
                      const auto p = now();
                      return p ? std::optional((*p)[axis]) : std::nullopt;
                  },
                  [this, now, axis](const SelectionItem& endpoint, double value) {
                      Vec3 p = now().value_or(Vec3::Zero());
                      p[axis] = value;
                      return Json{{"do", "drag"}, {"endpoint", target(endpoint)}, {"to", Json::array({p.x(), p.y(), p.z()})}};
                  });
    }
    auto* buttons = new QHBoxLayout;
    auto* pin = new QPushButton(themedIcon(QStringLiteral("pin")), {}, body_);
    auto* release = new QPushButton(themedIcon(QStringLiteral("release")), tr("Release"), body_);
    buttons->addWidget(pin);
    buttons->addWidget(release);
    sections_->addLayout(buttons);
    connect(pin, &QPushButton::clicked, this, [this, item, held] {
        const bool pinned = held() && held()->pinned;
        document_.execute({{"do", pinned ? "unpin" : "pin"}, {"endpoint", target(item)}});
    });
    connect(release, &QPushButton::clicked, this, [this, item] { document_.execute({{"do", "release"}, {"endpoint", target(item)}}); });
    refreshers_.push_back([pin, release, held] {
        const Held* h = held();
        pin->setText(h && h->pinned ? tr("Unpin") : tr("Pin"));
        release->setEnabled(h != nullptr);
    });
}

}  // namespace imomushi
