// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/base/result.h"
#include "core/character/embedded_mesh.h"
#include "core/character/pose_watch.h"
#include "core/character/response_blocks.h"
#include "core/character/vertex_kernels.h"
#include "core/joints/joint_face.h"
#include "core/reduction/element_response.h"
#include "core/reduction/embedded_mapping.h"
#include "core/touch/contact_surface.h"
#include "core/touch/dent_surface.h"
#include "core/touch/touch_blocks.h"
#include "core/touch/touch_surface.h"
#include "core/warp/bend_warp_tables.h"

namespace imomushi {

/// Which tables of an element effects ask for (EffectSettings::ask()).
struct ElementTables {
    std::vector<int> loads;  ///< columns of ElementResponse::loads that follow v, ascending
    bool freeEnd = false;    ///< ElementState::freeEnd, with the loads that move it
    int patches = 0;         ///< of touch, that its response has
    bool warp = false;       ///< ElementRuntime::warp
    bool fades = false;      ///< ElementRuntime::watch; frames without the warp are a product
    bool touch = false;      ///< ElementRuntime::touch
    bool contact = false;    ///< ElementRuntime::contact
    bool dents = false;      ///< ElementRuntime::dents; with touch
    bool operator==(const ElementTables&) const = default;
};

/// Adds columns of loads to those that are asked for.
void askForLoads(ElementTables& tables, std::initializer_list<int> columns);

/// Layout of the embedded points in a frame. Vertices of an element are, in this order: body vertices, padding, embedded points (point i is
/// vertex first + i), then kFrameVertices per attached part: its pivot and the points at distance `reach` (m) from it along x, y and z.
struct EmbeddedTables {
    static constexpr std::size_t kFrameVertices = 4;
    std::size_t first = 0;
    std::size_t count = 0;           ///< with those of attached parts
    double reach = 1.0;
    std::vector<std::int32_t> rows;  ///< the vertex of each point of the mapping, ascending: neither those at body vertices nor those that are attached
    EmbeddedMapping mapping;

    std::size_t parts = 0;           ///< attached ones

    /// The pivot of an attached part, among the element's vertices.
    [[nodiscard]] std::size_t frameOf(std::size_t part) const { return first + count - kFrameVertices * (parts - part); }
    /// All of them at rest, count x 3, m.
    [[nodiscard]] Points restOf(const EmbeddedPoints& points) const;
};

class ElementRuntimes;

/// What the frames of one element read and never change: it follows from its mesh, joint faces, response and settings alone, not from the pose nor from
/// other elements. Characters share runtimes: one that is built again takes over those whose input did not change.
struct ElementRuntime {
    struct Input {
        std::shared_ptr<const ElementMesh> mesh;
        std::vector<JointFace> faces;
        std::shared_ptr<const ElementResponse> response;  ///< may be null
        std::vector<char> covered;  ///< per face, 1: another face of its joint covers it, and its triangles are not seen
        ResponseFormat format = ResponseFormat::Float;
        ElementTables tables;
        double nu = 0.45;  ///< Poisson ratio, for the warp and embedded points
        std::shared_ptr<const EmbeddedPoints> embedded;  ///< may be null
    };
    /// Vertices whose triangles are all covered: they take the normal of their face.
    struct Hidden {
        std::int32_t vertex = 0;
        int face = 0;
        Vec3 normal = Vec3::UnitZ();  ///< at rest
    };

    /// Tables that the response has nothing for are left out. Errors: "bad-value" (the response belongs to another mesh or other faces).
    /// What `known` holds of the same tables is taken over.
    static Result<std::shared_ptr<const ElementRuntime>> build(Input input, const ElementRuntimes& known);

    [[nodiscard]] double inverseSize() const { return size > 0.0 ? 1.0 / size : 1.0; }
    [[nodiscard]] int columns() const { return input.response ? input.response->columns() : 0; }  ///< of v

