// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/document/document.h"
#include "core/project/response_store.h"
#include "core/project/stored_response.h"
#include "core/reduction/congruence.h"
#include "core/reduction/element_response.h"

namespace imomushi {

enum class ResponseState { None, Fresh, Stale };

/// Congruent elements share one response. The first of them in the document is solved; the others use its response, turned or mirrored. Which one is first follows from the document
/// alone, not from what is in memory: a script gives the same bytes each time.
struct SharedResponse {
    PartId from = 0;
    std::shared_ptr<const Congruence> how;
};

/// What an effect will cost on this machine: predicted before precompute.
struct EffectCost {
    int columns = 0;            ///< of A' that it adds, all elements together
    std::size_t bytes = 0;      ///< that a frame reads for it
    double milliseconds = 0.0;  ///< per frame
    double seconds = 0.0;       ///< of the precompute that it waits for
    bool precompute = false;    ///< an element must be precomputed for it first
};

/// Which responses the elements of a document ask for, which of them a store has, and what the others cost. Answers are remembered per element, until that
/// element changes. Elements that are named must be in the document.
class DocumentResponses {
public:
    /// `document` must outlive this.
    DocumentResponses(const Document& document, std::shared_ptr<ResponseStore> store);

    [[nodiscard]] ResponseStore& store() const { return *store_; }

    // ---- what is asked for
    /// What a precompute of this element takes as input.
    [[nodiscard]] ResponseInput inputOf(PartId element) const;
    /// The same on the solver mesh "draft".
    [[nodiscard]] ResponseInput inputOfDraft(PartId element) const;
    /// Threads of a precompute, by the settings.
    [[nodiscard]] int threads() const;
    [[nodiscard]] const ContentKey& keyOf(PartId element) const { return known(element).key; }
    /// The key without nu and what effects ask for: a response of the same shape still fits the element.
    [[nodiscard]] const ContentKey& shapeOf(PartId element) const { return known(element).shape; }
    /// Null: the element is computed itself. Valid until the document changes.
    [[nodiscard]] const SharedResponse* sharedOf(PartId element) const;

    // ---- what is there
    /// The response of the element as it is now, null: none.
    [[nodiscard]] std::shared_ptr<const ElementResponse> freshOf(PartId element) const;
    /// The fresh one, or the last one of another nu while it still fits, or a draft. Null: none.
    [[nodiscard]] std::shared_ptr<const ElementResponse> fittingOf(PartId element) const;
    [[nodiscard]] ResponseState stateOf(PartId element) const;
    /// True if `response` has one of the keys that answer the present request of the element, and body loads if they are requested. Does not look into the store.
    [[nodiscard]] bool isFresh(PartId element, const StoredResponse& response) const;
    /// The fitting one is a draft (inputOfDraft()), not what the element's settings ask for.
    [[nodiscard]] bool isDraft(PartId element) const;
    /// The fitting one has no patches, and effects ask for them.
    [[nodiscard]] bool lacksPatches(PartId element) const;

    // ---- what it costs
    /// Cost of the precompute, whether or not the response exists. Of a shared response: the cost of carrying it over, without solving its source.
    [[nodiscard]] ResponseEstimate estimateOf(PartId element) const;
    /// What it costs to have an effect, on or off now; of effects on bones what their jobs on flesh cost (see effectCost()).
    [[nodiscard]] EffectCost costOf(EffectKind effect) const;

    // ---- computing
    /// The fresh response of an element with joint faces: known, taken over from a congruent element, or solved now. Errors: those of buildResponse().
    Result<std::shared_ptr<const ElementResponse>> compute(PartId element, const Progress& progress);
    /// Solves several elements in parallel: those without a fresh or shared response for which solvedBesideOthers() holds, if
    /// there are at least two. Returns those that were solved. It skips elements that fail; compute() reports their error.
    std::set<PartId> computeTogether(std::span<const PartId> elements, const Progress& progress);
    /// Takes in a response that was computed from inputOf(), or carried over from a congruent element.
    void insert(const ContentKey& key, std::shared_ptr<const ElementResponse> response, bool carried);
    /// Takes in a response that came with an element from a project file, or a draft. Where a fitting response lacks nothing but patches that a draft has, it stays and takes these: it is a draft then.
    void bring(PartId element, const StoredResponse& response);

