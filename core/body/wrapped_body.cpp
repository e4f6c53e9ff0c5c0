// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/wrapped_body.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/union_find.h"
#include "core/body/cgal/decimate.h"
#include "core/body/cgal/wrap.h"
#include "core/body/surface_study.h"
#include "core/mesh/bounds.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/topology.h"
#include "core/mesh/winding_tree.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

// Lengths in diagonals.
constexpr int kAreaSamples = 6000;           ///< a patch of a 75th of the size of a body has one
constexpr double kCoarsest = 1.0 / 80.0;   ///< alpha where nothing asks for less
constexpr double kFinest = kFinestDetail;    ///< alpha in gaps: seconds
constexpr double kFinestSoup = 1.0 / 500.0;  ///< the same where no winding number tells the inside from the outside
constexpr double kFinestLimb = 1.0 / 300.0;  ///< alpha on thin limbs and fins
constexpr double kFinestCrease = 1.0 / 200.0; ///< alpha in creases, which it rounds
constexpr double kGapPart = 0.35;        ///< of a gap: the ball of alpha and what its facets lack of it roll in, and touch both walls at .5
constexpr double kLimbPart = 0.15;       ///< of a thickness: a round limb gets some twenty sides
constexpr double kGrowth = 0.3;          ///< of alpha with the distance: neighbouring triangles differ by a third
constexpr double kMatters = 2e-3;        ///< area of gaps over the whole below which they are noise
constexpr double kOffset = 0.2;         ///< of the finest alpha
constexpr double kDensity = 1.2;         ///< vertices of a wrap per area over alpha squared, measured
constexpr double kMostVertices = 30000;  ///< of a wrap that is chosen by itself: some five seconds
constexpr std::size_t kMostAsked = 400000;  ///< of one that was asked for
constexpr std::size_t kBodyVertices = 8000;
constexpr double kReach = 0.25;          ///< of rays
constexpr std::size_t kDeep = 200;       ///< places in the flesh that must be inside of the wrap
constexpr double kHollow = 0.05;         ///< of them may be outside
constexpr double kBeside = 1e-4;         ///< of a surface
constexpr double kOutside = 0.25;        ///< the winding number, either way, below which a place is outside: in the middle of a hole it is .5
constexpr double kIsland = 1e-3;          ///< volume over that of the largest surface of a wrap, below which one is dropped
constexpr double kNear = 0.05;           ///< closed gaps that near are one place
constexpr std::size_t kPlaces = 16;
constexpr std::size_t kCrossings = 1000;

SizeField sizesFor(const std::vector<SurfaceSample>& samples, double spacing, double finest, double coarsest) {
    std::size_t gaps = 0;
    for (const SurfaceSample& s : samples) gaps += kGapPart * s.width < coarsest;
    const bool gapsMatter = static_cast<double>(gaps) > kMatters * static_cast<double>(samples.size());
    std::vector<SizeField::Source> sources;
    for (const SurfaceSample& s : samples) {
        double size = std::max(kLimbPart * s.thickness, std::max(finest, kFinestLimb));
        size = std::min(size, std::max(kGapPart * s.crease, std::max(finest, kFinestCrease)));
        if (size < coarsest) sources.push_back({s.point, size});
        const double inGap = kGapPart * s.width;
        if (gapsMatter && inGap < coarsest && inGap >= finest)  // what the finest does not fit into is closed anyway
            sources.push_back({s.point + 0.5 * s.gap * s.across, inGap});
    }
    return SizeField(std::move(sources), coarsest, kGrowth, spacing);
}

double expectedVertices(const SizeField& sizes, const std::vector<SurfaceSample>& samples, double area) {
    double n = 0.0;
    for (const SurfaceSample& s : samples) {
        const double alpha = sizes.at(s.point);
        n += kDensity * area / static_cast<double>(samples.size()) / (alpha * alpha);
    }
    return n;
}

/// Places that clearly are inside of flesh.
std::vector<Vec3> deepPlaces(const WindingTree& winding, const std::vector<SurfaceSample>& samples, const Progress& progress) {
    std::vector<Vec3> places;
    const std::size_t step = samples.size() / kDeep + 1;
    for (std::size_t i = 0; i < samples.size() && !progress.cancelled(); i += step) {
        const Vec3 p = samples[i].point - std::min(0.5 * samples[i].thickness, 0.02) * samples[i].normal;
        if (winding.at(p) > 0.7) places.push_back(p);
    }
    if (10 * places.size() < samples.size() / step) places.clear();  // sheets: what lies between them is by chance
    return places;
}

