// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/outliner_model.h"

#include <QCoreApplication>
#include <QDataStream>
#include <QIODevice>
#include <QMimeData>
#include <QStringList>
#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include "core/document/character_input.h"
#include "ui/models/commands.h"
#include "ui/models/effect_texts.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"

namespace imomushi {
namespace {

/// The process, then the kind, the part and the face of each row: no other process knows these parts.
const QString kDragged = QStringLiteral("application/x-imomushi-parts");

}  // namespace

struct OutlinerModel::Node {
    Kind kind = Kind::Character;
    PartId part = 0;
    std::string face;
    Node* parent = nullptr;
    int row = 0;
    std::vector<std::unique_ptr<Node>> children;

    Node& add(Kind childKind, PartId childPart, std::string childFace = {}) {
        auto child = std::make_unique<Node>();
        child->kind = childKind;
        child->part = childPart;
        child->face = std::move(childFace);
        child->parent = this;
        child->row = int(children.size());
        children.push_back(std::move(child));
        return *children.back();
    }
    [[nodiscard]] bool sameShape(const Node& other) const {
        if (kind != other.kind || part != other.part || face != other.face || children.size() != other.children.size()) return false;
        for (std::size_t i = 0; i < children.size(); ++i)
            if (!children[i]->sameShape(*other.children[i])) return false;
        return true;
    }
};

OutlinerModel::OutlinerModel(StudioDocument& document, QObject* parent)
    : QAbstractItemModel(parent), document_(document), root_(std::make_unique<Node>()) {
    rebuild();
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        // It shows, too, whose response is out of date.
        if (change.forResponses() || change.has(&DocumentChange::bones) || change.has(&DocumentChange::characters) || change.has(&DocumentChange::joints)) rebuild();
    });
    connect(&document, &StudioDocument::responsesChanged, this, &OutlinerModel::retranslate);
    connect(&document, &StudioDocument::fileChanged, this, &OutlinerModel::retranslate);
}

OutlinerModel::~OutlinerModel() = default;

void OutlinerModel::rebuild() {
    const Document& d = document_.document();
    auto root = std::make_unique<Node>();
    Node& character = root->add(Kind::Character, 0);
    const auto addElement = [](Node& to, const Element& element) {
        Node& node = to.add(Kind::Element, element.id);
        for (const JointFace& face : element.faces) node.add(Kind::Face, element.id, face.name);
    };
    for (const auto& [id, source] : d.characters) {
        Node& whole = character.add(Kind::Whole, id);
        for (const PartId element : d.elementsOf(id)) addElement(whole, *d.elements.at(element));
        for (const Cut& cut : source->cuts) whole.add(Kind::Cut, cut.id);
    }
    for (const auto& [id, element] : d.elements)
        if (!element->piece) addElement(character, *element);
    if (!d.bones.empty()) {
        Node& bones = character.add(Kind::Bones, 0);
        // As they hang in the character, where parents that nobody gave are found from the joint points.
        std::multimap<PartId, PartId> children;
        const auto plan = planCharacter(d);
        for (const auto& [id, bone] : d.bones) {
            const int parent = plan ? plan->input.skeleton.bones[std::size_t(plan->boneIndex(id))].parent : -1;
            children.emplace(parent < 0 ? 0 : plan->bones[std::size_t(parent)], id);
        }
        const std::function<void(Node&, PartId)> grow = [&](Node& node, PartId parent) {
            const auto [begin, end] = children.equal_range(parent);
            for (auto it = begin; it != end; ++it) grow(node.add(Kind::Bone, it->second), it->second);
        };
        grow(bones, 0);
    }
    if (!d.joints.empty()) {
        Node& joints = character.add(Kind::Joints, 0);
        for (const auto& [id, joint] : d.joints) joints.add(Kind::Joint, id);
    }
    Node* effects = nullptr;
    for (std::size_t k = 0; k < kEffects; ++k) {
        if (!d.effects.has(static_cast<EffectKind>(k))) continue;
        if (!effects) effects = &character.add(Kind::Effects, 0);
        effects->add(Kind::Effect, static_cast<PartId>(k));
    }
    if (root->sameShape(*root_)) {
        retranslate();
        return;
    }
    beginResetModel();
    root_ = std::move(root);
    endResetModel();
}

