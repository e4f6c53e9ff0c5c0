// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "core/document/character_input.h"
#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kSkeletonTables = R"(
CREATE TABLE joints (id INTEGER PRIMARY KEY);
CREATE TABLE joint_faces (joint INTEGER, position INTEGER, element INTEGER, face TEXT, PRIMARY KEY (joint, position));
CREATE TABLE bones (id INTEGER PRIMARY KEY, name TEXT, element INTEGER, parent INTEGER, roll REAL, min_stretch REAL, max_stretch REAL,
    max_bend REAL, max_twist REAL, stiffness REAL, weight REAL, start_kind TEXT, start_part INTEGER, start_name TEXT, start_point BLOB, end_kind TEXT, end_part INTEGER, end_name TEXT, end_point BLOB, visible INTEGER,
    locked INTEGER);
CREATE TABLE held (bone INTEGER, at_end INTEGER, pinned INTEGER, target BLOB, roll REAL, turn BLOB, from_roll REAL, from_point BLOB, seconds REAL,
    elapsed REAL, PRIMARY KEY (bone, at_end));
CREATE TABLE pose (points BLOB, frames BLOB, rolls BLOB);
)";

struct PlaceRow {
    std::string kind, name;
    PartId part = 0;
    Vec3 point = Vec3::Zero();
};

PlaceRow placeRow(const Bone::Place& place) {
    if (const auto* face = std::get_if<FaceRef>(&place)) return {"face", face->face, face->element, Vec3::Zero()};
    if (const auto* end = std::get_if<EndpointRef>(&place)) return {"bone", end->atEnd ? "end" : "start", end->bone, Vec3::Zero()};
    return {"point", "", 0, std::get<Vec3>(place)};
}

Bone::Place readPlace(RowReader& rows) {
    const std::string kind = rows.text();
    const PartId part = readIdOrNone(rows);
    const std::string name = rows.text();
    const Vec3 at = readPoint(rows);
    if (kind == "face") return FaceRef{part, name};
    if (kind == "point") return at;
    require(kind == "bone" && (name == "start" || name == "end"), "the end of a bone is broken");
    return EndpointRef{part, name == "end"};
}

}  // namespace

void createSkeletonTables(Database& db) { db.run(kSkeletonTables); }

void writeSkeleton(Database& db, const Document& document) {
    RowWriter joints(db, "INSERT INTO joints VALUES (?)");
    for (const auto& [id, joint] : document.joints) joints.row(id);
    RowWriter jointFaces(db, "INSERT INTO joint_faces VALUES (?,?,?,?)");
    for (const auto& [id, joint] : document.joints)
        for (std::size_t i = 0; i < joint->faces.size(); ++i) jointFaces.row(id, i, joint->faces[i].element, joint->faces[i].face);
    RowWriter bones(db, "INSERT INTO bones VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [id, bone] : document.bones) {
        const PlaceRow s = placeRow(bone->start), e = placeRow(bone->end);
        bones.row(id, bone->name, bone->element, bone->parent, bone->roll, bone->minStretch, bone->maxStretch, bone->maxBend, bone->maxTwist, bone->stiffness,
                  bone->weight, s.kind, s.part, s.name, s.point, e.kind, e.part, e.name, e.point, bone->visible, bone->locked);
    }
    RowWriter held(db, "INSERT INTO held VALUES (?,?,?,?,?,?,?,?,?,?)");
    for (const auto& [end, h] : document.goals)
        held.row(end.bone, end.atEnd, h.pinned, h.target, h.roll, h.rotation ? std::vector<double>(h.rotation->begin(), h.rotation->end()) : std::vector<double>(), h.fromRoll, h.from, h.seconds, h.elapsed);
    std::vector<double> points, frames;
    for (const Vec3& p : document.pose.points) points.insert(points.end(), p.data(), p.data() + 3);
    for (const auto& q : document.pose.frames) frames.insert(frames.end(), q.coeffs().data(), q.coeffs().data() + 4);
    RowWriter pose(db, "INSERT INTO pose VALUES (?,?,?)");
    pose.row(points, frames, document.pose.roll);
}

