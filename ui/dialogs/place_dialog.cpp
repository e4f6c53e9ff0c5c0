// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/place_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QPushButton>
#include <QVBoxLayout>
#include <cmath>
#include <memory>

#include "core/base/try.h"
#include "core/document/names.h"
#include "core/mesh/bounds.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/tools/face_tool.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/dialog_form.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/number_field.h"

namespace imomushi {
namespace {

constexpr double kStep = 0.002, kRadius = 0.05, kTolerance = 1e-4;  // of the diagonal
constexpr const char* kAxisNames[] = {"X", "Y", "Z"};

QString titleOf(PlaceDialog::Kind kind) {
    switch (kind) {
        case PlaceDialog::Kind::Bone: return PlaceDialog::tr("Place a bone");
        case PlaceDialog::Kind::Face: return PlaceDialog::tr("Place a joint face");
        case PlaceDialog::Kind::Cut: return PlaceDialog::tr("Place a cut");
        case PlaceDialog::Kind::Handle: break;
    }
    return PlaceDialog::tr("Place a handle");
}

Vec3 valueOf(const std::array<NumberField*, 3>& fields) {
    Vec3 v = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) v[axis] = fields[std::size_t(axis)]->value().value_or(0.0);
    return v;
}

void setVector(const std::array<NumberField*, 3>& fields, const Vec3& value) {
    for (int axis = 0; axis < 3; ++axis) fields[std::size_t(axis)]->setValue(value[axis]);
}

/// The element that is meant by what is selected, else the first.
const Element* meantElement(const StudioDocument& document) {
    const Document& d = document.document();
    for (const SelectionItem& item : document.selection()) {
        if (const Element* element = elementOf(d, item)) return element;
        if (const CharacterSource* character = characterOf(d, item))
            if (const auto pieces = d.elementsOf(character->id); !pieces.empty()) return d.elements.at(pieces.front()).get();
    }
    return d.elements.empty() ? nullptr : d.elements.begin()->second.get();
}

}  // namespace

PlaceDialog::PlaceDialog(StudioDocument& document, Kind kind, QWidget* parent) : PlaceDialog(document, kind, std::nullopt, parent) {}
PlaceDialog::PlaceDialog(StudioDocument& document, const FaceRef& edited, QWidget* parent) : PlaceDialog(document, Kind::Face, std::optional(edited), parent) {}

PlaceDialog::PlaceDialog(StudioDocument& document, Kind kind, std::optional<FaceRef> edited, QWidget* parent)
    : QDialog(parent), document_(document), kind_(kind), edited_(std::move(edited)), sections_(new QVBoxLayout) {
    setWindowTitle(edited_ ? tr("Move a joint face") : titleOf(kind));
    setObjectName(QStringLiteral("placeDialog"));
    sections_->setSpacing(px(9));
    switch (kind) {
        case Kind::Bone: addBoneFields(); break;
        case Kind::Face:
        case Kind::Cut: addPlaneFields(); break;
        case Kind::Handle: addHandleFields(); break;
    }
    refused_ = named(new QLabel(this), "refused");
    refused_->setWordWrap(true);
    refused_->hide();
    auto* buttons = new QDialogButtonBox(this);
    place_ = named(buttons->addButton(edited_ ? tr("Move") : tr("Place"), QDialogButtonBox::AcceptRole), "place");
    place_->setDefault(true);
    buttons->addButton(tr("Cancel"), QDialogButtonBox::RejectRole)->setAutoDefault(false);
    connect(buttons, &QDialogButtonBox::accepted, this, &PlaceDialog::place);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    fill(new QVBoxLayout(this), QMargins(px(20), px(18), px(20), px(16)), Spacing{px(16)}, sections_, refused_, buttons);
}

DialogForm* PlaceDialog::addSection(const QString& title) {
    if (!title.isEmpty()) sections_->addWidget(styled(new QLabel(title, this), "section"));
    auto* form = new DialogForm;
    sections_->addLayout(form);
    return form;
}

std::array<NumberField*, 3> PlaceDialog::addVector(const QString& title, const QString& unit, double step, const Vec3& value) {
    sections_->addWidget(styled(new QLabel(title, this), "section"));
    auto* row = fill(new QHBoxLayout, Spacing{px(8)});
    std::array<NumberField*, 3> fields = {};
    for (int axis = 0; axis < 3; ++axis) {
        const QString name = QLatin1String(kAxisNames[axis]);
        auto* field = new NumberField({unit, -1e6, 1e6, step, 4, 1.0, {}}, this);
        field->setAccessibleName(tr("%1: %2", "what, and its axis").arg(title, name));
        field->setMinimumWidth(px(90));
        field->setValue(value[axis]);
        fill(row, styled(new QLabel(name, this), "muted"), Share{field, 1});
        fields[std::size_t(axis)] = field;
    }
    sections_->addLayout(row);
    return fields;
}

