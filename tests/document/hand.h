// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iterator>
#include <random>
#include <string>

#include "core/document/kept_pose.h"
#include "core/session/session.h"

namespace imomushi {

/// Somebody who tries everything: commands with arguments by chance, most of which fit the document.
class Hand {
public:
    /// `folder`: where what is copied goes, and "added.imomushi" is a small project; empty: nothing is copied, added or cut.
    Hand(const Session& session, unsigned seed, std::string folder = {}) : session_(session), random_(seed), folder_(std::move(folder)) {}

    /// What a command answered: what was copied is pasted later.
    void heard(const Json& command, const Json& answer) {
        if (command.at("do") == "copy") copied_ = answer.at("commands");
    }

    std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
    double number(double low, double high) { return low + (high - low) * static_cast<double>(random_()) / 4294967295.0; }

    Json command() {
        const Document& d = session_.document();
        if (d.elements.size() < 2 || (d.elements.size() < 6 && below(12) == 0)) return import();
        if (d.bones.size() < 2 && below(2)) return below(2) ? addFace() : Json{{"do", "add-bone"}, {"name", name()}, {"from", face()}, {"to", face()}};
        if (d.takes.empty() && below(6) == 0) return {{"do", "record"}, {"take", "take"}, {"action", below(2) ? "start" : "stop"}};
        switch (below(folder_.empty() ? 39 : 47)) {
            case 0: return addFace();
            case 1:
            case 2: return {{"do", "join"}, {"a", face()}, {"b", face()}};
            case 3: return {{"do", "unjoin"}, {"face", face()}};
            case 4: return {{"do", below(3) ? "undo" : "remove-joint-face"}, {below(3) ? "count" : "face", below(2) ? Json(1) : Json(face())}};
            case 5:
            case 6: return {{"do", "add-bone"}, {"name", name()}, {"from", end()}, {"to", end()}};
            case 7: return {{"do", "edit-bone"}, {"name", bone()}, {below(2) ? "from" : "to", end()}};
            case 8: return {{"do", "remove-bone"}, {"name", bone()}};
            case 9: return below(4) ? import() : Json{{"do", "remove-element"}, {"name", element()}};
            case 10: return {{"do", "rename"}, {"target", below(2) ? element() : bone()}, {"name", name()}};
            case 11: return {{"do", "set"}, {"target", element()}, {"property", one({"nu", "stiffness", "density", "damping"})}, {"value", number(-0.1, 1.0)}};
            case 12: return {{"do", "set"}, {"target", bone()}, {"property", one({"min-stretch", "max-twist", "stiffness", "weight"})}, {"value", number(0.0, 2.0)}};
            case 13: return {{"do", "set"}, {"target", "character"}, {"property", one({"basis", "threads", "rate"})}, {"value", below(2) ? Json(one({"paper", "affine", "modes:6"})) : below(2) ? Json(below(3)) : Json(60 << below(3))}};
            case 14: return {{"do", below(3) ? "enable" : "disable"}, {"effect", effect()}};
            case 15: return {{"do", "set"}, {"target", effect()}, {"property", one({"damping", "strength", "height", "sag", "amount"})}, {"value", number(-1.0, 3.0)}};
            case 16:
            case 17:
            case 18: return {{"do", "drag"}, {"endpoint", end()}, {"to", place(8.0)}};
            case 19: return {{"do", "drag"}, {"endpoint", end()}, {"to", place(2.0)}, {"roll", number(-3.0, 3.0)}, {"seconds", number(0.0, 0.2)}};
            case 20: return {{"do", below(2) ? "pin" : "unpin"}, {"endpoint", end()}};
            case 21: return below(2) ? Json{{"do", "release"}} : Json{{"do", "release"}, {"endpoint", end()}};
            case 22: return {{"do", "rest"}};
            case 23: return {{"do", "step"}, {"frames", 1 + below(4)}};
            case 24: return {{"do", "touch"}, {"element", element()}, {"point", vertex()}, {"to", below(2) ? vertex() : Json()}};
            case 25: return {{"do", "handle"}, {"element", element()}, {"point", vertex()}, {"radius", number(0.2, 0.6)}};
            case 26: return {{"do", "remove-handle"}, {"handle", handle()}};
            case 27: return {{"do", "record"}, {"take", below(2) ? "take" : name()}, {"action", below(2) ? "start" : "stop"}};
            case 28: return {{"do", one({"remove-take", "play"})}, {"take", take()}};
            case 29: return {{"do", one({"rename-take", "duplicate-take"})}, {"take", take()}, {"name", name()}};
            case 30: return {{"do", "duplicate"}, {"names", {below(2) ? element() : bone()}}};
            case 31: return mirror();
            case 32: return {{"do", one({"undo", "redo"})}, {"count", 1 + below(4)}};
            case 33: return below(2) ? Json{{"do", "keep-pose"}} : Json{{"do", "keep-pose"}, {"name", name()}};
            case 34: return {{"do", "apply-pose"}, {"name", pose()}, {"share", number(-0.1, 1.1)}, {"mirrored", below(2) == 0}};
            case 35: return below(2) ? Json{{"do", "mirror-pose"}} : Json{{"do", "rest-bones"}, {"bones", {bone()}}, {"chain", below(2) == 0}};
            case 36: return below(2) ? Json{{"do", "set"}, {"target", handle()}, {"property", "point"}, {"value", vertex()}} : below(2) ? Json{{"do", "rename-pose"}, {"pose", pose()}, {"name", name()}} : Json{{"do", "remove-pose"}, {"pose", pose()}};
            case 37: return below(2) ? transform() : editFace();
            case 39:
            case 40: return copy();
            case 41:
            case 42: return paste();
            case 43: return {{"do", "set"}, {"target", below(2) ? element() : below(3) == 0 ? bone() : below(2) ? face() : cutName()}, {"property", one({"visible", "locked"})}, {"value", below(2) == 0}};
            case 44: return d.elements.size() < 8 && below(3) == 0 ? Json{{"do", "append"}, {"path", folder_ + "/added.imomushi"}, {"beside", below(2) == 0}} : Json{{"do", "undo"}};
            case 45: return cut();
            case 46: return below(2) ? moveCut() : below(2) ? Json{{"do", "remove-cut"}, {"cut", cutName()}} : Json{{"do", "make-character"}, {"element", element()}};
            default: return below(4) ? Json{{"do", "redo"}} : Json{{"do", "precompute"}};
        }
    }

private:
    std::string one(std::initializer_list<const char*> list) { return *(list.begin() + static_cast<std::ptrdiff_t>(below(list.size()))); }
    template <class Parts>
    std::string nameIn(const Parts& parts, const char* none) {
        if (parts.empty() || below(40) == 0) return none;
        return std::next(parts.begin(), static_cast<std::ptrdiff_t>(below(parts.size())))->second->name;
    }
    std::string element() { return nameIn(session_.document().elements, "nobody"); }
    std::string bone() { return nameIn(session_.document().bones, "no bone"); }
    std::string take() { return nameIn(session_.document().takes, "no take"); }
    std::string pose() {
        const KeptPoses& poses = keptPoses(session_.document());
        return poses.empty() || below(40) == 0 ? "no pose" : poses[below(poses.size())].name;
    }
    std::string face() {
        const auto& elements = session_.document().elements;
        const auto& e = *std::next(elements.begin(), static_cast<std::ptrdiff_t>(below(elements.size())))->second;
        return e.name + "/" + (e.faces.empty() ? "in" : e.faces[below(e.faces.size())].name);
    }
    std::string handle() {
        for (const auto& [id, e] : session_.document().elements)
            if (!e->handles.empty() && below(2)) return e->handles[below(e->handles.size())].face;
        return "no handle";
    }
    std::string end() {
        if (below(6) == 0) return face();
        if (below(8) == 0) return handle();
        return bone() + one({"/start", "/end"});
    }
    std::string effect() { return one({"bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "gravity", "inflate", "touch", "contact", "ground"}); }
    /// Names that a person gives, and some that are taken or not allowed.
    std::string name() { return one({"arm", "Arm", "足", "tail.L", "tail.R", "a/b", "", "bar0", "いもむし 1"}) + (below(2) ? std::to_string(below(50)) : ""); }
    Json place(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach + 6.0)}; }
    /// The end of a bar, mostly.
    Json addFace() {
        const auto& elements = session_.document().elements;
        const Element& e = *std::next(elements.begin(), static_cast<std::ptrdiff_t>(below(elements.size())))->second;
        const bool far = below(2);
        const auto z = e.mesh->body.vertices.col(2);
        const double side = far ? z.maxCoeff() : z.minCoeff();
        return {{"do", "add-joint-face"}, {"element", e.name}, {"name", far ? "out" : "in"}, {"plane", {{"origin", {0, 0, side}}, {"normal", {0, 0, far ? 1 : -1}}}}};
    }
    /// A ring more or less, or what it has and a place beside it, or one vertex less.
    Json editFace() {
        Json made{{"do", "edit-joint-face"}, {"face", face()}};
        const auto ref = session_.document().face(made["face"].get<std::string>());
        if (!ref || below(2)) {
            made["grow"] = static_cast<int>(below(5)) - 2;
            return made;
        }
        const Element& e = *session_.document().elements.at(ref->element);
        std::vector<std::int32_t> vertices = e.faces[static_cast<std::size_t>(e.faceIndex(ref->face))].vertices;
        if (below(2)) vertices.erase(vertices.begin() + static_cast<std::ptrdiff_t>(below(vertices.size())));
        if (below(2)) vertices.push_back(static_cast<std::int32_t>(below(static_cast<std::size_t>(e.mesh->body.vertices.rows()))));
        made["vertices"] = vertices;
        return made;
    }
    Json vertex() {
        const auto& elements = session_.document().elements;
        const Points& all = std::next(elements.begin(), static_cast<std::ptrdiff_t>(below(elements.size())))->second->mesh->body.vertices;
        const auto v = static_cast<Eigen::Index>(below(static_cast<std::size_t>(all.rows())));
        return {all(v, 0), all(v, 1), all(v, 2)};
    }
    Json transform() {
        Json made{{"do", "transform"}, {"names", {element()}}};
        if (below(2)) made["shift"] = place(1.0);
        if (below(3) == 0) made["rotation"] = {number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)};
        if (below(6) == 0) made["scale"] = number(-0.1, 2.0);
        return made;
    }
    /// As live symmetry does it, too: left and right of a plane.
    Json mirror() {
        Json made{{"do", "mirror"}, {"from", {below(3) == 0 ? element() : below(2) ? bone() : below(2) ? face() : handle()}}};
        if (below(2)) made["axis"] = one({"x", "y", "z"});
        if (below(2)) made["at"] = number(-1.0, 1.0);
        return made;
    }
    Json copy() {
        Json names = Json::array();
        for (std::size_t n = 1 + below(3); n > 0; --n) names.push_back(below(3) ? bone() : below(2) ? face() : below(2) ? effect() : element());
        return {{"do", "copy"}, {"names", std::move(names)}, {"path", folder_ + "/copied.imomushi"}};
    }
    Json paste() {
        Json made{{"do", "paste"}, {"commands", copied_}};
        if (below(2)) made["onto"] = element();
        if (below(3) == 0) made["offset"] = place(1.0);
        return made;
    }
    Json plane(const std::string& of) {
        const Element* e = session_.document().elementNamed(of);
        const Vec3 at = e ? Vec3(e->mesh->body.vertices.colwise().mean().transpose()) : Vec3::Zero();
        return {{"origin", {at.x(), at.y(), at.z() + number(-0.6, 0.6)}}, {"normal", {number(-0.3, 0.3), number(-0.3, 0.3), below(2) ? 1.0 : -1.0}}};
    }
    Json cut() {
        const std::string of = element();
        return {{"do", "cut"}, {"element", of}, {"plane", plane(of)}};
    }
    Json moveCut() { return {{"do", "move-cut"}, {"cut", cutName()}, {"plane", plane(element())}}; }
    std::string cutName() {
        for (const auto& [id, character] : session_.document().characters)
            if (!character->cuts.empty()) return character->cuts[below(character->cuts.size())].name;
        return "no cut";
    }
    Json import() {
        const std::string place = std::to_string(below(5));
        return {{"do", "import-element"}, {"path", one({"bar", "bar", "coarse"}) + place}, {"name", name()}};
    }

    const Session& session_;
    std::mt19937 random_;
    std::string folder_;
    Json copied_ = Json::array();
};

}  // namespace imomushi
