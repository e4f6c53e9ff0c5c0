// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/hash.h"
#include "core/base/progress.h"
#include "core/character/character.h"
#include "core/character/standard_poses.h"

namespace imomushi {

/// A difference of two solutions on the vertices that are seen: of displacements in the frames of the elements, so that rigid motion hides nothing.
struct PoseError {
    double relative = 0.0;  ///< L2, 1: as large as the displacements of the reference
    double percent = 0.0;   ///< largest, % of the bounding-box diagonal of its element
};

/// Sums of squares behind PoseError, so that poses can be put together.
struct ErrorSum {
    double wrong = 0.0, all = 0.0, percent = 0.0;
    void add(const ErrorSum& other);
    [[nodiscard]] PoseError error() const;
};

/// The full solution of a character in some poses: every vertex of every joint face in equilibrium, while bones hold each face as a whole
/// (PreviousModel::statics), on the finest solver mesh that is affordable.
struct Reference {
    std::vector<std::vector<Points>> positions;  ///< per pose and element #body vertices x 3, world, m
    std::vector<std::vector<char>> seen;         ///< per element and vertex
    std::string mesh;                            ///< solver mesh, as settings name it
    double seconds = 0.0;                        ///< it took, with the full solution that it is from
    double solutionSeconds = 0.0;                ///< that this took alone
    /// Its own error, over all poses: what its solver mesh leaves, estimated by the difference from a coarser level. Negative: unknown.
    double relative = -1.0, percent = -1.0;
    /// The same for what is left because its joint faces have no freedom but at the vertices of the body: between them they bulge as the smooth part of their motion
    /// (36 warping modes) does. Estimated with another such part. Negative: unknown.
    double faceRelative = -1.0, facePercent = -1.0;
    std::string how;                             ///< one sentence: by what the error was estimated, or why it is unknown
};

struct ReferenceInput {
    CharacterInput character;             ///< responses are not looked at
    std::vector<ResponseInput> elements;  ///< as the document has them; basis, solver mesh and loads are not looked at
    std::vector<StandardPose> poses;
    double seconds = 0.0;                 ///< that it may take by estimate, 0: any
    double bytes = 4e9;                   ///< of memory, at most
};

/// The finest solver mesh within its limits; none: too large for all. Finer ones have larger ranks: 0 as-is, 1 default, 2 best.
std::optional<SolverMeshSetting::Kind> referenceMesh(const ReferenceInput& input, const Progress& progress = {});
int referenceRank(const std::string& mesh);

/// Everything that the full solution depends on but poses and limits: elements, skeleton and joints.
ContentKey referenceKey(const ReferenceInput& input);
/// Seconds, with what else the machine has to do now, and bytes of a FullSolution, estimated. Zeros where no mesh is within its limits.
ResponseEstimate referenceCost(const ReferenceInput& input, const Progress& progress = {});

/// The full solution of a character, solved once: each pose then takes no more than finding the equilibrium of its joint faces.
class FullSolution {
public:
    /// `input.poses` are not looked at. Errors: "no-face", "no-memory" (not even the bodies as they are can be solved within limits), those of buildResponse() and
    /// PreviousModel, "cancelled".
    static Result<FullSolution> build(const ReferenceInput& input, const Progress& progress);
    FullSolution(FullSolution&&) noexcept;
    FullSolution& operator=(FullSolution&&) noexcept;
    ~FullSolution();

    /// Its own error is that over these poses. Errors: those of PreviousModel::statics(), "cancelled".
    Result<Reference> in(const std::vector<StandardPose>& poses, const Progress& progress);
    [[nodiscard]] const std::string& mesh() const;  ///< see Reference
    [[nodiscard]] double seconds() const;           ///< that build() took
    [[nodiscard]] std::size_t bytes() const;        ///< that it keeps

private:
    struct State;
    explicit FullSolution(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// In the poses of the input. Errors: those of FullSolution.
Result<Reference> buildReference(const ReferenceInput& input, const Progress& progress);

/// Of a character that shows `pose` number `which` of the reference. Displacements are measured in the character's frames.
ErrorSum errorOf(const Character& character, const Reference& reference, std::size_t which);
/// The same of positions (per element #body vertices x 3, world), in the frames of a character in that pose.
ErrorSum errorOf(const Character& frames, const std::vector<Points>& positions, const Reference& reference, std::size_t which);
/// Distance of each vertex from the reference in % of the diagonal of its element; negative where it is not seen. Per element.
std::vector<std::vector<float>> errorField(const Character& character, const Reference& reference, std::size_t which);

/// The responses of all elements that have joint faces; of congruent elements only the first is solved. `seconds`: what each took, 0 without faces.
struct SolvedElements {
    std::vector<std::shared_ptr<const ElementResponse>> responses;
    std::vector<double> seconds;
    std::size_t peakBytes = 0;  ///< estimated
};
Result<SolvedElements> solveElements(const std::vector<ResponseInput>& elements, const Progress& progress);
/// What that would cost: the sum of seconds and the largest of bytes.
ResponseEstimate estimateElements(const std::vector<ResponseInput>& elements, const Progress& progress = {});

}  // namespace imomushi