void PlaceDialog::addElements(bool characters) {
    on_ = new QComboBox(this);
    const Element* meant = meantElement(document_);
    std::string wanted = meant ? meant->name : std::string();
    const auto add = [&](const std::string& name) { on_->addItem(QString::fromStdString(name), QString::fromStdString(name)); };
    if (characters)
        for (const auto& [id, character] : now().characters) {
            add(character->name);
            if (meant && meant->piece && meant->piece->character == id) wanted = character->name;
        }
    for (const auto& [id, element] : now().elements)
        if (!characters || !element->piece) add(element->name);
    on_->setCurrentIndex(std::max(0, on_->findData(QString::fromStdString(wanted))));
    on_->setObjectName(QStringLiteral("placeOn"));
    connect(on_, &QComboBox::currentIndexChanged, this, &PlaceDialog::propose);
    addSection({})->add(characters ? tr("Body") : tr("Element"), on_);
}

std::string PlaceDialog::chosen() const { return on_->currentData().toString().toStdString(); }

PlaceDialog::End PlaceDialog::addEnd(const QString& title, const std::string& place, double step, const Vec3& point) {
    End end;
    end.at = new QComboBox(this);
    end.at->addItem(tr("a point"), QString());
    const auto add = [&](const std::string& path) { end.at->addItem(QString::fromStdString(path), QString::fromStdString(path)); };
    for (const auto& [id, bone] : now().bones)
        for (const bool atEnd : {false, true}) add(pathOf(now(), EndpointRef{id, atEnd}));
    for (const auto& [id, element] : now().elements)
        for (const JointFace& face : element->faces)
            if (!element->handleOf(face.name)) add(pathOf(now(), FaceRef{id, face.name}));
    addSection({})->add(title, end.at);
    end.point = addVector(tr("%1 at rest", "start or end").arg(title), QStringLiteral("m"), step, point);
    const auto follow = [end] {
        for (NumberField* field : end.point) field->setEnabled(end.at->currentIndex() == 0);
    };
    connect(end.at, &QComboBox::currentIndexChanged, this, follow);
    end.at->setCurrentIndex(std::max(0, end.at->findData(QString::fromStdString(place))));
    follow();
    return end;
}

void PlaceDialog::addBoneFields() {
    name_ = new QLineEdit(QString::fromStdString(numberedName(now(), "bone", 1)), this);
    addSection({})->add(tr("Name"), name_);
    std::vector<std::string> places;
    for (const SelectionItem& item : document_.selection()) {
        if (item.kind == SelectionItem::Kind::Bone) places.push_back(pathOf(now(), EndpointRef{item.part, true}));
        if (item.kind == SelectionItem::Kind::Endpoint) places.push_back(pathOf(now(), EndpointRef{item.part, item.atEnd}));
        if (item.kind == SelectionItem::Kind::Face && !handleOf(now(), item)) places.push_back(pathOf(now(), item));
    }
    places.resize(2);
    const Element* element = meantElement(document_);
    const Bounds bounds = element ? boundsOf(element->mesh->body.vertices) : Bounds{};
    const Vec3 middle = 0.5 * (bounds.low + bounds.high);
    from_ = addEnd(tr("Start"), places[0], kStep * bounds.diagonal(), middle);
    to_ = addEnd(tr("End"), places[1], kStep * bounds.diagonal(), middle + Vec3(0.0, 0.25 * bounds.diagonal(), 0.0));
}

void PlaceDialog::addPlaneFields() {
    name_ = new QLineEdit(this);
    addSection({})->add(tr("Name"), name_);
    addElements(kind_ == Kind::Cut);
    origin_ = addVector(tr("Origin"), QStringLiteral("m"), 0.001, Vec3::Zero());
    normal_ = addVector(tr("Normal"), {}, 0.01, Vec3::UnitX());
    if (kind_ == Kind::Face) {
        size_ = new NumberField({QStringLiteral("m"), 0.0, 1e6, 1e-5, 5, 1.0, {}}, this);
        addSection({})->add(tr("Tolerance"), size_);
    }
    propose();
    if (!edited_) return;
    // It keeps its name, and its element.
    on_->setCurrentIndex(std::max(0, on_->findData(QString::fromStdString(now().elements.at(edited_->element)->name))));
    name_->setText(QString::fromStdString(edited_->face));
    for (QWidget* field : {static_cast<QWidget*>(name_), static_cast<QWidget*>(on_)}) field->setEnabled(false);
    const Element& element = *now().elements.at(edited_->element);
    const FaceFrame& frame = element.faces[std::size_t(element.faceIndex(edited_->face))].frame;
    setVector(origin_, frame.origin);
    setVector(normal_, frame.axes.col(2));
}

