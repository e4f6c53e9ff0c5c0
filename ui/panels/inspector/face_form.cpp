// SPDX-License-Identifier: GPL-3.0-or-later
#include <QLocale>
#include <algorithm>

#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/panels/inspector/inspector_forms.h"

namespace imomushi {

FaceForm::FaceForm(StudioDocument& document, const SelectionItem& item, QWidget* parent) : InspectorForm(document, parent) {
    addHeading(QStringLiteral("face"), [item] { return QString::fromStdString(item.face); }, tr("Joint face"));
    addSection();
    addName(item);
    addFact(tr("Element"), [this, item] { return title({SelectionItem::Kind::Element, item.part, {}, false}); });
    addFact(tr("Joined with"), [this, item] {
        QStringList others;
        const FaceRef me{item.part, item.face};
        for (const auto& [id, joint] : now().joints) {
            if (std::find(joint->faces.begin(), joint->faces.end(), me) == joint->faces.end()) continue;
            for (const FaceRef& other : joint->faces)
                if (other != me) others << QString::fromStdString(pathOf(now(), other));
        }
        return others.isEmpty() ? tr("nothing") : others.join(QStringLiteral(", "));
    });

    const auto fact = [this, item](const QString& label, std::function<QString(const JointFace&)> say) {
        addFact(label, [this, item, say = std::move(say)] {
            const Element* e = element(item);
            const int i = e ? e->faceIndex(item.face) : -1;
            return i < 0 ? QString() : say(e->faces[std::size_t(i)]);
        });
    };
    addSection(tr("Patch"));
    fact(tr("Vertices"), [](const JointFace& f) { return QLocale().toString(qlonglong(f.vertices.size())); });
    fact(tr("Area"), [](const JointFace& f) { return tr("%1 cm²").arg(QLocale().toString(f.area * 1e4, 'g', 4)); });
    fact(tr("Size"), [](const JointFace& f) { return lengthText(2.0 * f.size); });
    fact(tr("Planarity error"), [](const JointFace& f) {
        return f.flat() ? tr("%1 (flat)").arg(lengthText(f.planarityError)) : tr("%1 (not flat: three more columns)").arg(lengthText(f.planarityError));
    });
    addSection(tr("Frame"));
    fact(tr("Origin (m)"), [](const JointFace& f) { return vectorText(f.frame.origin); });
    fact(tr("Normal"), [](const JointFace& f) { return vectorText(f.frame.axes.col(2)); });
}

}  // namespace imomushi