void OutlinerModel::retranslate() {
    const std::function<void(const Node&)> tell = [&](const Node& node) {
        if (node.children.empty()) return;
        Q_EMIT dataChanged(indexOf(node.children.front().get(), 0), indexOf(node.children.back().get(), kColumns - 1));
        for (const auto& child : node.children) tell(*child);
    };
    tell(*root_);
}

OutlinerModel::Node* OutlinerModel::node(const QModelIndex& index) const {
    return index.isValid() ? static_cast<Node*>(index.internalPointer()) : root_.get();
}

QModelIndex OutlinerModel::indexOf(const Node* node, int column) const {
    return node == root_.get() ? QModelIndex() : createIndex(node->row, column, const_cast<Node*>(node));
}

QModelIndex OutlinerModel::index(int row, int column, const QModelIndex& parent) const {
    const Node* n = node(parent);
    if (row < 0 || row >= int(n->children.size()) || column < 0 || column >= kColumns) return {};
    return createIndex(row, column, n->children[std::size_t(row)].get());
}

QModelIndex OutlinerModel::parent(const QModelIndex& index) const { return index.isValid() ? indexOf(node(index)->parent) : QModelIndex(); }

int OutlinerModel::rowCount(const QModelIndex& parent) const { return parent.column() > 0 ? 0 : int(node(parent)->children.size()); }

int OutlinerModel::columnCount(const QModelIndex&) const { return kColumns; }

std::shared_ptr<const Element> OutlinerModel::element(const Node& n) const {
    const auto found = document_.document().elements.find(n.part);
    return found == document_.document().elements.end() ? nullptr : found->second;
}

std::vector<OutlinerModel::Switched> OutlinerModel::switched(const Node& n) const {
    const Document& d = document_.document();
    std::vector<Switched> all;
    if (n.kind == Kind::Bones)
        for (const auto& [id, bone] : d.bones) all.push_back({bone->name, shown(*bone)});
    if (n.kind == Kind::Character || n.kind == Kind::Whole)
        for (const auto& [id, e] : d.elements)
            if (n.kind == Kind::Character || (e->piece && e->piece->character == n.part)) all.push_back({e->name, shown(*e)});
    if (const auto itself = n.kind == Kind::Whole ? std::nullopt : item(indexOf(&n)))
        if (const std::string name = pathOf(d, *itself); !name.empty()) all.push_back({name, shownOf(d, *itself)});
    return all;
}

std::optional<SelectionItem> OutlinerModel::item(const QModelIndex& index) const {
    if (!index.isValid()) return std::nullopt;
    const Node& n = *node(index);
    switch (n.kind) {
        case Kind::Element: return SelectionItem{SelectionItem::Kind::Element, n.part, {}, false};
        case Kind::Face: return SelectionItem{SelectionItem::Kind::Face, n.part, n.face, false};
        case Kind::Bone: return SelectionItem{SelectionItem::Kind::Bone, n.part, {}, false};
        case Kind::Whole: return SelectionItem{SelectionItem::Kind::Character, n.part, {}, false};
        case Kind::Cut: return SelectionItem{SelectionItem::Kind::Cut, n.part, {}, false};
        case Kind::Character:
        case Kind::Bones:
        case Kind::Joints:
        case Kind::Joint:
        case Kind::Effects:
        case Kind::Effect: break;
    }
    return std::nullopt;
}

std::vector<SelectionItem> OutlinerModel::items(const QModelIndex& index) const {
    if (const auto one = item(index)) return {*one};
    std::vector<SelectionItem> faces;
    const auto& joints = document_.document().joints;
    if (const Node& n = *node(index); n.kind == Kind::Joint && joints.contains(n.part))
        for (const FaceRef& face : joints.at(n.part)->faces) faces.push_back({SelectionItem::Kind::Face, face.element, face.face, false});
    return faces;
}