/// Without those of parts that lie in the flesh of others: a wrap does not come near them, and what they see is no gap.
std::vector<SurfaceSample> outerOf(const std::vector<SurfaceSample>& samples, const WindingTree& winding) {
    std::vector<SurfaceSample> outer;
    const auto in = [&](const Vec3& p) { return std::abs(winding.at(p)) > 0.5; };
    for (const SurfaceSample& s : samples)
        if (!in(s.point + kBeside * s.normal) || !in(s.point - kBeside * s.normal)) outer.push_back(s);
    return outer;
}

/// Without the islands that stay in gaps where the ball went around them.
TriangleMesh withoutIslands(const TriangleMesh& wrap) {
    const EdgeTable edges(wrap.triangles);
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(wrap.triangles, edges, count);
    if (count == 1) return wrap;
    std::vector<double> volume(static_cast<std::size_t>(count), 0.0);
    for (std::int32_t f = 0; f < wrap.triangles.rows(); ++f)
        volume[static_cast<std::size_t>(component[static_cast<std::size_t>(f)])] += areaVector(wrap, f).dot(wrap.vertices.row(wrap.triangles(f, 0))) / 6.0;
    const double least = kIsland * *std::max_element(volume.begin(), volume.end());
    TriangleMesh out;
    std::vector<std::int32_t> number(static_cast<std::size_t>(wrap.vertices.rows()), -1), vertices;
    out.triangles.resize(wrap.triangles.rows(), 3);
    Eigen::Index faces = 0;
    for (std::int32_t f = 0; f < wrap.triangles.rows(); ++f) {
        if (volume[static_cast<std::size_t>(component[static_cast<std::size_t>(f)])] < least) continue;
        for (int k = 0; k < 3; ++k) {
            std::int32_t& n = number[static_cast<std::size_t>(wrap.triangles(f, k))];
            if (n < 0) {
                n = static_cast<std::int32_t>(vertices.size());
                vertices.push_back(wrap.triangles(f, k));
            }
            out.triangles(faces, k) = n;
        }
        ++faces;
    }
    out.triangles.conservativeResize(faces, 3);
    out.vertices = wrap.vertices(vertices, Eigen::all);
    return out;
}

bool hasHoles(const TriangleMesh& mesh) {
    const EdgeTable edges(mesh.triangles);
    for (int e = 0; e < edges.size(); ++e)
        if (edges.uses(e).size() == 1) return true;
    return false;
}

bool hollow(const TriangleMesh& wrap, const std::vector<Vec3>& deep) {
    const RayTree rays(wrap);
    const auto outside = static_cast<double>(std::count_if(deep.begin(), deep.end(), [&](const Vec3& p) { return !rays.inside(p); }));
    return outside > kHollow * static_cast<double>(deep.size());
}

/// Coarser where that crosses nothing.
TriangleMesh coarsened(const TriangleMesh& wrap, const Progress& progress) {
    for (std::size_t vertices = kBodyVertices; vertices < static_cast<std::size_t>(wrap.vertices.rows()); vertices *= 2) {
        TriangleMesh coarse = collapseEdges(wrap, vertices, progress);
        if (progress.cancelled()) return wrap;
        if (selfIntersections(coarse, 1, progress).empty()) return coarse;
    }
    return wrap;
}

