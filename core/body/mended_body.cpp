// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/mended_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/base/index.h"
#include "core/base/union_find.h"
#include "core/body/cgal/rays.h"
#include "core/body/cgal/unite.h"
#include "core/body/cgal/untangle.h"
#include "core/body/flesh_links.h"
#include "core/mesh/bounds.h"
#include "core/mesh/shells.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/weld.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

/// A part that stands out less than this from the others, over the size of all, follows them where it is small or open.
constexpr double kStandsOut = 0.04;
/// Volume of a small part over that of all.
constexpr double kSmall = 0.02;
/// Volume of parts that touch no other over that of the largest, below which they are carried.
constexpr double kApart = 0.1;
/// Radii of tubes between parts that do not touch, over those of the discs in which they face each other: one after the other is tried.
constexpr double kLinkRadii[] = {0.6, 0.3, 0.15};
/// By so much a part is swollen that lies on another: one after the other is tried.
constexpr double kSwollen[] = {1e-4, 1e-3};
/// Open parts of less area than this, over that of all, are left out wherever they are: whiskers, feathers.
constexpr double kLittleArea = 0.01;

/// About the largest distance between two points: the same, but for rounding, however they are turned.
double extentOf(const Points& points) {
    double size = 0.0;
    Vec3 from = points.colwise().mean();
    for (int round = 0; round < 4; ++round) {
        Eigen::Index farthest = 0;
        const double far = std::sqrt((points.rowwise() - from.transpose()).rowwise().squaredNorm().maxCoeff(&farthest));
        if (round > 0) size = std::max(size, far);
        from = points.row(farthest).transpose();
    }
    return size;
}

/// Of some triangles, ascending.
std::vector<std::int32_t> verticesOf(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles) {
    std::vector<std::int32_t> vertices;
    for (const std::int32_t f : triangles)
        for (int k = 0; k < 3; ++k) vertices.push_back(mesh.triangles(f, k));
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

/// Some triangles with vertices of their own, in order. `turn`: facing the other way.
TriangleMesh taken(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles, bool turn) {
    const std::vector<std::int32_t> vertices = verticesOf(mesh, triangles);
    TriangleMesh out;
    out.vertices = mesh.vertices(vertices, Eigen::all);
    out.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const int to = turn ? (3 - k) % 3 : k;
            out.triangles(static_cast<Eigen::Index>(i), to) =
                static_cast<std::int32_t>(std::lower_bound(vertices.begin(), vertices.end(), mesh.triangles(triangles[i], k)) - vertices.begin());
        }
    return out;
}

void append(TriangleMesh& to, const TriangleMesh& more) {
    const Eigen::Index v = to.vertices.rows(), f = to.triangles.rows();
    to.vertices.conservativeResize(v + more.vertices.rows(), 3);
    to.vertices.bottomRows(more.vertices.rows()) = more.vertices;
    to.triangles.conservativeResize(f + more.triangles.rows(), 3);
    to.triangles.bottomRows(more.triangles.rows()) = (more.triangles.array() + static_cast<std::int32_t>(v)).matrix();
}

/// How far vertices stand out of a closed surface.
class Standing {
public:
    Standing(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles) : near_(mesh, triangles), rays_(mesh, triangles) {}
    double of(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles, double enough) const {
        double most = 0.0;
        for (const std::int32_t v : verticesOf(mesh, triangles)) {
            const Vec3 p = mesh.vertices.row(v);
            const double distance = std::sqrt(near_.nearest(p).squaredDistance);
            if (distance <= enough || rays_.inside(p)) continue;
            most = std::max(most, distance);
        }
        return most;
    }

private:
    TriangleTree near_;
    RayTree rays_;
};

MeshIssue note(Severity severity, const char* code, std::string text, std::size_t count) {
    return {severity, code, std::move(text), static_cast<int>(count), severity == Severity::Info, {}, {}};
}

enum class Role { Body, Cavity, Inside, Small };

struct Sorted {
    Shells shells;
    std::vector<Role> role;                             ///< of the shells
    std::vector<std::vector<std::int32_t>> openPieces;  ///< triangles of pieces that enclose nothing
    double area = 0.0;
};

double areaOf(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles) {
    double twice = 0.0;
    for (const std::int32_t f : triangles) twice += areaVector(mesh, f).norm();
    return 0.5 * twice;
}