std::optional<EffectKind> OutlinerModel::effect(const QModelIndex& index) const {
    const Node& n = *node(index);
    return n.kind == Kind::Effect ? std::optional(static_cast<EffectKind>(n.part)) : std::nullopt;
}

QModelIndex OutlinerModel::indexOf(const SelectionItem& wanted) const {
    SelectionItem shown = wanted;
    if (shown.kind == SelectionItem::Kind::Endpoint) shown = {SelectionItem::Kind::Bone, wanted.part, {}, false};
    QModelIndex found;
    const std::function<bool(const Node&)> look = [&](const Node& n) {
        for (const auto& child : n.children) {
            const QModelIndex at = indexOf(child.get());
            if (item(at) == shown) {
                found = at;
                return true;
            }
            if (look(*child)) return true;
        }
        return false;
    };
    look(*root_);
    return found;
}

namespace {

QString facesOf(const Document& d, PartId joint) {
    QStringList names;
    if (const auto found = d.joints.find(joint); found != d.joints.end())
        for (const FaceRef& face : found->second->faces) names << QString::fromStdString(pathOf(d, face));
    return names.join(QStringLiteral(" ↔ "));
}

QString joinedWith(const Document& d, PartId element, const std::string& face) {
    QStringList others;
    for (const auto& [id, joint] : d.joints) {
        bool mine = false;
        QStringList rest;
        for (const FaceRef& ref : joint->faces) {
            if (ref.element == element && ref.face == face) {
                mine = true;
            } else if (const auto other = d.elements.find(ref.element); other != d.elements.end()) {
                rest << QString::fromStdString(other->second->name + "/" + ref.face);
            }
        }
        if (mine) others << rest;
    }
    return others.join(QStringLiteral(", "));
}

}  // namespace

