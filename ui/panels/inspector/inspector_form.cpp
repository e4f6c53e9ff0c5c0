// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/inspector/inspector_form.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QVBoxLayout>
#include <cmath>

#include "ui/models/paths.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/widgets/layouts.h"

namespace imomushi {

InspectorForm::InspectorForm(StudioDocument& document, QWidget* parent) : QWidget(parent), document_(document), sections_(new QVBoxLayout(this)) {
    usePanelBackground(this);
    sections_->setContentsMargins(px(14), px(12), px(12), px(14));
    sections_->setSpacing(px(9));
}

InspectorForm::~InspectorForm() = default;

void InspectorForm::refresh() {
    for (const auto& show : refreshers_) show();
}

void InspectorForm::retire() {
    refreshers_.clear();
    gesture_.reset();
}

void InspectorForm::askForRows() {
    if (!gesture_) Q_EMIT rowsChanged();
}

const Element* InspectorForm::element(const SelectionItem& item) const { return elementOf(now(), item); }
const Bone* InspectorForm::bone(const SelectionItem& item) const { return boneOf(now(), item); }
std::string InspectorForm::path(const SelectionItem& item) const { return pathOf(now(), item); }

void InspectorForm::addHeading(const QString& icon, const Say& title, const QString& kind) {
    auto* picture = new QLabel(this);
    picture->setPixmap(themedIcon(icon, Appearance::Role::Accent).pixmap(QSize(px(22), px(22)), devicePixelRatioF()));
    auto* text = styled(new ElidedLabel(this), "title");
    text->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    auto* what = styled(new QLabel(kind, this), "muted");
    sections_->addLayout(fill(new QHBoxLayout, Spacing{px(10)}, picture, Share{text, 1}, what));
    follow([text, title] { text->setText(title()); });
    grid_ = nullptr;
}

void InspectorForm::addSection(const QString& title) {
    section_ = title;
    if (!title.isEmpty()) {
        auto* rule = named(new QFrame(this), "rule");
        sections_->addSpacing(px(4));
        sections_->addWidget(rule);
        auto* label = styled(new QLabel(title, this), "section");
        sections_->addWidget(label);
    }
    grid_ = new QGridLayout;
    grid_->setHorizontalSpacing(px(10));
    grid_->setVerticalSpacing(px(7));
    grid_->setColumnMinimumWidth(0, px(104));
    grid_->setColumnStretch(1, 1);
    sections_->addLayout(grid_);
}

void InspectorForm::addRow(const QString& label, QWidget* field) {
    if (!grid_) addSection();
    auto* text = styled(new QLabel(label, this), "muted");
    text->setBuddy(field);
    // An axis alone does not say of what.
    field->setAccessibleName(label.size() == 1 && !section_.isEmpty() ? tr("%1: %2", "what, and its value or axis").arg(section_, label) : label);
    field->setMinimumWidth(px(90));
    field->setSizePolicy(QSizePolicy::Ignored, field->sizePolicy().verticalPolicy());
    const int row = grid_->rowCount();
    grid_->addWidget(text, row, 0, Qt::AlignLeft | Qt::AlignVCenter);
    grid_->addWidget(field, row, 1);
}

void InspectorForm::addFact(const QString& label, Say say) {
    auto* text = new QLabel(this);
    text->setTextInteractionFlags(Qt::TextSelectableByMouse);
    text->setWordWrap(true);
    addRow(label, text);
    follow([this, text, label, say = std::move(say)] {
        const QString said = say();
        text->setText(said);
        text->setAccessibleName(tr("%1: %2", "what, and its value or axis").arg(label, said));
    });
}

void InspectorForm::addName(const SelectionItem& item) {
    auto* field = new QLineEdit(this);
    addRow(tr("Name"), field);
    const bool isFace = item.kind == SelectionItem::Kind::Face;
    const auto current = [this, item, isFace] { return isFace ? QString::fromStdString(item.face) : title(item); };
    connect(field, &QLineEdit::editingFinished, this, [this, field, item, isFace, current] {
        const QString name = field->text().trimmed();
        if (name.isEmpty() || name == current() || !document_.execute(commands::rename(path(item), name.toStdString()))) {
            field->setText(current());
            return;
        }
        // A face is known by its name: keep it selected under the new one.
        if (isFace) document_.select({{item.kind, item.part, name.toStdString(), false}});
    });
    follow([field, current] {
        if (!field->hasFocus()) field->setText(current());
    });
}

void InspectorForm::addNumber(const QString& label, NumberField::Spec spec, const Items& items, Get get, std::function<Json(const SelectionItem&, double)> command) {
    auto* field = new NumberField(std::move(spec), this);
    addNumberField(field, label, items, std::move(get));
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
}

void InspectorForm::addSlowNumber(const QString& label, NumberField::Spec spec, const Items& items, Get get, std::function<Json(const SelectionItem&, double)> command) {
    SlowStep step;
    step.command = Json::array();
    if (!document_.worksBeside(step)) return addNumber(label, std::move(spec), items, std::move(get), std::move(command));
    auto* field = new NumberField(std::move(spec), this);
    addNumberField(field, label, items, std::move(get));
    const auto edited = std::make_shared<std::optional<double>>();
    connect(field, &NumberField::valueEdited, this, [edited](double value) { *edited = value; });
    connect(field, &NumberField::editEnded, this, [this, edited, items, command = std::move(command)](bool keep) {
        const auto value = std::exchange(*edited, std::nullopt);
        if (keep && value) {
            Json commands = Json::array();
            for (const SelectionItem& item : items) commands.push_back(command(item, *value));
            document_.executeSlow({commands.size() == 1 ? commands.front() : commands});
        }
        refresh();
    });
}

void InspectorForm::addNumberField(NumberField* field, const QString& label, const Items& items, Get get) {
    addRow(label, field);
    follow([field, items, get = std::move(get)] {
        constexpr double kSame = 1e-12;  // rounding
        std::optional<double> common;
        for (const SelectionItem& item : items) {
            const auto value = get(item);
            if (!value) continue;
            if (common && std::abs(*common - *value) > kSame) {
                common.reset();
                break;
            }
            common = value;
        }
        field->setValue(common);
    });
}

void InspectorForm::addProperty(const QString& label, NumberField::Spec spec, const Items& items, Get get, commands::Property<double> property) {
    addNumber(label, std::move(spec), items, std::move(get), [this, property](const SelectionItem& item, double value) { return commands::set(path(item), property, value); });
}

QComboBox* InspectorForm::addChoiceOf(const QString& label, const QStringList& texts, std::function<int()> current, std::function<void(int)> choose) {
    auto* box = new QComboBox(this);
    // Long names are cut, not the form.
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(6);
    box->addItems(texts);
    addRow(label, box);
    const auto show = [box, current = std::move(current)] { box->setCurrentIndex(current()); };
    connect(box, &QComboBox::activated, this, [choose = std::move(choose), show](int index) {
        choose(index);
        show();
    });
    follow(show);
    return box;
}

QString vectorText(const Vec3& v) {
    const QLocale locale;
    // Rounded first: a zero has no sign.
    const auto text = [&](double value) { return locale.toString(std::round(value * 1e3) / 1e3 + 0.0, 'f', 3); };
    return QStringLiteral("%1  %2  %3").arg(text(v.x()), text(v.y()), text(v.z()));
}

}  // namespace imomushi
