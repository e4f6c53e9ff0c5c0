// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/studio_document.h"
#include "ui/widgets/number_field.h"

class QComboBox;
class QGridLayout;
class QVBoxLayout;

namespace imomushi {

/// The rows of the inspector for one selection: facts, fields and choices that follow the document. Forms of what can be selected derive from it (inspector_forms.h)
/// and add their rows when they are made.
class InspectorForm : public QWidget {
    Q_OBJECT
public:
    using Items = std::vector<SelectionItem>;
    InspectorForm(StudioDocument& document, QWidget* parent);
    ~InspectorForm() override;

    /// Shows the present values.
    void refresh();
    /// Takes back what is being edited. Shows nothing new from now on.
    void retire();

signals:
    void rowsChanged();  ///< what is shown is no longer made of the same rows
    void precomputeWanted();
    void placeWanted(imomushi::PartId character, const imomushi::Vec3& point);
    /// Triangles of what is seen of a character are to be pointed out; none: no more.
    void partWanted(imomushi::PartId character, const std::vector<std::int32_t>& triangles);

protected:
    using Get = std::function<std::optional<double>(const SelectionItem&)>;
    using Say = std::function<QString()>;

    void addHeading(const QString& icon, const Say& title, const QString& kind);
    void addSection(const QString& title = {});
    void addRow(const QString& label, QWidget* field);
    void addFact(const QString& label, Say say);
    void addName(const SelectionItem& item);
    /// Shows what all `items` have in common; an edit issues `command` on each, all as one step.
    void addNumber(const QString& label, NumberField::Spec spec, const Items& items, Get get, std::function<Json(const SelectionItem&, double)> command);
    /// The same of commands that take their time: where they are executed beside the window, once the edit has ended.
    void addSlowNumber(const QString& label, NumberField::Spec spec, const Items& items, Get get, std::function<Json(const SelectionItem&, double)> command);
    void addProperty(const QString& label, NumberField::Spec spec, const Items& items, Get get, commands::Property<double> property);
    /// `current`: none where none of the choices holds for all that is shown; then it shows its placeholder.
    template <class Value>
    QComboBox* addChoice(const QString& label, const std::vector<std::pair<QString, Value>>& choices, std::function<std::optional<Value>()> current, std::function<void(const Value&)> choose);

    [[nodiscard]] const Document& now() const { return document_.document(); }
    [[nodiscard]] const Element* element(const SelectionItem& item) const;
    [[nodiscard]] const Bone* bone(const SelectionItem& item) const;
    /// The name by which commands call it.
    [[nodiscard]] std::string path(const SelectionItem& item) const;
    [[nodiscard]] QString title(const SelectionItem& item) const { return QString::fromStdString(path(item)); }
    /// Asks for a new form, unless a field is being edited: that one stays, and its end refreshes again.
    void askForRows();
    /// Runs with each refresh.
    void follow(std::function<void()> show) { refreshers_.push_back(std::move(show)); }

    StudioDocument& document_;
    QVBoxLayout* sections_;
    QGridLayout* grid_ = nullptr;  ///< of the section that rows go to

private:
    void addNumberField(NumberField* field, const QString& label, const Items& items, Get get);
    QComboBox* addChoiceOf(const QString& label, const QStringList& texts, std::function<int()> current, std::function<void(int)> choose);

    std::vector<std::function<void()>> refreshers_;
    std::unique_ptr<Gesture> gesture_;
    QString section_;  ///< its title
};

template <class Value>
QComboBox* InspectorForm::addChoice(const QString& label, const std::vector<std::pair<QString, Value>>& choices, std::function<std::optional<Value>()> current,
                              std::function<void(const Value&)> choose) {
    QStringList texts;
    std::vector<Value> values;
    for (const auto& [text, value] : choices) {
        texts << text;
        values.push_back(value);
    }
    const auto index = [values, current = std::move(current)] {
        const std::optional<Value> now = current();
        for (std::size_t i = 0; i < values.size(); ++i)
            if (now == values[i]) return int(i);
        return -1;
    };
    return addChoiceOf(label, texts, index, [values, choose = std::move(choose)](int i) { choose(values[std::size_t(i)]); });
}

/// "0.120  0.000  -1.300"
QString vectorText(const Vec3& v);

/// The value that all have, none where they differ or nobody has one.
template <class Items, class Get>
auto commonValue(const Items& items, Get get) -> decltype(get(*items.begin())) {
    decltype(get(*items.begin())) common;
    for (const auto& item : items) {
        const auto value = get(item);
        if (!value) continue;
        if (common && !(*common == *value)) return {};
        common = value;
    }
    return common;
}

}  // namespace imomushi