    // ---- what takes time to find
    /// What the document asks of the response of an element, besides the element itself.
    struct ResponseRequest {
        BasisChoice basis;
        bool loads = false;
        int touch = 0;
        bool operator==(const ResponseRequest&) const = default;
    };
    /// What an element asks for, as of `element` and `request`.
    struct Known {
        std::shared_ptr<const Element> element;
        ResponseRequest request;
        ContentKey key, shape;
        std::vector<ContentKey> keys;                 ///< `key` first, then of others that may have all of it
        std::vector<ContentKey> drafts;               ///< the same of inputOfDraft(); empty until they are asked for
        std::optional<ContentKey> parts;              ///< of all that congruent elements have in common but coordinates
        std::weak_ptr<const ElementResponse> fitting; ///< the last response that was found to fit
    };
    /// Who shares with whom, as of `elements`, `basis` and `effects`.
    struct Sharing {
        std::map<PartId, std::shared_ptr<const Element>> elements;
        BasisChoice basis;
        Effects effects;
        std::map<PartId, ContentKey> keys;          ///< of elements with joint faces
        std::map<PartId, SharedResponse> shared;
    };
    /// What follows from a document and takes time to find: the keys of its elements, and who shares a response.
    struct Derived {
        std::map<PartId, Known> known;
        Sharing sharing;
    };
    /// Of all elements.
    [[nodiscard]] Derived derived() const;
    /// What another one derived of a document that becomes this one.
    void take(const Derived& derived);

    // ---- the project
    /// Remembers the fresh responses as the last ones of their elements; forgets elements that are gone.
    void refresh();
    /// Forgets elements that are gone.
    void dropGone();
    /// The last response of each element, for its project file. Call refresh() before.
    [[nodiscard]] const std::map<PartId, StoredResponse>& last() const { return last_; }
    /// A response of an element was computed since the project was saved: work that would be lost.
    [[nodiscard]] bool unsaved() const;
    void markSaved();
    /// What is remembered of a document besides what can be asked again.
    struct Remembered {
        std::map<PartId, StoredResponse> last;
        std::set<ContentKey> unsaved;
    };
    /// Replaces the remembered responses by those of another document, which the store must have. Returns the old ones.
    Remembered replace(Remembered by);

private:
    [[nodiscard]] ResponseRequest requestOf(PartId element) const;
    Known& known(PartId element) const;
    /// What the store has of all that the element asks for, unchecked; without a response where it has nothing.
    StoredResponse found(PartId element) const;
    /// Under the first of answeringKeys() that has all that is asked for; `loads`: body loads too.
    StoredResponse found(const Element& element, std::span<const ContentKey> keys, bool loads) const;
    /// The store has all that `input` asks of the element.
    bool has(PartId element, const ResponseInput& input) const;
    const ContentKey& partsOf(PartId element) const;
    /// Compares only elements that changed since the last time, with others and among each other.
    void findShared() const;
    [[nodiscard]] bool isOfNow(const Sharing& sharing) const;
    /// estimateResponse(), each answer remembered: it takes part of a second for many elements, and panels ask for every effect again and again.
    ResponseEstimate estimateOf(const ContentKey& key, const ResponseInput& input) const;
    /// The response, where it fits the element: responses come from files too, and a key alone proves nothing about what a file holds under it.
    std::shared_ptr<const ElementResponse> checked(std::shared_ptr<const ElementResponse> response, PartId element) const;

    const Document& document_;
    const std::shared_ptr<ResponseStore> store_;
    std::map<PartId, StoredResponse> last_;     // held here, so that the store does not evict what the project file is to have
    std::set<ContentKey> unsaved_;              // computed and in no project file yet
    mutable std::map<PartId, Known> known_;
    mutable Sharing sharing_, formerSharing_;   // the one before, where undo leads
    mutable std::map<std::pair<ContentKey, int>, ResponseEstimate> estimates_;  // by key and threads
};

}  // namespace imomushi
