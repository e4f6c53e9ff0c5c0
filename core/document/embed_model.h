// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/character/embedded_mesh.h"
#include "core/document/document.h"

namespace imomushi {

/// How the elements of a character move what is seen of it.
struct EmbeddedModel {
    std::shared_ptr<const EmbeddedMesh> mesh;  ///< EmbeddedMesh::Vertex::element counts all elements of the document
    std::vector<PartId> elements;              ///< of the character, ascending
    std::vector<int> places;                   ///< of these, among all elements of the document
    std::vector<std::shared_ptr<const EmbeddedPoints>> points;  ///< of these, null: it moves its body vertices alone
    /// A part that keeps its shape: points[element]->attached[index].
    struct Rigid {
        ModelPart part;
        std::size_t element = 0;
        int index = 0;
    };
    std::vector<Rigid> rigid;  ///< ascending
};

/// Render vertices at a body vertex follow it. Others follow the element whose surface (without the caps of cuts) is nearest, preferring surface that faces the way of their normal;
/// vertices at one place follow the same body vertex, or the same place of a surface, and stay together. A connected part of the render mesh follows one element as a whole if none of its vertices is a body vertex and it is smaller than kSmallPart of
/// the model's diagonal and half of the element's. The element is the one of most of its vertices. The part is rigid unless the body is a wrap.
/// Parts that the artist attached follow as they were told (Attachment), rigid ones the element of most of their vertices. Depends on model, body, attachments and pieces
/// of the character alone.
EmbeddedModel embedModel(const Document& document, const CharacterSource& character);

/// Parts smaller than this, in diagonals of the model, are not torn apart at cuts: eyes, teeth, buttons.
inline constexpr double kSmallPart = 0.15;

/// The embedded models of a document's characters, the two latest of each remembered: undo and redo go to and fro. What did not change stays the same objects, so that nothing is built from it anew.
class EmbeddedModels {
public:
    const EmbeddedModel& of(const Document& document, const CharacterSource& character);
    /// Remembers the latest of each character of another one, too.
    void take(const EmbeddedModels& other);

private:
    struct Known {
        std::shared_ptr<const RenderModel> model;
        std::shared_ptr<const Body> body;
        std::map<ModelPart, Attachment> attachments;
        std::vector<std::shared_ptr<const PieceOrigin>> origins;  // of its elements
        std::vector<std::shared_ptr<const ElementMesh>> meshes;   // of its elements
        EmbeddedModel embedded;
    };
    void remember(PartId character, std::shared_ptr<const Known> known);
    std::map<PartId, std::vector<std::shared_ptr<const Known>>> known_;  // latest last
};

}  // namespace imomushi