Sorted sortSurfaces(const TriangleMesh& mesh) {
    Sorted sorted;
    const EdgeTable edges(mesh.triangles);
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(mesh.triangles, edges, count);
    const std::vector<char> sound = soundComponents(mesh.triangles, edges, component, count);
    std::vector<std::int32_t> shellOf(at(count), -1);
    int shells = 0;
    for (std::size_t c = 0; c < sound.size(); ++c)
        if (sound[c]) shellOf[c] = shells++;
    std::vector<std::int32_t> shellOfFace(component.size());
    std::vector<std::vector<std::int32_t>> pieces(at(count));
    for (std::size_t f = 0; f < component.size(); ++f) {
        shellOfFace[f] = shellOf[at(component[f])];
        if (shellOfFace[f] < 0) pieces[at(component[f])].push_back(static_cast<std::int32_t>(f));
    }
    for (auto& piece : pieces)
        if (!piece.empty()) sorted.openPieces.push_back(std::move(piece));
    sorted.area = surfaceArea(mesh);
    sorted.shells = findShells(mesh, shellOfFace, shells);
    for (const Shells::Shell& shell : sorted.shells.shells)  // a sheet with two faces is closed and encloses nothing
        if (shell.volume == 0.0) sorted.openPieces.push_back(shell.triangles);
    for (const Shells::Shell& shell : sorted.shells.shells) {
        Role role = Role::Body;
        if (shell.depth > 0) {
            const bool opposite = (shell.volume < 0.0) != (sorted.shells.shells[at(shell.parent)].volume < 0.0);
            role = shell.depth == 1 && opposite ? Role::Cavity : Role::Inside;
        }
        if (shell.volume == 0.0) role = Role::Inside;
        sorted.role.push_back(role);
    }
    return sorted;
}

/// A part that the others carry, with its cavities.
void leaveOut(Sorted& sorted, std::size_t shell) {
    sorted.role[shell] = Role::Small;
    for (std::size_t i = 0; i < sorted.role.size(); ++i)
        if (sorted.role[i] == Role::Cavity && at(sorted.shells.shells[i].parent) == shell) sorted.role[i] = Role::Inside;
}

/// Small closed parts on others, per shell.
std::vector<char> findSmall(const TriangleMesh& mesh, double size, const Sorted& sorted) {
    double volume = 0.0;
    for (std::size_t i = 0; i < sorted.role.size(); ++i)
        if (sorted.role[i] == Role::Body) volume += std::abs(sorted.shells.shells[i].volume);
    std::vector<std::int32_t> large;
    std::vector<std::size_t> small;
    std::vector<char> found(sorted.role.size(), 0);
    for (std::size_t i = 0; i < sorted.role.size(); ++i) {
        const Shells::Shell& shell = sorted.shells.shells[i];
        if (sorted.role[i] != Role::Body) continue;
        if (std::abs(shell.volume) < kSmall * volume)
            small.push_back(i);
        else
            large.insert(large.end(), shell.triangles.begin(), shell.triangles.end());
    }
    if (small.empty() || large.empty()) return found;
    const Standing standing(mesh, large);
    for (const std::size_t i : small) found[i] = standing.of(mesh, sorted.shells.shells[i].triangles, kStandsOut * size) <= kStandsOut * size;
    return found;
}

/// Whether what encloses nothing may be left out.
bool openPiecesFollow(const TriangleMesh& mesh, double size, const Sorted& sorted, const std::vector<std::int32_t>& body) {
    const Standing standing(mesh, body);
    double little = 0.0;
    return std::all_of(sorted.openPieces.begin(), sorted.openPieces.end(), [&](const std::vector<std::int32_t>& piece) {
        if (standing.of(mesh, piece, kStandsOut * size) <= kStandsOut * size) return true;
        little += areaOf(mesh, piece);
        return little <= kLittleArea * sorted.area;
    });
}

