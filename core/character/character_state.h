// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <memory>
#include <span>
#include <vector>

#include "core/character/deform_input.h"
#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/character/render_mesh_job.h"
#include "core/skeleton/skeleton.h"

// Of the character's own files alone.
namespace imomushi {

/// What a character is between frames: the data of its frame, the jobs of its effects, and the steps that every character has.
struct Character::State {
    // The normal of a vertex on a seam is shared with a place on an edge of the other rim.
    struct SeamNormal {
        int element = 0, other = 0;
        std::int32_t vertex = 0, from = 0, to = 0;  // those of rims: indices into ElementState::rim
        std::int32_t own = 0;
        float part = 0.0f;  // of the way from `from` to `to`
    };
    // A piece of an element for one thread: blocks, or vertices of normals.
    struct Piece {
        int element = 0;
        std::size_t begin = 0, end = 0;
        bool unseen = false;  // of blocks: no render mesh needs their vertices (ElementState::unseen)
    };

    explicit State(CharacterInput given);

    // Once (character_build.cpp).
    Result<void> build(const ElementRuntimes& known);
    Result<std::shared_ptr<const ElementRuntime>> runtimeOf(std::size_t e, const ElementRuntimes& known);
    void buildJoint(std::size_t j, double contraction);
    void buildHandles();
    void buildElement(std::size_t e);
    void holdFaces(std::size_t j);
    void splitWork();
    // seenVertices: of the element.
    void splitWork(std::size_t e, const std::vector<char>& seenVertices);
    // Per element that a render mesh shows, and body vertex: 1 where it is one of that mesh. Others: none.
    [[nodiscard]] std::vector<std::vector<char>> seenVertices() const;
    // Which vertices of two joined rims share normals. rimOf: per element and body vertex, its index in the rim, -1: none yet.
    void buildSeam(const CharacterInput::Joint& joint, std::vector<std::vector<std::int32_t>>& rimOf);

    // Each frame (character.cpp).
    void update(const Pose& wanted, double seconds, bool again);
    void beginTimes();
    // Its second half: what vertices do.
    void showShape(std::chrono::steady_clock::time_point start);
    void assign(const Pose& p);

    // Pose -> joints and v (character_pose.cpp).
    [[nodiscard]] Eigen::Quaterniond rolled(int bone) const;
    void placeElement(std::size_t e);
    // The joints of handles, and elements that move with them (character_handles.cpp).
    void placeHandle(std::size_t h);
    void fitElement(ElementState& element) const;
    void placeJoint(std::size_t j);
    void mapJoint(JointState& joint) const;
    // The joints of an element in its own frame, as coefficients of its bases.
    void findParameters(std::size_t e);
    // How much of automatic effects this pose calls for, by what the product would show; joints with it.
    void weighEffects();
    // Of its faces, into `watched`.
    void findMotions(ElementState& element) const;

    // v -> vertices (character_surface.cpp).
    void findMoved(ElementState& out);
    void decideWork(ElementState& out);
    static void showPositions(ElementState& out, std::size_t begin, std::size_t end);
    // Nothing presses yet, or what a shape that is shown again says.
    void beginDents(ElementState& out) const;
    void placeDents();
    void holdVertices(ElementState& out) const;
    void holdNormals(ElementState& out) const;
    void closeSeams();
    // True: the normal changed.
    bool closeSeam(const SeamNormal& s);

    // Deformation by others (deform_input.cpp).
    [[nodiscard]] bool canDeformExternally(const ElementState& e) const;
    void buildDeformInput();
    void fillDeformInput(std::size_t e);
    // Positions and normals of an element as of the last update().
    void catchUp(std::size_t e);
    // The same without normals on seams.
    void evaluateHere(std::size_t e);
    // What render meshes need of an element.
    void evaluateSeen(std::size_t e);
    void catchUpMesh(int mesh);

    Frame frame;
    FrameJobs jobs;
    double dentMs = 0.0;  // of placing dents, since beginTimes()
    bool weighs = false;  // effects are automatic
    const Pose poseOfRest = restPose(frame.input.skeleton);
    RenderMeshJob* renderMeshes = nullptr;  // of jobs, null: none
    InverseKinematics kinematics;
    std::vector<std::vector<int>> jointsOf;  // per element: those that its faces belong to, ascending
    std::vector<SeamNormal> seams;
    std::vector<Piece> productPieces, normalPieces;
    std::unique_ptr<DeformInput> deformInput;  // null: nobody asked for it
    std::vector<char> seamOnly;             // per element, of one frame: only normals on its seams changed
    unsigned solveWarnings = 0;
};

}  // namespace imomushi