    /// Null: without a response or joint faces. The first call builds it; any thread may call.
    [[nodiscard]] std::shared_ptr<const PoseWatch> findWatch() const;
    /// Of the body and embedded points, with the room that kernels write to behind them.
    [[nodiscard]] std::size_t paddedVertices() const;

    Input input;
    std::size_t vertices = 0;             ///< of the body
    Vec3 middle = Vec3::Zero();           ///< of its box at rest, m
    double size = 0.0;                    ///< diagonal of its box, m
    std::vector<Points> restOfFace;       ///< per face, its vertices in its axes; without a response: none
    std::vector<std::int32_t> free;       ///< body vertices that no joint places
    std::vector<Hidden> hidden;
    std::vector<NormalStencil> stencils;  ///< per vertex
    Eigen::VectorXd columnSize;           ///< per column (of v, then loads): the largest displacement per unit, m
    ResponseBlocks blocks;                ///< of free body vertices; of embedded points behind them where they are a product: without a warp, or with one that fades
    std::size_t bodyBlocks = 0;           ///< those of the body
    std::shared_ptr<const EmbeddedTables> embedded;  ///< null: there are none
    std::shared_ptr<const BendWarpTables> warp;  ///< null: not asked for
    std::shared_ptr<const PoseWatch> watch;      ///< of frames; null: not asked for
    std::shared_ptr<const LazyPoseWatch> lazyWatch;  ///< see findWatch()
    std::shared_ptr<const TouchSurface> touch;   ///< null: not asked for
    std::shared_ptr<const ContactSurface> contact;  ///< null: not asked for
    TouchBlocks touchBlocks;
    std::shared_ptr<const DentSurface> dents;    ///< null: not asked for
};

/// Whether the same response could belong to both: names and what is seen do not count.
bool sameJointFaces(const std::vector<JointFace>& a, const std::vector<JointFace>& b);

/// Calls take(vertex, column, block) for each body vertex of a joint face. `column`: first parameter of the face in v. `block`: 3 x parameters of the face, displacement in m per unit of them.
void forHeldVertices(const ElementRuntime::Input& input, const std::function<void(std::int32_t, int, const Eigen::MatrixXd&)>& take);

/// The runtimes of a character by their input.
class ElementRuntimes {
public:
    void add(std::shared_ptr<const ElementRuntime> runtime);
    /// Null: there is none of this input.
    [[nodiscard]] std::shared_ptr<const ElementRuntime> find(const ElementRuntime::Input& input) const;
    /// The embedded tables of this input from a runtime with another response. Null: there is none.
    [[nodiscard]] std::shared_ptr<const EmbeddedTables> findEmbedded(const ElementRuntime::Input& input) const;
    /// A runtime of this mesh with the same triangles seen, so that its stencils are the same. Null: there is none.
    [[nodiscard]] std::shared_ptr<const ElementRuntime> findSeenAlike(const ElementRuntime::Input& input) const;
    /// A runtime whose input differs in its embedded points alone. Null: there is none.
    [[nodiscard]] std::shared_ptr<const ElementRuntime> findLike(const ElementRuntime::Input& input) const;
    /// Of a runtime of this mesh, these faces and this response. Null: there is none.
    [[nodiscard]] std::shared_ptr<const LazyPoseWatch> findWatch(const ElementRuntime::Input& input) const;
    /// One of this mesh and these faces exists: they fit each other.
    [[nodiscard]] bool knows(const std::shared_ptr<const ElementMesh>& mesh, const std::vector<JointFace>& faces) const;
    /// One of this mesh, these faces and this response exists: they fit each other.
    [[nodiscard]] bool knows(const std::shared_ptr<const ElementMesh>& mesh, const std::vector<JointFace>& faces,
                             const std::shared_ptr<const ElementResponse>& response) const;

private:
    std::unordered_multimap<const ElementMesh*, std::shared_ptr<const ElementRuntime>> byMesh_;
};

}  // namespace imomushi