/// Moves the vertices inward by the offset, or by what gives the volume, but never far into thin flesh and never across another wall.
TriangleMesh takenBack(const TriangleMesh& wrap, double offset, double volume) {
    const Points normals = vertexNormals(wrap);
    Eigen::VectorXd reach(wrap.vertices.rows());  // how far a vertex may go
    {
        const RayTree rays(wrap);
        for (Eigen::Index v = 0; v < reach.size(); ++v) {
            const Vec3 n = normals.row(v);
            const Vec3 from = wrap.vertices.row(v).transpose() - 0.1 * offset * n;
            reach[v] = n.isZero() ? 0.0 : std::min(4.0 * offset, 0.25 * rays.first(from, -n, 16.0 * offset, -1).distance);
        }
    }
    const auto moved = [&](double by) {
        TriangleMesh mesh = wrap;
        for (Eigen::Index v = 0; v < reach.size(); ++v) mesh.vertices.row(v) -= std::min(by, reach[v]) * normals.row(v);
        return mesh;
    };
    double by = offset;
    if (volume > 0.0) {
        double low = -4.0 * offset, high = 4.0 * offset;  // the volume falls with the distance
        for (int i = 0; i < 30; ++i) {
            by = (low + high) / 2;
            (enclosedVolume(moved(by).vertices, wrap.triangles) > volume ? low : high) = by;
        }
    }
    for (int round = 0; round < 8; ++round) {
        TriangleMesh mesh = moved(by);
        const auto crossing = selfIntersections(mesh, kCrossings);
        if (crossing.empty() && enclosedVolume(mesh.vertices, mesh.triangles) > 0.0) return mesh;
        for (const auto& [f, g] : crossing)
            for (int k = 0; k < 3; ++k) reach[mesh.triangles(f, k)] = reach[mesh.triangles(g, k)] = by < 0.0 ? by : 0.0;
        if (by < 0.0) by /= 2;  // outward: all of them less
    }
    return wrap;
}

