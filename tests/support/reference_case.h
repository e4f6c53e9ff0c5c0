// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/joints/face_basis.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A body of tests/data/reference: NAME.obj with its joint faces of NAME.faces.json.
struct ReferenceBody {
    std::string name;
    std::shared_ptr<ElementMesh> mesh;
    std::vector<JointFace> faces;
    std::vector<std::int32_t> freeVertices;  ///< ascending

    [[nodiscard]] double diagonal() const;  ///< of the bounding box, metres
};

/// One finite-element answer of NAME.json: what the joint faces do (a face that is not named is held at rest) and how every vertex moves.
struct ReferenceCase {
    std::string name;
    double nu = 0.0;
    std::map<std::string, PaperParameters> faces;
    Points displacement;  ///< #V x 3, metres
};

/// `folder` may end in a slash or not. Throw std::runtime_error with the file's name: these are our own files.
ReferenceBody readReferenceBody(const std::string& folder, const std::string& name);
std::vector<ReferenceCase> readReferenceCases(const std::string& folder, const std::string& name);

/// The finite-element answers of NAME.modes.json for one Poisson ratio: how some free vertices move while one face does one of the modes of its affine basis and the others rest.
struct ReferenceModes {
    double nu = 0.0;
    std::vector<std::int32_t> vertices;  ///< ascending
    std::vector<Points> displacement;    ///< per mode, of all faces in turn: #vertices x 3, metres
};
/// None: there is no such file.
std::vector<ReferenceModes> readReferenceModes(const std::string& folder, const std::string& name);
void writeReferenceModes(const std::string& folder, const std::string& name, const std::vector<ReferenceModes>& modes);

/// Eq. (5) at `points` (#P x 3, global axes), of which `onFace` names per joint face of the body those that lie on it: #P x 3, global axes,
/// zero everywhere else and on faces that `wanted` does not name.
Points faceDisplacement(const ReferenceBody& body, const ReferenceCase& wanted, const Points& points,
                        const std::vector<std::vector<std::int32_t>>& onFace);

/// |u - reference| over the free vertices, relative to |reference| over them (rel_l2) and over all vertices (rel_l2_scaled).
struct ReferenceError {
    double relative = 0.0, scaled = 0.0;
};
ReferenceError referenceError(const ReferenceBody& body, const Points& displacement, const Points& reference);

}  // namespace imomushi
