// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/mend.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <unordered_map>

#include "core/mesh/cgal/fill_hole.h"
#include "core/mesh/shells.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"

namespace imomushi {
namespace {

/// Seams that writers rounded apart: a millionth of the size, or what single precision loses at these coordinates.
constexpr double kSeam = 1e-6;
constexpr double kSeamUlps = 4.0;
/// A seam tolerance above this part of the size would eat detail: such a file has lost its shape already.
constexpr double kWidestSeam = 1e-4;
/// Largest cap relative to the surface it closes. A hemisphere needs 0.5; a sheet would be closed by its own mirror image, 1.
constexpr double kLargestCap = 0.75;
constexpr int kDegeneratePasses = 20;
/// A triangle whose shortest side is below this part of its longest is a needle and is collapsed; others are flipped away.
constexpr double kNeedle = 1e-6;
constexpr int kMostBodies = 1024;

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

struct Face {
    std::array<std::int32_t, 3> v;  // body vertices
    std::array<std::int32_t, 3> r;  // render vertices
    std::int32_t material = -1;
    std::int32_t part = 0;
    bool turned = false;            // wound the other way than in the file
};

void turn(Face& f) {
    std::swap(f.v[1], f.v[2]);
    std::swap(f.r[1], f.r[2]);
    f.turned = !f.turned;
}

Triangles corners(const std::vector<Face>& faces) {
    Triangles t(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (int k = 0; k < 3; ++k) t(static_cast<Eigen::Index>(f), k) = faces[f].v[static_cast<std::size_t>(k)];
    return t;
}

std::string counted(std::size_t n, const char* one, const char* many) { return std::to_string(n) + " " + (n == 1 ? one : many); }

class Mender {
public:
    explicit Mender(RawSurface surface) : points_(std::move(surface.mesh.body.vertices)), look_(std::move(surface.mesh.look)) {
        const Triangles& triangles = surface.mesh.body.triangles;
        const bool plain = look_.triangles.rows() == 0;
        faces_.resize(static_cast<std::size_t>(triangles.rows()));
        for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
            Face& face = faces_[static_cast<std::size_t>(f)];
            for (int k = 0; k < 3; ++k) {
                face.v[static_cast<std::size_t>(k)] = triangles(f, k);
                face.r[static_cast<std::size_t>(k)] = plain ? triangles(f, k) : look_.triangles(f, k);
            }
            if (!look_.material.empty()) face.material = look_.material[static_cast<std::size_t>(f)];
            if (!surface.part.empty()) face.part = surface.part[static_cast<std::size_t>(f)];
        }
        attributes_ = look_.normals.rows() + look_.texCoords.rows() + look_.colors.rows() > 0;
    }

    MendResult run(bool split) {
        dropUnused();
        dropCollapsed();
        weld();
        dropDuplicates();
        mendDegenerate();
        if (collapsed_ > 0)
            say("degenerate", counted(collapsed_, "triangle without area was", "triangles without area were") + " removed.", collapsed_);
        windConsistently();
        capHoles();
        return makeBodies(split);
    }

private:
    void say(const char* code, std::string text, std::size_t count) {
        MeshIssue issue;
        issue.severity = Severity::Info;
        issue.code = code;
        issue.text = std::move(text);
        issue.count = static_cast<int>(count);
        issue.fixed = true;
        issues_.push_back(std::move(issue));
    }

    void dropUnused() {
        std::vector<char> used(static_cast<std::size_t>(points_.rows()), 0);
        for (const Face& f : faces_)
            for (const std::int32_t v : f.v) used[at(v)] = 1;
        const auto unused = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
        if (unused > 0)
            say("unused-vertex", counted(unused, "vertex belongs to no triangle and was", "vertices belong to no triangle and were") + " dropped.",
                unused);
        // Left where they are: they only must not spoil the box, which welding tolerances follow.
        low_ = Vec3::Constant(std::numeric_limits<double>::max());
        high_ = -low_;
        for (std::size_t v = 0; v < used.size(); ++v) {
            if (!used[v]) continue;
            low_ = low_.cwiseMin(points_.row(static_cast<Eigen::Index>(v)).transpose());
            high_ = high_.cwiseMax(points_.row(static_cast<Eigen::Index>(v)).transpose());
        }
    }

    /// Triangles with the same vertex twice.
    void dropCollapsed() {
        collapsed_ += std::erase_if(faces_, [](const Face& f) { return f.v[0] == f.v[1] || f.v[1] == f.v[2] || f.v[2] == f.v[0]; });
    }

    struct Faults {
        std::size_t open = 0, nonManifold = 0;
    };
    static Faults faults(const EdgeTable& edges) {
        Faults n;
        for (int e = 0; e < edges.size(); ++e) {
            n.open += edges.uses(e).size() == 1;
            n.nonManifold += edges.uses(e).size() > 2;
        }
        return n;
    }

    std::vector<char> openVertices(const EdgeTable& edges) const {
        std::vector<char> open(static_cast<std::size_t>(points_.rows()), 0);
        for (int e = 0; e < edges.size(); ++e) {
            if (edges.uses(e).size() != 1) continue;
            open[at(edges.uses(e)[0].low)] = open[at(edges.uses(e)[0].high)] = 1;
        }
        return open;
    }

    /// Merges vertices if that closes open edges without new non-manifold ones (or `always`). Says how many went.
    std::size_t merge(const std::vector<std::int32_t>& standsFor, const Faults& before, bool always) {
        std::size_t merged = 0;
        for (std::size_t v = 0; v < standsFor.size(); ++v) merged += standsFor[v] != static_cast<std::int32_t>(v);
        if (merged == 0) return 0;
        std::vector<Face> kept = faces_;
        const std::size_t collapsedBefore = collapsed_;
        for (Face& f : faces_)
            for (std::int32_t& v : f.v) v = standsFor[at(v)];
        dropCollapsed();
        const Faults after = faults(EdgeTable(corners(faces_)));
        if (always || (after.open < before.open && after.nonManifold <= before.nonManifold)) return merged;
        faces_ = std::move(kept);
        collapsed_ = collapsedBefore;
        return 0;
    }

    void weld() {
        std::size_t exact = 0;
        EdgeTable edges(corners(faces_));
        Faults state = faults(edges);
        if (state.open == 0) return;
        std::vector<std::int32_t> group(static_cast<std::size_t>(points_.rows()), -1);
        bool severalParts = false;
        for (const Face& f : faces_) {
            severalParts = severalParts || f.part != faces_.front().part;
            for (const std::int32_t v : f.v)
                if (group[at(v)] < 0) group[at(v)] = f.part;
        }
        // Parts first: neighbours that only touch (a character in pieces) stay apart where each piece closes by itself.
        exact += merge(weldExact(points_, openVertices(edges), group), state, true);
        edges = EdgeTable(corners(faces_));
        state = faults(edges);
        if (state.open > 0 && severalParts) {
            exact += merge(weldExact(points_, openVertices(edges), {}), state, false);
            edges = EdgeTable(corners(faces_));
            state = faults(edges);
        }
        if (exact > 0) say("unwelded", counted(exact, "vertex", "vertices") + " at the same place as others were merged with them.", exact);
        if (state.open == 0) return;
        const double size = (high_ - low_).norm();
        const double farthest = std::max(low_.cwiseAbs().maxCoeff(), high_.cwiseAbs().maxCoeff());
        const double tolerance = std::min(std::max(kSeam * size, kSeamUlps * double{FLT_EPSILON} * farthest), kWidestSeam * size);
        const std::size_t near = merge(weldNear(points_, openVertices(edges), tolerance), state, false);
        if (near > 0)
            say("unwelded", counted(near, "vertex", "vertices") + " within a millionth of the size of others were merged with them.", near);
    }

    void dropDuplicates() {
        const std::vector<std::int32_t> copies = duplicateTriangles(corners(faces_));
        std::int32_t f = 0;
        const std::size_t dropped = std::erase_if(faces_, [&](const Face&) { return std::binary_search(copies.begin(), copies.end(), f++); });
        if (dropped > 0)
            say("duplicate-triangle", counted(dropped, "triangle that lay on another was", "triangles that lay on others were") + " removed.",
                dropped);
    }

    [[nodiscard]] double length(std::int32_t a, std::int32_t b) const { return (points_.row(a) - points_.row(b)).norm(); }

    [[nodiscard]] bool flat(std::int32_t a, std::int32_t b, std::int32_t c) const {
        const double longest = std::max({length(a, b), length(b, c), length(c, a)});
        if (!(longest > 0.0)) return true;
        const Vec3 p = (points_.row(b) - points_.row(a)).transpose() / longest, q = (points_.row(c) - points_.row(a)).transpose() / longest;
        return p.cross(q).norm() < kFlat;
    }

    /// Triangles without area: removed where an edge of theirs is open or has too many triangles, collapsed where two corners (nearly)
    /// coincide, else flipped with the neighbour at the longest side. Each pass changes places that do not touch.
    void mendDegenerate() {
        for (int pass = 0; pass < kDegeneratePasses; ++pass) {
            std::vector<std::int32_t> bad;
            for (std::size_t f = 0; f < faces_.size(); ++f)
                if (flat(faces_[f].v[0], faces_[f].v[1], faces_[f].v[2])) bad.push_back(static_cast<std::int32_t>(f));
            if (bad.empty()) return;
            const EdgeTable edges(corners(faces_));
            std::unordered_map<std::int32_t, std::vector<std::int32_t>> around;  // faces at the vertices of the bad ones
            for (const std::int32_t f : bad)
                for (const std::int32_t v : faces_[at(f)].v) around[v];
            for (std::size_t f = 0; f < faces_.size(); ++f)
                for (const std::int32_t v : faces_[f].v)
                    if (const auto it = around.find(v); it != around.end()) it->second.push_back(static_cast<std::int32_t>(f));
            std::set<std::int32_t> touched;
            std::vector<std::int32_t> standsFor(static_cast<std::size_t>(points_.rows()));
            std::iota(standsFor.begin(), standsFor.end(), 0);
            std::vector<char> remove(faces_.size(), 0);
            bool changed = false;
            const auto neighbours = [&](std::int32_t v) {
                std::set<std::int32_t> ring;
                for (const std::int32_t f : around[v])
                    for (const std::int32_t w : faces_[at(f)].v)
                        if (w != v) ring.insert(w);
                return ring;
            };
            for (const std::int32_t f : bad) {
                Face& face = faces_[at(f)];
                if (std::any_of(face.v.begin(), face.v.end(), [&](std::int32_t v) { return touched.contains(v); })) continue;
                bool manifold = true;
                for (int k = 0; k < 3; ++k) manifold = manifold && edges.uses(edges.edgeOf(f, k)).size() == 2;
                int longest = 0, shortest = 0;  // the side from this corner to the next
                for (int k = 1; k < 3; ++k) {
                    const auto side = [&](int s) { return length(face.v[static_cast<std::size_t>(s)], face.v[static_cast<std::size_t>((s + 1) % 3)]); };
                    if (side(k) > side(longest)) longest = k;
                    if (side(k) < side(shortest)) shortest = k;
                }
                const auto corner = [](int k) { return static_cast<std::size_t>(k % 3); };
                const std::int32_t a = face.v[corner(longest)], b = face.v[corner(longest + 1)], m = face.v[corner(longest + 2)];
                const std::int32_t p = face.v[corner(shortest)], q = face.v[corner(shortest + 1)];
                if (!manifold) {
                    remove[at(f)] = 1;
                    for (const std::int32_t v : face.v) touched.insert(v);
                } else if (length(p, q) <= kNeedle * length(a, b)) {
                    // The link condition: the two ends share just the tips of the two triangles at the side, or the surface would pinch.
                    const std::set<std::int32_t> ringP = neighbours(p), ringQ = neighbours(q);
                    std::vector<std::int32_t> common;
                    std::set_intersection(ringP.begin(), ringP.end(), ringQ.begin(), ringQ.end(), std::back_inserter(common));
                    if (common.size() != 2) continue;
                    if (std::any_of(ringP.begin(), ringP.end(), [&](std::int32_t v) { return touched.contains(v); })) continue;
                    if (std::any_of(ringQ.begin(), ringQ.end(), [&](std::int32_t v) { return touched.contains(v); })) continue;
                    standsFor[at(std::max(p, q))] = std::min(p, q);
                    touched.insert(ringP.begin(), ringP.end());
                    touched.insert(ringQ.begin(), ringQ.end());
                } else {
                    const auto uses = edges.uses(edges.edgeOf(f, longest));
                    const EdgeUse& other = uses[0].triangle == f ? uses[1] : uses[0];
                    Face& next = faces_[at(other.triangle)];
                    const std::int32_t d = next.v[corner(other.corner + 2)];
                    if (other.forward == (a < b)) continue;  // wound against each other: a flip would tear
                    if (touched.contains(d) || neighbours(m).contains(d)) continue;
                    if (flat(m, a, d) && flat(m, b, d)) continue;
                    const Face mine = face, theirs = next;
                    const std::int32_t rm = mine.r[corner(longest + 2)], rd = theirs.r[corner(other.corner + 2)];
                    const std::int32_t rb = theirs.r[corner(other.corner)], ra = theirs.r[corner(other.corner + 1)];
                    face.v = {a, d, m}, face.r = {ra, rd, rm};
                    next.v = {d, b, m}, next.r = {rd, rb, rm};
                    face.material = next.material, face.part = next.part;
                    touched.insert({a, b, m, d});
                    ++collapsed_;
                }
                changed = true;
            }
            if (!changed) return;
            for (Face& f : faces_)
                for (std::int32_t& v : f.v) v = standsFor[at(v)];
            std::size_t i = 0;
            collapsed_ += std::erase_if(faces_, [&](const Face&) { return remove[i++] != 0; });
            dropCollapsed();
        }
    }

    void windConsistently() {
        const EdgeTable edges(corners(faces_));
        std::vector<std::int8_t> side(faces_.size(), -1);  // 0: as in the file, 1: turned
        std::size_t turned = 0, oneSided = 0;
        std::vector<std::int32_t> piece;
        for (std::size_t seed = 0; seed < faces_.size(); ++seed) {
            if (side[seed] >= 0) continue;
            piece.assign(1, static_cast<std::int32_t>(seed));
            side[seed] = 0;
            bool orientable = true;
            std::size_t ones = 0;
            for (std::size_t next = 0; next < piece.size(); ++next) {
                const std::int32_t f = piece[next];
                ones += side[at(f)] == 1;
                for (int k = 0; k < 3; ++k) {
                    const auto uses = edges.uses(edges.edgeOf(f, k));
                    if (uses.size() != 2) continue;
                    const std::int32_t g = uses[0].triangle == f ? uses[1].triangle : uses[0].triangle;
                    const auto wanted = static_cast<std::int8_t>(uses[0].forward == uses[1].forward ? 1 - side[at(f)] : side[at(f)]);
                    if (side[at(g)] < 0) {
                        side[at(g)] = wanted;
                        piece.push_back(g);
                    } else {
                        orientable = orientable && side[at(g)] == wanted;
                    }
                }
            }
            if (!orientable) {
                ++oneSided;
                continue;
            }
            const std::int8_t minority = 2 * ones > piece.size() ? 0 : 1;
            for (const std::int32_t f : piece)
                if (side[at(f)] == minority) {
                    turn(faces_[at(f)]);
                    ++turned;
                }
        }
        if (turned > 0)
            say("mixed-winding", counted(turned, "triangle faced", "triangles faced") + " against its neighbours and was turned.", turned);
        if (turned > 1) issues_.back().text = std::to_string(turned) + " triangles faced against their neighbours and were turned.";
        if (oneSided > 0) {
            say("non-orientable", "The surface has only one side, like a Moebius strip: rebuild it in a modelling program.", oneSided);
            issues_.back().severity = Severity::Error;
            issues_.back().fixed = false;
        }
    }

    /// Whether each component is closed, manifold at its edges and vertices, and consistently wound.
    static std::vector<char> soundComponents(const Triangles& triangles, const EdgeTable& edges, const std::vector<std::int32_t>& component,
                                             int count) {
        std::vector<char> sound(at(count), 1);
        for (int e = 0; e < edges.size(); ++e) {
            const auto uses = edges.uses(e);
            if (uses.size() != 2 || uses[0].forward == uses[1].forward) sound[at(component[at(uses[0].triangle)])] = 0;
        }
        const std::vector<std::int32_t> pinched = nonManifoldVertices(triangles, edges);
        if (!pinched.empty()) {
            // Two components that only touch in a vertex pinch neither of them.
            std::vector<std::vector<std::int32_t>> own(at(count));
            for (Eigen::Index f = 0; f < triangles.rows(); ++f)
                if (std::any_of(triangles.row(f).begin(), triangles.row(f).end(),
                                [&](std::int32_t v) { return std::binary_search(pinched.begin(), pinched.end(), v); }))
                    own[at(component[static_cast<std::size_t>(f)])].push_back(static_cast<std::int32_t>(f));
            for (std::size_t c = 0; c < own.size(); ++c) {
                if (own[c].empty() || !sound[c]) continue;
                Triangles part(static_cast<Eigen::Index>(own[c].size()), 3);
                for (std::size_t i = 0; i < own[c].size(); ++i) part.row(static_cast<Eigen::Index>(i)) = triangles.row(own[c][i]);
                for (const std::int32_t v : nonManifoldVertices(part, EdgeTable(part)))
                    if (std::binary_search(pinched.begin(), pinched.end(), v)) sound[c] = 0;
            }
        }
        return sound;
    }

    void capHoles() {
        Triangles triangles = corners(faces_);
        EdgeTable edges(triangles);
        const auto loops = boundaryLoops(edges);
        if (loops.empty()) return;
        int count = 0;
        const std::vector<std::int32_t> component = edgeComponents(triangles, edges, count);
        std::vector<double> area(at(count), 0.0), capArea(at(count), 0.0);
        const auto doubleArea = [&](const std::array<std::int32_t, 3>& t) -> Vec3 {
            const Vec3 a = points_.row(t[0]);
            return (points_.row(t[1]).transpose() - a).cross(points_.row(t[2]).transpose() - a);
        };
        for (std::size_t f = 0; f < faces_.size(); ++f) area[at(component[f])] += doubleArea(faces_[f].v).norm();
        // The triangle at each open side, by the direction in which a cap runs along it.
        std::unordered_map<std::uint64_t, std::pair<std::int32_t, std::int8_t>> sideAt;
        const auto key = [](std::int32_t from, std::int32_t to) {
            return static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32 | static_cast<std::uint32_t>(to);
        };
        for (int e = 0; e < edges.size(); ++e)
            if (const auto uses = edges.uses(e); uses.size() == 1)
                sideAt[uses[0].forward ? key(uses[0].high, uses[0].low) : key(uses[0].low, uses[0].high)] = {uses[0].triangle, uses[0].corner};

        const std::size_t before = faces_.size();
        std::vector<std::int32_t> capOf;  // per added face: the component it closes
        std::vector<int> capsOf(at(count), 0);
        for (const auto& loop : loops) {
            if (loop.size() < 3) continue;
            Points polygon(static_cast<Eigen::Index>(loop.size()), 3);
            for (std::size_t i = 0; i < loop.size(); ++i) polygon.row(static_cast<Eigen::Index>(i)) = points_.row(loop[i]);
            const auto cap = triangulateHole(polygon);
            if (cap.size() != loop.size() - 2) continue;
            const auto [neighbour, firstCorner] = sideAt.at(key(loop[0], loop[1]));
            const std::int32_t c = component[at(neighbour)];
            std::vector<std::int32_t> render(loop.size());
            for (std::size_t i = 0; i < loop.size(); ++i) {
                // The side runs from loop[i+1] to loop[i] in its triangle: loop[i] is the corner after.
                const auto [f, k] = sideAt.at(key(loop[i], loop[(i + 1) % loop.size()]));
                render[i] = faces_[at(f)].r[static_cast<std::size_t>((k + 1) % 3)];
            }
            if (look_.normals.rows() > 0) render = renderCap(loop, cap, render);
            for (const auto& t : cap) {
                Face face;
                for (std::size_t k = 0; k < 3; ++k) {
                    face.v[k] = loop[at(t[k])];
                    face.r[k] = render[at(t[k])];
                }
                face.material = faces_[at(neighbour)].material;
                face.part = faces_[at(neighbour)].part;
                capArea[at(c)] += doubleArea(face.v).norm();
                faces_.push_back(face);
                capOf.push_back(c);
            }
            ++capsOf[at(c)];
        }
        if (faces_.size() == before) return;
        triangles = corners(faces_);
        edges = EdgeTable(triangles);
        int newCount = 0;
        const std::vector<std::int32_t> newComponent = edgeComponents(triangles, edges, newCount);
        const std::vector<char> sound = soundComponents(triangles, edges, newComponent, newCount);
        std::vector<char> keep(at(count), 1);
        for (std::size_t i = 0; i < capOf.size(); ++i) {
            const auto c = at(capOf[i]);
            if (!sound[at(newComponent[before + i])] || capArea[c] > kLargestCap * area[c]) keep[c] = 0;
        }
        std::size_t i = 0, holes = 0;
        std::erase_if(faces_, [&](const Face&) {
            const std::size_t f = i++;
            return f >= before && !keep[at(capOf[f - before])];
        });
        for (std::size_t c = 0; c < capsOf.size(); ++c)
            if (keep[c]) holes += at(capsOf[c]);
        if (holes > 0) say("open", counted(holes, "hole was", "holes were") + " closed with a cap.", holes);
    }

    /// Render vertices of a cap: as those on the rim, with normals of the cap.
    std::vector<std::int32_t> renderCap(const std::vector<std::int32_t>& loop, const std::vector<std::array<std::int32_t, 3>>& cap,
                                        const std::vector<std::int32_t>& rim) {
        Points normals = Points::Zero(static_cast<Eigen::Index>(loop.size()), 3);
        for (const auto& t : cap) {
            const Vec3 a = points_.row(loop[at(t[0])]), b = points_.row(loop[at(t[1])]), c = points_.row(loop[at(t[2])]);
            for (const std::int32_t k : t) normals.row(k) += (b - a).cross(c - a).transpose();
        }
        std::vector<std::int32_t> render(loop.size());
        const Eigen::Index first = look_.normals.rows();
        const auto extra = static_cast<Eigen::Index>(loop.size());
        look_.normals.conservativeResize(first + extra, 3);
        if (look_.texCoords.rows() > 0) look_.texCoords.conservativeResize(first + extra, 2);
        if (look_.colors.rows() > 0) look_.colors.conservativeResize(first + extra, 4);
        for (Eigen::Index i = 0; i < extra; ++i) {
            const double n = normals.row(i).norm();
            look_.normals.row(first + i) =
                n > 0.0 ? Eigen::RowVector3f((normals.row(i) / n).cast<float>()) : Eigen::RowVector3f(look_.normals.row(rim[static_cast<std::size_t>(i)]));
            if (look_.texCoords.rows() > 0) look_.texCoords.row(first + i) = look_.texCoords.row(rim[static_cast<std::size_t>(i)]).eval();
            if (look_.colors.rows() > 0) look_.colors.row(first + i) = look_.colors.row(rim[static_cast<std::size_t>(i)]).eval();
            render[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(first + i);
        }
        return render;
    }

    MendResult makeBodies(bool split) {
        MendResult result;
        int count = 0;
        Triangles triangles = corners(faces_);
        EdgeTable edges(triangles);
        const std::vector<std::int32_t> component = edgeComponents(triangles, edges, count);
        const std::vector<char> sound = soundComponents(triangles, edges, component, count);
        std::vector<std::int32_t> shellOf(at(count), -1), components;  // component -> shell -> component
        for (std::int32_t c = 0; c < count; ++c)
            if (sound[at(c)]) {
                shellOf[at(c)] = static_cast<std::int32_t>(components.size());
                components.push_back(c);
            }
        std::vector<std::int32_t> shellOfFace(faces_.size());
        for (std::size_t f = 0; f < faces_.size(); ++f) shellOfFace[f] = shellOf[at(component[f])];
        const Shells shells = findShells({points_, triangles}, shellOfFace, static_cast<int>(components.size()));
        std::size_t inverted = 0;
        for (const Shells::Shell& shell : shells.shells) {
            if (!shell.inverted()) continue;
            ++inverted;
            for (const std::int32_t f : shell.triangles) turn(faces_[at(f)]);
        }
        if (inverted > 0)
            say("inverted", counted(inverted, "surface that faced inside out was", "surfaces that faced inside out were") + " turned.", inverted);

        std::vector<std::int32_t> bodyOf(at(count), 0);
        int bodies = faces_.empty() ? 0 : 1;
        if (split && count > kMostBodies) {
            say("components", "The mesh has " + std::to_string(count) + " separate surfaces, too many for one element each; it was not split.",
                at(count));
            issues_.back().severity = Severity::Warning;
            issues_.back().fixed = false;
        } else if (split) {
            bodies = 0;
            for (std::int32_t c = 0; c < count; ++c) {
                const bool cavity = shellOf[at(c)] >= 0 && shells.shells[at(shellOf[at(c)])].cavity();
                bodyOf[at(c)] = cavity ? -1 : bodies++;
            }
            for (std::int32_t c = 0; c < count; ++c)
                if (bodyOf[at(c)] < 0) bodyOf[at(c)] = bodyOf[at(components[at(shells.shells[at(shellOf[at(c)])].parent)])];
        }
        std::vector<std::vector<std::int32_t>> members(at(bodies));
        for (std::size_t f = 0; f < faces_.size(); ++f) members[at(bodyOf[at(component[f])])].push_back(static_cast<std::int32_t>(f));
        for (const auto& faces : members) {
            MendedBody body;
            body.mesh = extract(faces);
            body.part = faces_[at(faces.front())].part;
            body.issues = checkMesh(body.mesh.body);
            const MeshFacts facts = meshFacts(body.mesh.body);
            body.components = facts.components;
            body.closed = facts.closed && facts.outward &&
                          std::none_of(body.issues.begin(), body.issues.end(), [](const MeshIssue& i) { return i.severity == Severity::Error; });
            result.bodies.push_back(std::move(body));
        }
        result.mended = std::move(issues_);
        return result;
    }

    /// What makes two corners one render vertex.
    struct RenderKey {
        std::int32_t body;
        std::array<std::uint32_t, 9> bits;
        bool operator==(const RenderKey&) const = default;
    };
    struct RenderKeyHash {
        std::size_t operator()(const RenderKey& k) const {
            std::uint64_t h = static_cast<std::uint64_t>(k.body) * 0x9e3779b97f4a7c15ULL;
            for (const std::uint32_t b : k.bits) h = (h ^ b) * 0xff51afd7ed558ccdULL, h ^= h >> 32;
            return h;
        }
    };

    /// The materials and textures that these faces wear, in the order of the file.
    void takeMaterials(const std::vector<std::int32_t>& faces, Look& look) const {
        if (look_.material.empty()) return;
        std::vector<std::int32_t> material(look_.materials.size(), -1), texture(look_.textures.size(), -1);
        for (const std::int32_t f : faces) material[at(faces_[at(f)].material)] = 0;
        for (std::size_t m = 0; m < material.size(); ++m) {
            if (material[m] < 0) continue;
            material[m] = static_cast<std::int32_t>(look.materials.size());
            Material& worn = look.materials.emplace_back(look_.materials[m]);
            if (worn.baseColorTexture < 0) continue;
            std::int32_t& t = texture[at(worn.baseColorTexture)];
            if (t < 0) {
                t = static_cast<std::int32_t>(look.textures.size());
                look.textures.push_back(look_.textures[at(worn.baseColorTexture)]);
            }
            worn.baseColorTexture = t;
        }
        for (const std::int32_t f : faces) look.material.push_back(material[at(faces_[at(f)].material)]);
    }

    ElementMesh extract(const std::vector<std::int32_t>& faces) const {
        ElementMesh mesh;
        std::vector<std::int32_t> number(static_cast<std::size_t>(points_.rows()), -1);
        for (const std::int32_t f : faces)
            for (const std::int32_t v : faces_[at(f)].v) number[at(v)] = 0;
        std::int32_t vertices = 0;
        for (std::int32_t& n : number)
            if (n == 0) n = vertices++;
        mesh.body.vertices.resize(vertices, 3);
        for (std::size_t v = 0; v < number.size(); ++v)
            if (number[v] >= 0) mesh.body.vertices.row(number[v]) = points_.row(static_cast<Eigen::Index>(v));
        mesh.body.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
        for (std::size_t i = 0; i < faces.size(); ++i)
            for (int k = 0; k < 3; ++k)
                mesh.body.triangles(static_cast<Eigen::Index>(i), k) = number[at(faces_[at(faces[i])].v[static_cast<std::size_t>(k)])];
        Look& look = mesh.look;
        takeMaterials(faces, look);
        if (!attributes_) {
            look.bodyVertex.resize(at(vertices));
            std::iota(look.bodyVertex.begin(), look.bodyVertex.end(), 0);
            look.triangles = mesh.body.triangles;
            return mesh;
        }
        look.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
        std::unordered_map<RenderKey, std::int32_t, RenderKeyHash> known;
        std::vector<RenderKey> keys;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            const Face& face = faces_[at(faces[i])];
            const Vec3 out = areaVector(mesh.body, static_cast<std::int32_t>(i));
            for (std::size_t k = 0; k < 3; ++k) {
                RenderKey key{number[at(face.v[k])], {}};
                const std::int32_t r = face.r[k];
                if (look_.normals.rows() > 0) {
                    Eigen::RowVector3f n = look_.normals.row(r);
                    if (face.turned && n.cast<double>().dot(out) < 0.0) n = -n;
                    for (int c = 0; c < 3; ++c) key.bits[static_cast<std::size_t>(c)] = std::bit_cast<std::uint32_t>(n[c]);
                }
                if (look_.texCoords.rows() > 0)
                    for (int c = 0; c < 2; ++c) key.bits[static_cast<std::size_t>(3 + c)] = std::bit_cast<std::uint32_t>(look_.texCoords(r, c));
                if (look_.colors.rows() > 0)
                    for (int c = 0; c < 4; ++c) key.bits[static_cast<std::size_t>(5 + c)] = std::bit_cast<std::uint32_t>(look_.colors(r, c));
                const auto [it, added] = known.emplace(key, static_cast<std::int32_t>(keys.size()));
                if (added) keys.push_back(key);
                look.triangles(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = it->second;
            }
        }
        const auto n = static_cast<Eigen::Index>(keys.size());
        look.bodyVertex.resize(keys.size());
        if (look_.normals.rows() > 0) look.normals.resize(n, 3);
        if (look_.texCoords.rows() > 0) look.texCoords.resize(n, 2);
        if (look_.colors.rows() > 0) look.colors.resize(n, 4);
        for (Eigen::Index r = 0; r < n; ++r) {
            const RenderKey& key = keys[static_cast<std::size_t>(r)];
            look.bodyVertex[static_cast<std::size_t>(r)] = key.body;
            if (look_.normals.rows() > 0)
                for (int c = 0; c < 3; ++c) look.normals(r, c) = std::bit_cast<float>(key.bits[static_cast<std::size_t>(c)]);
            if (look_.texCoords.rows() > 0)
                for (int c = 0; c < 2; ++c) look.texCoords(r, c) = std::bit_cast<float>(key.bits[static_cast<std::size_t>(3 + c)]);
            if (look_.colors.rows() > 0)
                for (int c = 0; c < 4; ++c) look.colors(r, c) = std::bit_cast<float>(key.bits[static_cast<std::size_t>(5 + c)]);
        }
        return mesh;
    }

    Points points_;
    Look look_;
    std::vector<Face> faces_;
    bool attributes_ = false;
    Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
    std::size_t collapsed_ = 0;
    std::vector<MeshIssue> issues_;
};

}  // namespace

MendResult mend(RawSurface surface, bool split) { return Mender(std::move(surface)).run(split); }

}  // namespace imomushi