QVariant OutlinerModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid()) return {};
    const Node& n = *node(index);
    const Document& d = document_.document();
    if (role == KindRole) return int(n.kind);
    const auto e = n.kind == Kind::Element || n.kind == Kind::Face ? element(n) : nullptr;
    if ((n.kind == Kind::Element || n.kind == Kind::Face) && !e) return {};
    if (n.kind == Kind::Bone && !d.bones.contains(n.part)) return {};
    const QString whole = n.kind == Kind::Whole || n.kind == Kind::Cut ? QString::fromStdString(pathOf(d, *item(index))) : QString();
    if ((n.kind == Kind::Whole || n.kind == Kind::Cut) && whole.isEmpty()) return {};

    switch (index.column()) {
        case Name:
            if (role == Qt::DisplayRole || role == Qt::EditRole || role == Qt::AccessibleTextRole) {
                switch (n.kind) {
                    case Kind::Character: return d.characters.empty() ? tr("Character") : tr("Scene");
                    case Kind::Bones: return tr("Bones");
                    case Kind::Element: return QString::fromStdString(e->name);
                    case Kind::Face: return QString::fromStdString(n.face);
                    case Kind::Bone: return QString::fromStdString(d.bones.at(n.part)->name);
                    case Kind::Whole:
                    case Kind::Cut: return whole;
                    case Kind::Joints: return tr("Joints");
                    case Kind::Joint: return facesOf(d, n.part);
                    case Kind::Effects: return tr("Effects");
                    case Kind::Effect: return effectTitle(static_cast<EffectKind>(n.part));
                }
            }
            if (role == IconRole) {
                static constexpr const char* kIcons[] = {"character", "element", "face", "bones", "bone", "character", "cut", "joint", "joint", "spring", "spring"};
                if (n.kind == Kind::Face && e->handleOf(n.face)) return QStringLiteral("handle");
                return QString::fromLatin1(kIcons[int(n.kind)]);
            }
            if (role == NoteRole && n.kind == Kind::Effect && d.effects[static_cast<EffectKind>(n.part)].automatic) return tr("automatic");
            if (role == NoteRole && n.kind == Kind::Face) {
                const QString others = joinedWith(d, n.part, n.face);
                return others.isEmpty() ? QString() : QStringLiteral("↔ %1").arg(others);
            }
            break;
        case State: {
            if (n.kind != Kind::Element || e->faces.empty()) break;
            const auto state = document_.session().responseState(n.part);
            if (role == IconRole) {
                // Fresh needs no sign: only what asks for something is shown.
                if (state == Session::ResponseState::Stale) return QStringLiteral("stale");
                if (state == Session::ResponseState::None) return QStringLiteral("none");
            }
            if (role == Qt::ToolTipRole || role == Qt::AccessibleTextRole) {
                switch (state) {
                    case Session::ResponseState::Fresh: return tr("Precomputed");
                    case Session::ResponseState::Stale:
                        return document_.session().responses().isDraft(n.part) ? tr("Draft: precompute for the accurate result") : tr("Out of date: precompute again");
                    case Session::ResponseState::None: return tr("Not precomputed yet");
                }
            }
            break;
        }
        case Visible:
        case Locked: {
            if (n.kind == Kind::Effect && index.column() == Visible) {
                if (role == IconRole) return QStringLiteral("eye");
                if (role == Qt::ToolTipRole || role == Qt::AccessibleTextRole) return tr("On: click to turn off");
            }
            const auto parts = switched(n);
            if (parts.empty()) break;
            const bool text = role == Qt::ToolTipRole || role == Qt::AccessibleTextRole;
            if (index.column() == Visible) {
                const auto seen = std::count_if(parts.begin(), parts.end(), [](const auto& of) { return of.shown.visible; });
                if (role == IconRole) return seen > 0 ? QStringLiteral("eye") : QStringLiteral("eye-off");
                if (text) return seen == 0 ? tr("Hidden: click to show") : seen == std::ptrdiff_t(parts.size()) ? tr("Visible: click to hide") : tr("Some are hidden: click to hide all");
                break;
            }
            const auto locked = std::count_if(parts.begin(), parts.end(), [](const auto& of) { return of.shown.locked; });
            if (role == IconRole) return locked == std::ptrdiff_t(parts.size()) ? QStringLiteral("lock") : QStringLiteral("unlock");
            if (text) return locked == 0 ? tr("Not locked: click to lock") : locked == std::ptrdiff_t(parts.size()) ? tr("Locked: click to unlock") : tr("Some are locked: click to lock all");
            break;
        }
        default: break;
    }
    return {};
}

bool OutlinerModel::setData(const QModelIndex& index, const QVariant& value, int role) {
    if (role != Qt::EditRole || index.column() != Name) return false;
    const Node& n = *node(index);
    const Document& d = document_.document();
    const std::string name = value.toString().trimmed().toStdString();
    std::string target;
    if (n.kind == Kind::Element && element(n)) target = element(n)->name;
    if (n.kind == Kind::Face && element(n)) target = element(n)->name + "/" + n.face;
    if (n.kind == Kind::Bone && d.bones.contains(n.part)) target = d.bones.at(n.part)->name;
    if (n.kind == Kind::Whole || n.kind == Kind::Cut) target = pathOf(d, *item(index));
    if (target.empty() || name.empty() || name == data(index, Qt::EditRole).toString().toStdString()) return false;
    return document_.execute(commands::rename(target, name)).has_value();
}

Qt::ItemFlags OutlinerModel::flags(const QModelIndex& index) const {
    if (!index.isValid()) return Qt::NoItemFlags;
    Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable;
    const Kind kind = node(index)->kind;
    const bool named = kind == Kind::Element || kind == Kind::Face || kind == Kind::Bone || kind == Kind::Whole || kind == Kind::Cut;
    if (index.column() == Name && named) flags |= Qt::ItemIsEditable;
    if (kind == Kind::Face || kind == Kind::Bone) flags |= Qt::ItemIsDragEnabled | Qt::ItemIsDropEnabled;
    return flags;
}

QStringList OutlinerModel::mimeTypes() const { return {kDragged}; }

