// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/session/session.h"
#include "ui/render/scene_renderer.h"
#include "ui/scene/rim.h"
#include "ui/scene/seen_mesh.h"

namespace imomushi {

/// What a body or marker of a scene stands for. An element is what is seen of it: its own mesh, or the part of a character's render mesh that follows it.
struct ScenePart {
    enum class Kind { Element, Face, Bone, Endpoint, Body, Cut, Character } kind = Kind::Element;
    PartId part = 0;       ///< element (Element, Face, Body: under a render mesh), bone (Bone, Endpoint), cut or character
    int face = -1;         ///< Face: index into Element::faces
    bool atEnd = false;    ///< Endpoint only
    bool operator==(const ScenePart&) const = default;
};

/// The id that a part has in every scene (Body::id, Marker::id, Pick::id), and back. Unknown ids give nothing.
std::uint64_t sceneId(const ScenePart& part);
std::optional<ScenePart> scenePart(std::uint64_t id);

/// Triangles of a character's render mesh, or a point near it at rest (m).
struct MarkedPlace {
    PartId character = 0;
    std::vector<std::int32_t> triangles;
    std::optional<Vec3> point;
};

/// What to show beside the bodies.
struct SceneOptions {
    bool bones = false;         ///< bones with their joint points, held and pinned points; handles with theirs
    bool faces = false;         ///< outlines of joint faces
    bool bodies = false;        ///< bodies under render meshes, which are translucent then
    float bodyOpacity = 1.0f;   ///< < 1: x-ray
    /// A place to point out on the render mesh of a character; null: none.
    const MarkedPlace* marked = nullptr;
    std::vector<std::uint64_t> selected;  ///< scene ids
    [[nodiscard]] bool isSelected(std::uint64_t id) const { return std::find(selected.begin(), selected.end(), id) != selected.end(); }
    std::uint64_t hovered = 0;
    /// The renderer that will draw the scene, with its context current: its GPU deforms what it can. Null: the processor deforms all, which gives the same
    /// bytes on every machine.
    render::SceneRenderer* gpu = nullptr;
};

/// Decodes the textures that scenes of a document show, so that drawing does not wait for that. Any thread.
void decodeTextures(const Document& document);

/// The scene of a session. Keeps what does not change from frame to frame (outlines, covered triangles); one per view.
class DocumentScene {
public:
    /// Sets bodies, seams, markers and ground of `scene` to the session's present state; leaves camera, theme and the rest alone.
    /// Surfaces are pointed to, not copied: draw before the session changes again. Who deforms an element is decided here, and holds from the session's next
    /// frame on.
    void update(const Session& session, const SceneOptions& options, render::Scene& scene);

private:
    /// What is known of an element until it is replaced by a changed one.
    struct ElementParts {
        std::shared_ptr<const Element> element;
        std::shared_ptr<const std::vector<RimLoops>> rims;  ///< per face: closed loops of body vertices
        std::vector<int> coveredFaces;
        std::shared_ptr<const std::vector<std::int32_t>> covered;
        double lowest = 0.0;  ///< m, at rest
        std::vector<float> restPositions;  ///< #body vertices x 3, shown while the character cannot be built
        const float* shown = nullptr;      ///< #body vertices x 3 of this frame; null: nobody asked, or it is hidden
    };
    /// The same of a character.
    struct CharacterParts {
        std::shared_ptr<const RenderModel> model;
        std::shared_ptr<const EmbeddedMesh> embedded;
        std::vector<PartId> elements;
        std::vector<RenderPart> parts;
        std::vector<std::vector<float>> positions, normals;  ///< per part
        std::vector<std::vector<std::int32_t>> marked;       ///< per part, triangles
        double lowest = 0.0;                                 ///< m, at rest
    };
    /// Vertices of two joined faces that are one point, until one of the elements is replaced.
    struct Weld {
        std::shared_ptr<const Element> a, b;
        std::shared_ptr<const std::vector<std::pair<std::int32_t, std::int32_t>>> vertices;
    };
    ElementParts& parts(const std::shared_ptr<const Element>& element, const std::vector<int>& coveredFaces);
    /// Adds the body of an element as it is shown now, drawn from `scene.deformInput` where that may be.
    void addBody(const Session& session, const Element& element, ElementParts& p, const SceneOptions& options, render::Scene& scene) const;
    void addSeams(const Document& document, render::Scene& scene);
    // document_scene_characters.cpp
    void addRenderMeshes(const Session& session, const SceneOptions& options, render::Scene& scene);
    void addMarked(const SeenMesh& seen, CharacterParts& of, const MarkedPlace& marked, std::size_t firstBody, const std::vector<std::size_t>& partOf, render::Scene& scene);
    void addCuts(const Session& session, const SceneOptions& options, render::Scene& scene);
    void addBones(const Session& session, const SceneOptions& options, render::Scene& scene) const;
    void addFaces(const Document& document, const SceneOptions& options, render::Scene& scene);
    static void addHandles(const Session& session, const SceneOptions& options, render::Scene& scene);
    std::map<PartId, ElementParts> parts_;
    std::map<PartId, CharacterParts> characters_;
    std::map<std::pair<FaceRef, FaceRef>, Weld> welds_;
};

}  // namespace imomushi