/// Pairs of parts that touch each other: as many as hang them together, those of the largest parts, so that a small one between two that touch anyway hangs on one of them.
std::vector<std::pair<std::int32_t, std::int32_t>> touchingParts(const std::vector<FleshPart>& parts, const Progress& progress) {
    std::vector<Bounds> box;
    for (const FleshPart& part : parts) box.push_back(boundsOf(part.mesh.vertices));
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs, touching;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (std::size_t j = i + 1; j < parts.size(); ++j)
            if ((box[i].low.array() <= box[j].high.array()).all() && (box[j].low.array() <= box[i].high.array()).all()) pairs.emplace_back(i, j);
    const auto smaller = [&](const std::pair<std::int32_t, std::int32_t>& pair) { return std::min(parts[at(pair.first)].volume, parts[at(pair.second)].volume); };
    std::stable_sort(pairs.begin(), pairs.end(), [&](const auto& x, const auto& y) { return smaller(x) > smaller(y); });
    UnionFind groups(parts.size());
    for (const auto& [i, j] : pairs) {
        if (progress.cancelled()) break;
        if (groups.find(i) == groups.find(j) || !surfacesMeet(parts[at(i)].mesh, parts[at(j)].mesh)) continue;
        groups.unite(i, j);
        touching.emplace_back(i, j);
    }
    return touching;
}

/// Whether an edge has more than two triangles.
bool crowded(const EdgeTable& edges) {
    for (int e = 0; e < edges.size(); ++e)
        if (edges.uses(e).size() > 2) return true;
    return false;
}

/// The union of two parts, closed, with edges and vertices of its own for each side, and hanging together.
std::optional<TriangleMesh> wholeUnion(const TriangleMesh& a, const TriangleMesh& b) {
    auto both = unite(a, b);
    if (!both) return std::nullopt;
    *both = separated(std::move(*both));
    const MeshFacts facts = meshFacts(*both);
    return facts.closed && facts.components < meshFacts(a).components + meshFacts(b).components ? both : std::nullopt;
}

/// A part a little larger, and turned less still, so that none of its edges lies on another's.
TriangleMesh swollen(TriangleMesh mesh, double by) {
    const Bounds box = boundsOf(mesh.vertices);
    const Vec3 middle = 0.5 * (box.low + box.high);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3 * by, Vec3(0.48, 0.6, 0.64)).toRotationMatrix();
    mesh.vertices = ((mesh.vertices.rowwise() - middle.transpose()) * ((1.0 + by) * turn.transpose())).rowwise() + middle.transpose();
    return mesh;
}

/// The union of two parts. Walls that lie on each other but for rounding have none: then one of the parts is swollen. Parts that cross themselves are untangled.
std::optional<TriangleMesh> unitedSomehow(const TriangleMesh& a, const TriangleMesh& b) {
    {
        const Attempt uniting("a union of two parts");
        if (uniting)
            if (auto both = wholeUnion(a, b)) return both;
    }
    for (const double by : kSwollen) {
        const Attempt swelling("a union of two parts that lie on each other");
        if (swelling)
            if (auto both = wholeUnion(a, swollen(b, by))) return both;
    }
    const Attempt untangling("a union of two parts without their crossings with themselves");
    if (!untangling) return std::nullopt;
    const auto cleanA = untangled(a), cleanB = untangled(b);
    return cleanA && cleanB ? wholeUnion(*cleanA, *cleanB) : std::nullopt;
}

/// Bodies that touch each other as one. Each joins after one that it touches: whether it meets what the others have become need not be asked, which takes long for many parts.
/// Empty where CGAL cannot, or when cancelled.
std::optional<TriangleMesh> united(const std::vector<TriangleMesh>& bodies, std::size_t& unions, const Progress& progress) {
    enum class Meeting : char { Unknown, Yes, No };
    const std::size_t count = bodies.size();
    std::vector<Bounds> box;
    for (const TriangleMesh& b : bodies) box.push_back(boundsOf(b.vertices));
    std::vector<Meeting> known(count * count, Meeting::Unknown);
    const auto meet = [&](std::size_t a, std::size_t b) {
        Meeting& meeting = known[a * count + b];
        if (meeting == Meeting::Unknown) {
            const bool apart = (box[a].low.array() > box[b].high.array()).any() || (box[b].low.array() > box[a].high.array()).any();
            meeting = known[b * count + a] = !apart && surfacesMeet(bodies[a], bodies[b]) ? Meeting::Yes : Meeting::No;
        }
        return meeting == Meeting::Yes;
    };
    TriangleMesh whole = bodies.front();
    std::vector<std::size_t> joined{0}, left;
    for (std::size_t b = 1; b < count; ++b) left.push_back(b);
    while (!left.empty()) {
        if (progress.cancelled()) return std::nullopt;
        const auto next = std::find_if(left.begin(), left.end(), [&](std::size_t b) { return std::any_of(joined.begin(), joined.end(), [&](std::size_t a) { return meet(a, b); }); });
        if (next == left.end()) break;
        std::optional<TriangleMesh> both = unitedSomehow(whole, bodies[*next]);
        if (!both) return std::nullopt;
        whole = std::move(*both);
        joined.push_back(*next);
        left.erase(next);
        ++unions;
    }
    return whole;
}