QMimeData* OutlinerModel::mimeData(const QModelIndexList& indexes) const {
    QByteArray bytes;
    QDataStream out(&bytes, QIODevice::WriteOnly);
    out << qint64(QCoreApplication::applicationPid());
    for (const QModelIndex& index : indexes) {
        const Node& n = *node(index);
        if (index.column() == Name) out << qint32(n.kind) << qint64(n.part) << QString::fromStdString(n.face);
    }
    auto* data = new QMimeData;
    data->setData(kDragged, bytes);
    return data;
}

std::vector<Json> OutlinerModel::dropped(const QMimeData& data, const QModelIndex& index) const {
    QDataStream in(data.data(kDragged));
    qint64 process = 0;
    in >> process;
    if (process != QCoreApplication::applicationPid() || !index.isValid()) return {};
    const Node& onto = *node(index);
    const Document& d = document_.document();
    std::vector<Json> found;
    while (!in.atEnd()) {
        qint32 kind = 0;
        qint64 part = 0;
        QString face;
        in >> kind >> part >> face;
        if (in.status() != QDataStream::Ok || Kind(kind) != onto.kind) return {};
        if (onto.kind == Kind::Bone) {
            const auto bone = d.bones.find(PartId(part)), parent = d.bones.find(onto.part);
            if (bone == d.bones.end() || parent == d.bones.end() || bone == parent) return {};
            if (indexOf({SelectionItem::Kind::Bone, bone->first, {}, false}).parent() == index.siblingAtColumn(Name)) return {};  // it hangs there already
            bool touches = false;
            for (const bool mine : {false, true})
                for (const bool its : {false, true}) touches = touches || document_.session().pointIndex({bone->first, mine}) == document_.session().pointIndex({parent->first, its});
            const std::string end = pathOf(d, EndpointRef{parent->first, true});
            found.push_back(commands::setBoneParent(bone->second->name, parent->second->name, touches ? std::nullopt : std::optional(end)));
        } else if (onto.kind == Kind::Face) {
            const auto from = d.elements.find(PartId(part)), to = d.elements.find(onto.part);
            if (from == d.elements.end() || to == d.elements.end() || from == to) return {};
            found.push_back(commands::join(pathOf(d, FaceRef{from->first, face.toStdString()}), pathOf(d, FaceRef{to->first, onto.face})));
        } else {
            return {};
        }
    }
    return found;
}

bool OutlinerModel::canDropMimeData(const QMimeData* data, Qt::DropAction, int, int, const QModelIndex& parent) const {
    return data && data->hasFormat(kDragged) && !dropped(*data, parent).empty();
}

bool OutlinerModel::dropMimeData(const QMimeData* data, Qt::DropAction, int, int, const QModelIndex& parent) {
    if (!data || !data->hasFormat(kDragged)) return false;
    const std::vector<Json> wanted = dropped(*data, parent);
    return !wanted.empty() && executeTogether(document_, wanted);
}

void OutlinerModel::toggle(const QModelIndex& index) {
    const Node& n = *node(index);
    if (const auto of = effect(index)) {
        if (index.column() == Visible) (void)document_.execute(commands::disable(*of));
        return;  // its row is gone
    }
    const auto parts = switched(n);
    if (parts.empty() || (index.column() != Visible && index.column() != Locked)) return;
    const bool hides = std::any_of(parts.begin(), parts.end(), [](const auto& of) { return of.shown.visible; });
    const bool unlocks = std::all_of(parts.begin(), parts.end(), [](const auto& of) { return of.shown.locked; });
    std::vector<Json> wanted;
    for (const Switched& of : parts) {
        if (index.column() == Visible && of.shown.visible == hides) wanted.push_back(commands::set(of.name, commands::kVisible, !hides));
        if (index.column() == Locked && of.shown.locked == unlocks) wanted.push_back(commands::set(of.name, commands::kLocked, !unlocks));
    }
    executeTogether(document_, wanted);
}

}  // namespace imomushi