ClosedGaps closedGaps(const TriangleMesh& body, const std::vector<SurfaceSample>& samples) {
    const RayTree rays(body);
    std::vector<const SurfaceSample*> closed;
    for (const SurfaceSample& s : samples)
        if (std::isfinite(s.gap) && rays.inside(s.point + 0.5 * s.gap * s.across)) closed.push_back(&s);
    ClosedGaps gaps;
    gaps.area = samples.empty() ? 0.0 : static_cast<double>(closed.size()) / static_cast<double>(samples.size());
    if (closed.empty()) return gaps;
    const auto [narrowest, widest] = std::minmax_element(closed.begin(), closed.end(), [](const auto* a, const auto* b) { return a->gap < b->gap; });
    gaps.narrowest = (*narrowest)->gap, gaps.widest = (*widest)->gap;
    UnionFind groups(closed.size());
    for (std::size_t i = 0; i < closed.size(); ++i)
        for (std::size_t j = i + 1; j < closed.size(); ++j)
            if ((closed[i]->point - closed[j]->point).squaredNorm() < kNear * kNear) groups.unite(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    std::map<std::int32_t, std::vector<std::size_t>> members;
    for (std::size_t i = 0; i < closed.size(); ++i) members[groups.find(static_cast<std::int32_t>(i))].push_back(i);
    std::vector<std::vector<std::size_t>> largest;
    for (auto& [first, group] : members) largest.push_back(std::move(group));
    std::stable_sort(largest.begin(), largest.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    if (largest.size() > kPlaces) largest.resize(kPlaces);
    for (const auto& group : largest) {  // the widest place of each
        const SurfaceSample& s = *closed[*std::max_element(group.begin(), group.end(), [&](std::size_t a, std::size_t b) { return closed[a]->gap < closed[b]->gap; })];
        gaps.places.push_back(s.point + 0.5 * s.gap * s.across);
    }
    return gaps;
}

}  // namespace

Result<WrappedSurface> wrappedBody(const TriangleMesh& mesh, double detail, double volume, const Progress& progress) {
    const Bounds box = boundsOf(mesh.vertices);
    const double diagonal = box.diagonal();
    const Vec3 middle = box.low + box.size() / 2;
    if (!(diagonal > 0.0)) return fail("no-volume", "The mesh has no extent: choose another file.");
    TriangleMesh unit = mesh;
    unit.vertices = (mesh.vertices.rowwise() - middle.transpose()) / diagonal;
    progress.report("gaps", 0.0);
    const RayTree rays(unit);
    std::vector<SurfaceSample> samples = studySurface(unit, rays, kAreaSamples, kReach, progress);
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    if (samples.empty()) return fail("no-volume", "The mesh has no area: choose another file.");
    const WindingTree winding(unit);
    const std::vector<Vec3> deep = deepPlaces(winding, samples, progress);
    const auto all = static_cast<double>(samples.size());
    samples = outerOf(samples, winding);
    const double area = surfaceArea(unit) * static_cast<double>(samples.size()) / all;
    if (samples.empty()) return fail("no-volume", "The mesh encloses no volume: give it thickness or close it in a modelling program.");

    const double spacing = std::sqrt(area / static_cast<double>(samples.size()));
    double coarsest = detail > 0.0 ? detail : kCoarsest;
    const bool holes = hasHoles(unit), sided = !deep.empty();
    double finest = detail > 0.0 ? detail : holes && !sided ? kFinestSoup : kFinest;
    const auto sizes = [&] { return detail > 0.0 ? SizeField({}, detail, kGrowth, 0.0) : sizesFor(samples, spacing, finest, coarsest); };
    SizeField field = sizes();
    if (detail == 0.0) {
        while (coarsest < kCoarsestDetail && kDensity * area / (coarsest * coarsest) > kMostVertices / 2) coarsest *= 1.15;
        while (finest < coarsest && expectedVertices(field, samples, area) > kMostVertices) {
            finest *= 1.15;
            field = sizes();
        }
    }
    // `outside`: a second ball, for places that are outside by winding number; null: none.
    const auto wrapped = [&](const SizeField* outside) -> Result<TriangleMesh> {
        const SizeField& fine = outside ? *outside : field;
        WrapSetting wanted;
        wanted.alpha = [&field](const Vec3& p) { return field.at(p); };
        if (outside) {
            wanted.alphaOutside = [outside](const Vec3& p) { return outside->at(p); };
            wanted.outside = [&winding](const Vec3& p) { return std::abs(winding.at(p)) < kOutside; };
        }
        wanted.coarsest = field.coarsest();
        wanted.offset = kOffset * fine.finest();
        // One that falls through a hole has two sides and is given up early.
        wanted.mostVertices = detail > 0.0 ? kMostAsked : 5000 + static_cast<std::size_t>(1.6 * expectedVertices(fine, samples, area));
        const Attempt wrapping("a wrap");
        if (!wrapping) return fail("no-volume", "A wrap of this mesh breaks down or comes to no end: repair it in a modelling program.");
        auto wrap = wrapTriangles(unit, wanted, progress);
        if (wrap) *wrap = withoutIslands(*wrap);
        return wrap;
    };
    // A ball that falls through a hole leaves a hollow body: a larger one does not.
    Result<TriangleMesh> wrap = fail("no-volume", "");
    if (detail == 0.0 && holes) {
        const SizeField chosen = field;
        const double first = coarsest;
        const auto fell = [&](const Result<TriangleMesh>& tried) { return tried ? hollow(*tried, deep) : tried.error().code == "too-large"; };
        // Where the surface says what is outside, a small ball rolls there and the large one over the holes: a hole in a limb closes no gap between limbs.
        const auto withBoth = [&] {
            if (!sided) return false;
            auto tried = wrapped(&chosen);
            if (!tried || hollow(*tried, deep)) return false;
            wrap = std::move(tried);
            return true;
        };
        field = SizeField({}, coarsest, kGrowth, 0.0);
        bool both = withBoth();
        if (!both) {
            for (;; coarsest = std::min(1.5 * coarsest, kCoarsestDetail)) {
                field = SizeField({}, coarsest, kGrowth, 0.0);
                wrap = wrapped(nullptr);
                if (!fell(wrap) || coarsest >= kCoarsestDetail) break;
            }
            if (!wrap) return tl::unexpected(wrap.error());
            both = coarsest != first && withBoth();
        }
        SizeField fitting = both ? chosen : field;
        // Else finer ones are tried, each from the last on, until one falls through.
        for (double floor = coarsest / 2.0; !both && coarsest == first && fitting.finest() > chosen.finest(); floor /= 2.0) {
            finest = std::max(floor, chosen.finest());
            field = sizes();
            auto fine = wrapped(nullptr);
            if (!fine && fine.error().code != "too-large") return tl::unexpected(fine.error());
            if (fell(fine)) break;
            wrap = std::move(fine);
            fitting = field;
        }
        field = fitting;
    } else {
        wrap = wrapped(nullptr);
    }
    if (!wrap) return tl::unexpected(wrap.error());
    progress.report("coarsen", 0.8);
    const TriangleMesh coarse = coarsened(*wrap, progress);
    const double offset = kOffset * field.finest();
    const double cubed = diagonal * diagonal * diagonal;
    WrappedSurface out;
    out.mesh = takenBack(coarse, offset, volume / cubed);
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    out.detail = field.finest();
    out.gaps = closedGaps(out.mesh, samples);
    out.mesh.vertices = ((out.mesh.vertices * diagonal).rowwise() + middle.transpose()).eval();
    for (Vec3& p : out.gaps.places) p = p * diagonal + middle;
    return out;
}

}  // namespace imomushi