int eulerNumber(const TriangleMesh& mesh) {
    const EdgeTable edges(mesh.triangles);
    return static_cast<int>(mesh.vertices.rows()) - edges.size() + static_cast<int>(mesh.triangles.rows());
}

/// Two pieces of flesh that do not touch as one, by a tube between two parts of theirs, `asked` or such as fits. None where no tube joins them and does nothing else.
std::optional<LinkTube> joinedByLink(const TriangleMesh& a, const TriangleMesh& b, const TriangleMesh& partA, const TriangleMesh& partB, const FleshLink* asked) {
    for (const double radius : std::span(kLinkRadii).first(asked ? 1 : std::size(kLinkRadii))) {
        auto tube = asked ? linkTube(partA, partB, *asked) : linkTube(partA, partB, radius);
        if (!tube) return std::nullopt;
        const Attempt uniting("a link between two parts");
        if (!uniting) continue;
        const auto half = unite(a, tube->mesh);
        const auto whole = half ? unite(*half, b) : std::nullopt;
        if (!whole) continue;
        // Each end of a tube opens one surface once.
        const MeshFacts facts = meshFacts(*whole);
        if (!facts.closed || eulerNumber(*whole) != eulerNumber(a) + eulerNumber(b) - 2) continue;
        tube->link.volume = facts.volume - meshFacts(a).volume - meshFacts(b).volume;
        tube->mesh = std::move(*whole);
        return tube;
    }
    return std::nullopt;
}

/// The parts nearest to the ends of links.
std::vector<std::pair<std::int32_t, std::int32_t>> endsOf(const std::vector<FleshLink>& links, const std::vector<FleshPart>& parts) {
    std::vector<TriangleTree> trees;
    for (const FleshPart& part : parts) trees.emplace_back(part.mesh);
    const auto nearest = [&](const Vec3& place) {
        std::vector<double> distance;
        for (const TriangleTree& tree : trees) distance.push_back(tree.nearest(place).squaredDistance);
        return static_cast<std::int32_t>(std::min_element(distance.begin(), distance.end()) - distance.begin());
    };
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (const FleshLink& link : links) pairs.emplace_back(nearest(link.from), nearest(link.to));
    return pairs;
}

/// Triangles of a union that are flatter than this lie between walls that were modelled in one place and differ by rounding: much flatter than any that were modelled.
constexpr double kUnionFlat = 1e-5;

}  // namespace

TriangleMesh tidied(const TriangleMesh& mesh) {
    RawSurface raw;
    raw.mesh.body = mesh;
    MendSurface s(std::move(raw));
    dropUnused(s);
    mendDegenerate(s, kUnionFlat);
    const TriangleMesh all{s.points, s.triangles()};
    const EdgeTable edges(all.triangles);
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(all.triangles, edges, count);
    const Shells shells = findShells(all, component, count);
    std::vector<std::int32_t> kept;
    for (const Shells::Shell& shell : shells.shells)
        if (shell.volume > 0.0) kept.insert(kept.end(), shell.triangles.begin(), shell.triangles.end());
    std::sort(kept.begin(), kept.end());
    return taken(all, kept, false);
}

TriangleMesh separated(TriangleMesh mesh) {
    if (const EdgeTable edges(mesh.triangles); nonManifoldVertices(mesh.triangles, edges).empty() && !crowded(edges)) return mesh;
    RawSurface raw;
    raw.mesh.body = std::move(mesh);
    MendSurface s(std::move(raw));
    separateNonManifold(s);
    std::vector<std::int32_t> all(s.faces.size());
    std::iota(all.begin(), all.end(), 0);
    return taken({s.points, s.triangles()}, all, false);  // without vertices that are no longer used
}

