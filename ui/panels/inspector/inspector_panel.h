// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QScrollArea>
#include <QTimer>
#include <functional>
#include <memory>
#include <vector>

#include "ui/models/gesture.h"
#include "ui/models/studio_document.h"
#include "ui/widgets/number_field.h"

class QGridLayout;
class QLabel;
class QVBoxLayout;

namespace imomushi {

/// Shows and changes the properties of what is selected; of the character when nothing is.
class InspectorPanel : public QScrollArea {
    Q_OBJECT
public:
    explicit InspectorPanel(StudioDocument& document, QWidget* parent = nullptr);
    ~InspectorPanel() override;

signals:
    void precomputeWanted();

protected:
    void changeEvent(QEvent* event) override;

private:
    using Items = std::vector<SelectionItem>;
    using Get = std::function<std::optional<double>(const SelectionItem&)>;
    using Say = std::function<QString()>;

    void update();    ///< rebuilds when something else is selected, refreshes the values otherwise
    void rebuild();
    void refresh();
    void rebuildSoon();  ///< what is shown is no longer made of the same rows
    void buildCharacter();
    void buildElements(const Items& items);
    void buildEffects(const Items& items);
    void buildSolverMesh(const Items& items);
    void buildPrecompute(const SelectionItem& item);
    void buildFace(const SelectionItem& item);
    void buildBones(const Items& items);
    void buildEndpoint(const SelectionItem& item);

    void heading(const QString& icon, const Say& title, const QString& kind);
    void section(const QString& title);
    void addRow(const QString& label, QWidget* field);
    void addFact(const QString& label, Say say);
    void addName(const SelectionItem& item);
    NumberField* addNumber(const QString& label, NumberField::Spec spec, const Items& items, Get get, std::function<Json(const SelectionItem&, double)> command);
    /// A `set` command on each of `items`.
    void addProperty(const QString& label, NumberField::Spec spec, const Items& items, Get get, const std::string& property);
    void addChoice(const QString& label, const std::vector<std::pair<QString, Json>>& choices, std::function<Json()> current, std::function<void(const Json&)> set);

    [[nodiscard]] const Element* element(const SelectionItem& item) const;
    [[nodiscard]] const Bone* bone(const SelectionItem& item) const;
    [[nodiscard]] std::string target(const SelectionItem& item) const;  ///< name for `set` and `rename`
    [[nodiscard]] QString place(const Bone::Place& place) const;
    [[nodiscard]] std::optional<Vec3> at(const Bone::Place& place, int depth = 0) const;  ///< m at rest

    StudioDocument& document_;
    Items shown_;
    bool built_ = false;
    QWidget* body_ = nullptr;
    QVBoxLayout* sections_ = nullptr;
    QGridLayout* grid_ = nullptr;
    std::vector<std::function<void()>> refreshers_;
    std::unique_ptr<Gesture> gesture_;
    bool scheduled_ = false;
    QTimer live_;  ///< runs while frames move what is shown
};

}  // namespace imomushi
