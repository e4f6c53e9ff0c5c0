// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <functional>
#include <memory>
#include <vector>

#include "ui/models/gesture.h"
#include "ui/models/mapping_model.h"
#include "ui/widgets/number_field.h"

class QComboBox;
class QGridLayout;
class QLabel;
class QToolButton;

namespace imomushi {

class ElidedLabel;

/// What the chosen row makes of its control: ranges, curve, dead zone, smoothing and silence, each edited by the command that made the row.
class MappingForm : public QWidget {
    Q_OBJECT
public:
    MappingForm(StudioDocument& document, MappingModel& model, QWidget* parent = nullptr);
    /// -1: none.
    void show(int row);

protected:
    void changeEvent(QEvent* event) override;

private:
    using Get = std::function<double(const InputMapping&)>;
    using Set = std::function<void(InputMapping&, double)>;
    void rebuild();
    void refresh();
    NumberField* addNumber(int row, int column, const QString& label, const char* name, const QString& help, NumberField::Spec spec, Get get, Set set);
    void execute(const std::function<void(InputMapping&)>& change);
    [[nodiscard]] const InputMapping* mapping() const { return model_.mapping(model_.rowOf(line_)); }

    StudioDocument& document_;
    MappingModel& model_;
    InputMapping line_;              ///< the row that is shown
    bool shown_ = false, filled_ = false;  ///< filled_: the fields say what line_ says
    QString unit_;                   ///< of its target, which the fields were made for
    QWidget* body_ = nullptr;
    QGridLayout* grid_ = nullptr;
    ElidedLabel* title_ = nullptr;
    QLabel* conflict_ = nullptr;
    QComboBox* silence_ = nullptr;
    std::vector<std::function<void(const InputMapping&)>> refreshers_;
    std::unique_ptr<Gesture> gesture_;
};

}  // namespace imomushi