Result<MendedSurface> mendedBody(const PreparedSurface& surface, const BodyBones& bones, const std::optional<std::vector<FleshLink>>& links, bool carry, const Progress& progress) {
    const TriangleMesh& mesh = surface.mesh;
    const double size = extentOf(mesh.vertices);
    Sorted sorted = sortSurfaces(mesh);
    const auto notMendable = [](const char* what) {
        return fail("not-mendable", std::string("The mesh cannot be closed as it is: ") + what + "; choose a wrapped body, or close it in a modelling program.");
    };
    std::vector<FleshPart> parts;
    std::vector<std::size_t> shellOf;  // of the parts
    {
        const std::vector<char> small = findSmall(mesh, size, sorted);
        for (std::size_t i = 0; i < sorted.role.size(); ++i) {
            if (sorted.role[i] != Role::Body) continue;
            const Shells::Shell& shell = sorted.shells.shells[i];
            FleshPart part{taken(mesh, shell.triangles, shell.volume < 0.0), {}, std::abs(shell.volume), small[i] != 0};
            if (!bones.bone.empty())
                for (const std::int32_t v : verticesOf(mesh, shell.triangles)) part.bone.push_back(bones.bone[at(v)]);
            parts.push_back(std::move(part));
            shellOf.push_back(i);
        }
    }
    if (parts.empty()) return notMendable("no part of it encloses a volume");
    const std::vector<std::pair<std::int32_t, std::int32_t>> touching = touchingParts(parts, progress);
    std::vector<std::int32_t> together(parts.size());  // of the parts that touch, directly or by others
    {
        UnionFind sets(parts.size());
        for (const auto& [a, b] : touching) sets.unite(a, b);
        for (std::size_t p = 0; p < parts.size(); ++p) together[p] = sets.find(static_cast<std::int32_t>(p));
    }
    Linking linking = planLinks(parts, touching, bones.parent, size, carry, progress);
    if (links) linking.pairs = endsOf(*links, parts);
    for (const auto& [a, b] : linking.pairs) linking.attached[at(a)] = linking.attached[at(b)] = 0;
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    std::vector<std::int32_t> body;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Shells::Shell& shell = sorted.shells.shells[shellOf[p]];
        if (linking.attached[p] != 0)
            leaveOut(sorted, shellOf[p]);
        else
            body.insert(body.end(), shell.triangles.begin(), shell.triangles.end());
    }
    std::sort(body.begin(), body.end());
    if (!sorted.openPieces.empty() && !openPiecesFollow(mesh, size, sorted, body)) return notMendable("open parts of it stand out from the others");

    MendedSurface out;
    std::map<std::int32_t, std::vector<std::size_t>> groups;  // parts that touch
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (linking.attached[p] == 0) groups[together[p]].push_back(p);
    std::map<std::int32_t, TriangleMesh> pieces;  // of the lowest group in each
    std::size_t unions = 0;
    for (const auto& [first, group] : groups) {
        std::vector<TriangleMesh> members;
        for (const std::size_t p : group) members.push_back(parts[p].mesh);
        std::optional<TriangleMesh> one = united(members, unions, progress);
        if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
        if (!one) return notMendable("parts of it cross each other in a way that leaves no clear surface");
        pieces.emplace(first, std::move(*one));
    }
    UnionFind linked(parts.size());  // groups
    std::size_t refused = 0;  // of those that were asked for
    for (std::size_t l = 0; l < linking.pairs.size(); ++l) {
        if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
        const auto [a, b] = linking.pairs[l];
        const std::int32_t one = linked.find(together[at(a)]), other = linked.find(together[at(b)]);
        std::optional<LinkTube> link;
        if (one != other) link = joinedByLink(pieces.at(one), pieces.at(other), parts[at(a)].mesh, parts[at(b)].mesh, links ? &(*links)[l] : nullptr);
        refused += links && !link;
        if (!link) continue;
        linked.unite(one, other);
        pieces.erase(std::max(one, other));
        pieces.at(std::min(one, other)) = std::move(link->mesh);
        out.links.push_back(link->link);
    }
    // What no tube reaches is carried, unless it is large.
    std::map<std::int32_t, double> flesh;
    double largest = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (linking.attached[p] == 0) largest = std::max(largest, flesh[linked.find(together[p])] += parts[p].volume);
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (linking.attached[p] == 0 && flesh[linked.find(together[p])] < kApart * largest) leaveOut(sorted, shellOf[p]);
    std::erase_if(pieces, [&](const auto& piece) { return flesh[linked.find(piece.first)] < kApart * largest; });
    std::size_t turned = 0, inside = 0, small = 0;
    for (std::size_t i = 0; i < sorted.role.size(); ++i) {
        const double volume = sorted.shells.shells[i].volume;
        inside += sorted.role[i] == Role::Inside && volume != 0.0;
        small += sorted.role[i] == Role::Small;
        if (sorted.role[i] == Role::Small) out.volumeLeftOut += std::abs(volume);
        turned += sorted.role[i] == Role::Body && volume < 0.0;
    }

    out.whole = unions + out.links.size() + inside + small + sorted.openPieces.size() == 0;
    if (unions + out.links.size() == 0) {  // triangles and vertices in their order
        TriangleMesh turnedMesh = mesh;
        std::vector<std::int32_t> kept;
        for (std::size_t i = 0; i < sorted.role.size(); ++i) {
            if (sorted.role[i] != Role::Body && sorted.role[i] != Role::Cavity) continue;
            const Shells::Shell& shell = sorted.shells.shells[i];
            kept.insert(kept.end(), shell.triangles.begin(), shell.triangles.end());
            if (shell.inverted())
                for (const std::int32_t f : shell.triangles) std::swap(turnedMesh.triangles(f, 1), turnedMesh.triangles(f, 2));
        }
        std::sort(kept.begin(), kept.end());
        const std::vector<std::int32_t> vertices = verticesOf(mesh, kept);
        out.vertexOf.assign(static_cast<std::size_t>(mesh.vertices.rows()), -1);
        for (std::size_t i = 0; i < vertices.size(); ++i) out.vertexOf[at(vertices[i])] = static_cast<std::int32_t>(i);
        out.mesh = taken(turnedMesh, kept, false);
    } else {
        for (const auto& [first, piece] : pieces) append(out.mesh, piece);
        out.mesh = tidied(out.mesh);
        for (std::size_t i = 0; i < sorted.role.size(); ++i)
            if (sorted.role[i] == Role::Cavity) append(out.mesh, taken(mesh, sorted.shells.shells[i].triangles, sorted.shells.shells[i].inverted()));
        out.vertexOf = samePlaces(mesh.vertices, out.mesh.vertices);  // a union keeps the coordinates of the vertices that stay
    }
    if (turned > 0) out.issues.push_back(note(Severity::Info, "inverted", counted(turned, "surface that faced inside out was", "surfaces that faced inside out were") + " turned.", turned));
    if (unions > 0) out.issues.push_back(note(Severity::Info, "united", counted(unions + 1, "part that overlaps another was", "parts that overlap were") + " united.", unions + 1));
    if (inside > 0) out.issues.push_back(note(Severity::Info, "inside", counted(inside, "part inside of another was", "parts inside of others were") + " left out; the flesh around carries them.", inside));
    if (!out.links.empty())
        out.issues.push_back(note(Severity::Info, "linked", counted(out.links.size(), "link of flesh was", "links of flesh were") + " made between parts that do not touch.", out.links.size()));
    if (refused > 0)
        out.issues.push_back(note(Severity::Warning, "link-refused", counted(refused, "link of flesh that was asked for was", "links of flesh that were asked for were") + " not made: the two parts must face each other all around it, and touch nowhere else; make it thinner, or leave it out.", refused));
    if (small > 0) out.issues.push_back(note(Severity::Info, "attached", counted(small, "part without a motion of its own was", "parts without a motion of their own were") + " left out of the flesh; the body carries them.", small));
    if (pieces.size() > 1)
        out.issues.push_back(note(Severity::Warning, "components", "The body consists of " + std::to_string(pieces.size()) + " parts that touch nowhere: give each a bone, or import them as separate elements.", pieces.size()));
    if (!sorted.openPieces.empty())
        out.issues.push_back(note(Severity::Info, "open-part", counted(sorted.openPieces.size(), "open part was", "open parts were") + " left out; the body carries them.",
                                  sorted.openPieces.size()));
    return out;
}

}  // namespace imomushi