void readSkeleton(Database& db, Document& document) {
    std::map<PartId, Joint> joints;
    RowReader jointRows(db, "SELECT * FROM joints ORDER BY id");
    while (jointRows.next()) {
        const PartId part = readId(jointRows);
        joints[part].id = part;
    }
    std::set<FaceRef> joined;
    RowReader faceRows(db, "SELECT * FROM joint_faces ORDER BY joint, position");
    while (faceRows.next()) {
        const auto joint = joints.find(readId(faceRows));
        require(joint != joints.end(), "a joint is missing");
        auto& faces = joint->second.faces;
        readPosition(faceRows, faces.size());
        FaceRef face;
        face.element = readId(faceRows);
        face.face = faceRows.text();
        const auto element = document.elements.find(face.element);
        require(element != document.elements.end() && element->second->faceIndex(face.face) >= 0, "a joint names a face that is not there");
        require(joined.insert(face).second, "a face is in two joints");
        faces.push_back(std::move(face));
    }
    for (auto& [part, joint] : joints) {
        require(joint.faces.size() >= 2, "a joint has fewer than two faces");
        document.joints.emplace(part, std::make_shared<const Joint>(std::move(joint)));
    }

    RowReader bones(db, "SELECT * FROM bones ORDER BY id");
    while (bones.next()) {
        Bone bone;
        bone.id = readId(bones);
        bone.name = bones.text();
        bone.element = readIdOrNone(bones);
        bone.parent = readIdOrNone(bones);
        readColumns(bones, Within{bone.roll, -1e6, 1e6}, Within{bone.minStretch, 0.01, 1.0}, Within{bone.maxStretch, 1.0, 100.0},
                    Within{bone.maxBend, 0.0, Skeleton::Bone::kFreeBend}, Within{bone.maxTwist, 0.0, Skeleton::Bone::kFreeTwist},
                    Within{bone.stiffness, 1.0 / Bone::kMaxRatio, Bone::kMaxRatio}, Within{bone.weight, 1.0 / Bone::kMaxRatio, Bone::kMaxRatio});
        bone.start = readPlace(bones);
        bone.end = readPlace(bones);
        readColumns(bones, bone.visible, bone.locked);
        require(checkNewName(document, bone.name).has_value(), "a name is broken or used twice");
        require(bone.element == 0 || document.elements.contains(bone.element), "a bone runs through an element that is not there");
        document.bones.emplace(bone.id, std::make_shared<const Bone>(std::move(bone)));
    }
    for (const auto& [part, bone] : document.bones) require(bone->parent == 0 || document.bones.contains(bone->parent), "the parent of a bone is missing");
    const auto plan = planCharacter(document);
    if (!plan) throw DatabaseError(plan.error().message);

    RowReader held(db, "SELECT * FROM held ORDER BY bone, at_end");
    while (held.next()) {
        EndpointRef end;
        end.bone = readId(held);
        end.atEnd = held.boolean();
        EndpointGoal h;
        readColumns(held, h.pinned, h.target);
        h.roll = held.optionalReal();
        require(!h.roll || std::abs(*h.roll) <= 1e6, "a roll is out of range");
        const auto turn = held.array<double>(4);
        if (!turn.empty()) {
            require(turn.size() == 4 && allFinite(turn), "a held bone is broken");
            std::copy(turn.begin(), turn.end(), h.rotation.emplace().begin());
            require(std::abs(Eigen::Quaterniond(turn.data()).norm() - 1.0) < 1e-6, "a held bone has no rotation");
        }
        readColumns(held, Within{h.fromRoll, -1e9, 1e9}, h.from, Within{h.seconds, 0.0, 1e6}, Within{h.elapsed, 0.0, 1e6});
        require(document.bones.contains(end.bone), "a held endpoint is missing");
        document.goals.emplace(end, h);
    }
    RowReader pose(db, "SELECT * FROM pose");
    require(pose.next(), "the pose is missing");
    const auto points = pose.array<double>(3), frames = pose.array<double>(4);
    document.pose.roll = pose.array<double>();
    const Skeleton& skeleton = plan->input.skeleton;
    if (!points.empty() || !frames.empty() || !document.pose.roll.empty()) {
        require(points.size() == 3 * skeleton.points.size() && frames.size() == 4 * skeleton.bones.size() &&
                    document.pose.roll.size() == skeleton.points.size(),
                "the pose belongs to another skeleton");
        require(allCoordinates(points) && allCoordinates(frames) && allCoordinates(document.pose.roll), "the pose is out of range");
    }
    for (std::size_t i = 0; i < points.size(); i += 3) document.pose.points.emplace_back(points[i], points[i + 1], points[i + 2]);
    for (std::size_t i = 0; i < frames.size(); i += 4) {
        const Eigen::Quaterniond q(frames[i + 3], frames[i], frames[i + 1], frames[i + 2]);
        require(std::abs(q.norm() - 1.0) < 1e-6, "the pose holds no rotation");
        document.pose.frames.push_back(q);
    }
}

}  // namespace imomushi
