// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/commands/placing.h"
#include "core/session/document_edit.h"

namespace imomushi {

/// Copies parts of a document into itself or into another one. References among the copied parts point to the copies. Options say how copies are named; match() says what stands for
/// a part that is not copied.
class PartCopier {
public:
    struct Options {
        Placing placing;
        /// The wanted name of a copy, from the name of the original; a number is added where it is taken. Null: the same name.
        std::function<std::string(const std::string&)> name;
        /// The last response of an element of `from`, null: it has none.
        std::function<const StoredResponse*(PartId)> response;
        /// Within one document: effects on an element are on its copy too, pins are copied, and bones hang on what is where they end.
        bool within = false;
    };
    /// What was copied: the name of the copy and that of the original.
    using Names = std::vector<std::pair<std::string, std::string>>;

    /// `from` stays as it is, `edit.document` gets the copies.
    PartCopier(DocumentEdit& edit, const Document& from, Options options) : edit_(edit), from_(from), options_(std::move(options)) {}

    /// All elements of a character come with it: those that come first. Then joints among them, then bones: these may be any.
    void copyCharacters(const std::set<PartId>& characters, const std::set<PartId>& elements);
    void copyElements(const std::set<PartId>& elements, const std::set<PartId>& bones);
    void copyJoints();
    void copyBones(const std::set<PartId>& bones);

    /// A part or a face is not copied: `counterpart` stands for it.
    void match(PartId part, PartId counterpart) { ids_.insert_or_assign(part, counterpart); }
    void match(const FaceRef& face, const FaceRef& counterpart) { faces_.insert_or_assign(face, counterpart); }

    [[nodiscard]] bool has(PartId part) const { return ids_.contains(part); }
    /// Copies by what they are copies of, and counterparts.
    [[nodiscard]] const std::map<PartId, PartId>& ids() const { return ids_; }
    /// The id of the copy, given out when first asked for; 0 of 0.
    PartId idOf(PartId part);
    /// The face of the copy, none: it has none.
    [[nodiscard]] std::optional<FaceRef> faceOf(const FaceRef& face) const;
    [[nodiscard]] std::string nameFor(const std::string& name) const { return options_.name ? options_.name(name) : name; }
    [[nodiscard]] const Placing& placing() const { return options_.placing; }

    Names characters, cuts, elements, handles, bones;
    /// Ends of copied bones that hang on nothing, as what they hung on was not copied: "bone/start" of the copy.
    std::vector<std::string> loose;

private:
    Bone::Place placeOf(const Bone::Place& place, bool& hangs);
    void copyPins(const std::set<PartId>& bones);

    DocumentEdit& edit_;
    const Document& from_;
    const Options options_;
    std::map<PartId, PartId> ids_;
    std::map<FaceRef, FaceRef> faces_;
};

}  // namespace imomushi