void PlaceDialog::addHandleFields() {
    addElements(false);
    origin_ = addVector(tr("Place on the surface"), QStringLiteral("m"), 0.001, Vec3::Zero());
    size_ = new NumberField({QStringLiteral("m"), 0.0, 1e6, 0.001, 4, 1.0, {}}, this);
    addSection({})->add(tr("Radius"), size_);
    propose();
}

void PlaceDialog::propose() {
    const Element* element = now().elementNamed(chosen());
    const CharacterSource* character = now().characterNamed(chosen());
    const Points* body = element ? &element->mesh->body.vertices : character ? &character->body->mesh.vertices : nullptr;
    if (!body || body->rows() == 0) return;
    const Bounds bounds = boundsOf(*body);
    if (name_ && name_->text() == proposedName_) {  // what the artist called it stays
        proposedName_ = QString::fromStdString(kind_ == Kind::Cut ? numberedName(now(), "cut", 1) : element ? freeFaceName(*element) : std::string());
        name_->setText(proposedName_);
    }
    if (kind_ == Kind::Handle) {
        setVector(origin_, body->row(0).transpose());
        size_->setValue(kRadius * bounds.diagonal());
        return;
    }
    // Across the longest side: a cut in the middle, a joint face at the end.
    int longest = 0;
    bounds.size().maxCoeff(&longest);
    Vec3 origin = 0.5 * (bounds.low + bounds.high);
    if (kind_ == Kind::Face) origin[longest] = bounds.high[longest];
    setVector(origin_, origin);
    setVector(normal_, Vec3::Unit(longest));
    if (size_) size_->setValue(kTolerance * bounds.diagonal());
}

void PlaceDialog::place() {
    if (kind_ == Kind::Cut) return placeCut();
    const auto made = placed();
    if (!made) return refuse(made.error());
    document_.select({*made});
    accept();
}

void PlaceDialog::refuse(const Error& error) {
    refused_->setText(errorText(error));
    refused_->show();
}

void PlaceDialog::placeCut() {
    // Whatever ends it, this dialog may be gone by then.
    const std::shared_ptr<void> over(nullptr, [dialog = QPointer(this)](void*) {
        if (dialog) dialog->place_->setEnabled(true);
    });
    SlowStep step;
    step.command = commands::cut(chosen(), valueOf(origin_), valueOf(normal_), {}, name_->text().trimmed().toStdString());
    step.done = [&document = document_, over, dialog = QPointer(this)](const Json& answer) {
        const std::string made = answer.at("cut").get<std::string>();
        if (const CharacterSource* character = document.document().characterOfCut(made))
            document.select({{SelectionItem::Kind::Cut, character->cuts[std::size_t(character->cutIndex(made))].id, {}, false}});
        if (dialog) dialog->accept();
    };
    step.refused = [&document = document_, dialog = QPointer(this)](const Error& error) {
        if (dialog) dialog->refuse(error);
        else Q_EMIT document.failed(errorText(error));
    };
    place_->setEnabled(false);
    document_.executeSlow(std::move(step));
}

Result<SelectionItem> PlaceDialog::placedBone() {
    const auto placeOf = [](const End& end) -> std::variant<std::string, Vec3> {
        if (end.at->currentIndex() == 0) return valueOf(end.point);
        return end.at->currentData().toString().toStdString();
    };
    const std::string name = name_->text().trimmed().toStdString();
    IMOMUSHI_TRY(const Json answer, document_.execute(commands::addBone({name, {}, placeOf(from_), placeOf(to_), {}}), true));
    return SelectionItem{SelectionItem::Kind::Bone, now().boneNamed(name)->id, {}, false};
}

Result<SelectionItem> PlaceDialog::placed() {
    if (kind_ == Kind::Bone) return placedBone();
    const Vec3 origin = valueOf(origin_);
    const std::string name = name_ ? name_->text().trimmed().toStdString() : std::string();
    const double size = size_->value().value_or(0.0);
    if (edited_) {
        IMOMUSHI_TRY(const Json answer, document_.execute(commands::editJointFace(pathOf(now(), *edited_), origin, valueOf(normal_), size), true));
        return SelectionItem{SelectionItem::Kind::Face, edited_->element, edited_->face, false};
    }
    if (kind_ == Kind::Face) {
        IMOMUSHI_TRY(const Json answer, document_.execute(commands::addJointFace(chosen(), name, origin, valueOf(normal_), size), true));
        return SelectionItem{SelectionItem::Kind::Face, now().elementNamed(chosen())->id, name, false};
    }
    IMOMUSHI_TRY(const Json answer, document_.execute(commands::addHandle(chosen(), origin, size), true));
    return SelectionItem{SelectionItem::Kind::Face, now().elementNamed(chosen())->id, answer.at("name").get<std::string>(), false};
}

}  // namespace imomushi
