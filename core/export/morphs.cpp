// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/morphs.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/decompositions.h"

namespace imomushi {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Residuals below this part of the diagonal are rounding errors: no targets are fitted to them.
constexpr double kRounding = 2e-7;
// No more targets are fitted when the residual is below this part of the diagonal.
constexpr double kFitted = 1e-5;
// Frames that targets are fitted to; the others get the weights that suit them.
constexpr std::size_t kFitFrames = 96;

/// Largest and root mean square length of points.
void measure(const Eigen::Ref<const VectorXd>& points, double& largest, double& squares) {
    for (Eigen::Index i = 0; i < points.size(); i += 3) {
        const double s = points.segment<3>(i).squaredNorm();
        largest = std::max(largest, s);
        squares += s;
    }
}

std::vector<std::string> columnNames(const CharacterInput::Element& element, const std::vector<int>& loads) {
    static const char* const kNames[] = {"stretch x", "shear", "stretch y", "tilt x", "tilt y", "shift z", "shift x", "shift y", "twist"};
    static const char* const kLoads[] = {"force x", "force y", "force z", "pressure"};
    std::vector<std::string> names;
    if (!element.response) return names;
    const auto& response = *element.response;
    for (std::size_t f = 0; f < element.faces.size(); ++f)
        for (int c = 0; c < response.bases[f].columns(); ++c) {
            const FaceBasis& basis = response.bases[f];
            std::string what = basis.kind == BasisKind::Full  ? std::to_string(c)
                               : c < std::min(9, basis.plainColumns()) ? kNames[c]
                               : c < basis.plainColumns()     ? "depth " + std::to_string(c)
                                                              : "warp " + std::to_string(c - basis.plainColumns() + 1);
            names.push_back(element.faces[f].name + " " + what);
        }
    for (const int load : loads) names.emplace_back(kLoads[load]);
    return names;
}

class Builder {
public:
    Builder(Motion& motion, const ExportScene& scene, const ExportOptions& options, bool live, const Progress& progress)
        : motion_(motion), scene_(scene), options_(options), live_(live), progress_(progress) {
        for (std::size_t c = 0; c < motion.clips.size(); ++c) {
            first_.push_back(keys_);
            keys_ += motion.clips[c].times.size();
        }
        sample_ = motion.sample(kFitFrames);
    }

    Result<std::vector<ElementMorphs>> build(MorphErrors& errors) {
        const std::size_t count = scene_.character.elements.size();
        std::vector<Work> all(count);
        for (std::size_t e = 0; e < count; ++e) begin(e, all[e]);
        // Residuals of the columns at some frames; from them the fitted targets; then their weights at all frames.
        for (std::size_t s = 0; s < sample_.size(); ++s) {
            if (progress_.cancelled()) return fail(kCancelled, "The export was cancelled.");
            progress_.report("fit", 0.3 * static_cast<double>(s) / static_cast<double>(sample_.size()));
            show(sample_[s]);
            for (std::size_t e = 0; e < count; ++e) all[e].residuals.col(static_cast<Eigen::Index>(s)) = residual(e, all[e], sample_[s]);
        }
        for (std::size_t e = 0; e < count; ++e) {
            if (progress_.cancelled()) return fail(kCancelled, "The export was cancelled.");
            progress_.report("fit", 0.3 + 0.4 * static_cast<double>(e) / static_cast<double>(count));
            fit(all[e]);
        }
        if (std::any_of(all.begin(), all.end(), [](const Work& w) { return w.fitted.cols() > 0; })) {
            for (std::size_t c = 0; c < motion_.clips.size(); ++c)
                for (std::size_t f = 0; f < motion_.clips[c].times.size(); ++f) {
                    if (progress_.cancelled()) return fail(kCancelled, "The export was cancelled.");
                    progress_.report("fit", 0.7 + 0.2 * static_cast<double>(first_[c] + f) / static_cast<double>(keys_));
                    show({c, f});
                    for (std::size_t e = 0; e < count; ++e) {
                        Work& w = all[e];
                        if (w.fitted.cols() == 0) continue;
                        VectorXd left = residual(e, w, {c, f});
                        w.fittedWeights.col(static_cast<Eigen::Index>(first_[c] + f)).noalias() = w.fitted.transpose() * left;
                        left.noalias() -= w.fitted * w.fittedWeights.col(static_cast<Eigen::Index>(first_[c] + f));
                        measure(left, w.largest, w.squares);
                    }
                }
            for (std::size_t e = 0; e < count; ++e) {
                const Work& w = all[e];
                const double points = static_cast<double>(keys_) * std::max(1.0, static_cast<double>(w.fitted.rows()) / 3.0);
                const ExportError left{std::sqrt(w.largest) / motion_.diagonal, std::sqrt(w.squares / points) / motion_.diagonal};
                const auto worse = [&](ExportError& known) {
                    known.largest = std::max(known.largest, left.largest);
                    known.rms = std::max(known.rms, left.rms);
                };
                if (w.warped) worse(errors.warped);
                if (w.touched) worse(errors.touched);
                if (w.whole && !w.warped && !w.touched && left.largest > kRounding) worse(errors.followed);
            }
        }
        std::vector<ElementMorphs> out(count);
        std::vector<std::size_t> alone;
        for (std::size_t e = 0; e < count; ++e)
            if (motion_.seen[e].mesh < 0) alone.push_back(e);
        std::size_t done = 0;
        const auto finished = [&](std::span<const std::size_t> group) {
            if (progress_.cancelled()) return false;
            progress_.report("fit", 0.9 + 0.1 * static_cast<double>(done) / static_cast<double>(count));
            finish(group, all, out, errors);
            for (const std::size_t e : group) all[e] = {};
            done += group.size();
            return true;
        };
        for (const std::size_t& e : alone)
            if (!finished({&e, 1})) return fail(kCancelled, "The export was cancelled.");
        for (const auto& mesh : scene_.meshes) {
            const std::vector<std::size_t> group(mesh.elements.begin(), mesh.elements.end());
            if (!finished(group)) return fail(kCancelled, "The export was cancelled.");
        }
        return out;
    }

private:
    using Key = std::pair<std::size_t, std::size_t>;
    struct Work {
        Points rest;                        // as it is shown, m, from the middle
        Vec3 middle = Vec3::Zero();
        std::vector<std::int32_t> held;
        bool whole = false;                 // residuals are of all vertices, not of held ones alone
        bool touched = false, warped = false;
        MatrixXd columns;                   // 3 #V x #columns
        MatrixXd heldColumns;               // their rows of held vertices, where residuals are of these alone
        MatrixXd weights;                   // #columns x #keys
        MatrixXd residuals;                 // 3 #rows x #sample
        MatrixXd fitted, fittedWeights;     // 3 #rows x #fitted, orthonormal; #fitted x #keys
        double largest = 0.0, squares = 0.0;  // of what they leave over, m^2
    };

    /// What goes out of an element before it is scaled.
    struct Draft {
        MatrixXd targets, weights, matrix;  // 3 #V x #targets; #targets x #keys; #targets x #columns
        std::vector<std::string> names;
    };

    [[nodiscard]] const std::vector<double>& shape(const Key& key) const { return motion_.clips[key.first].shapes[key.second]; }
    void show(const Key& key) {
        motion_.character.show(shape(key).data());
        meshes_ = motion_.meshPositions();
    }
    [[nodiscard]] Eigen::Map<const VectorXd> weightsOf(std::size_t e, const Key& key) const {
        return {shape(key).data() + motion_.layout.element(e) + ShapeLayout::kFrame, motion_.layout.elements[e].weights};
    }

    void begin(std::size_t e, Work& w) {
        const auto& given = scene_.character.elements[e];
        const int index = static_cast<int>(e);
        const int mesh = motion_.seen[e].mesh;
        w.rest = motion_.seenAtRest(e);
        const Points& body = given.mesh->body.vertices;
        if (body.rows() > 0) w.middle = 0.5 * (body.colwise().minCoeff() + body.colwise().maxCoeff()).transpose();
        if (mesh < 0) w.held = motion_.character.heldVertices(index);
        const auto& layout = motion_.layout.elements[e];
        const auto loads = motion_.character.loadColumns(index);
        w.columns = MatrixXd::Zero(3 * w.rest.rows(), layout.weights);
        if (given.response && layout.weights > 0 && mesh >= 0) {
            w.columns = motion_.character.renderColumns(mesh, index);
        } else if (given.response && layout.weights > 0) {
            const auto& r = *given.response;
            for (std::size_t i = 0; i < r.freeVertices.size(); ++i) {
                const Eigen::Index to = 3 * r.freeVertices[i], from = 3 * static_cast<Eigen::Index>(i);
                w.columns.block(to, 0, 3, r.columns()) = r.response.middleRows<3>(from);
                for (std::size_t l = 0; l < loads.size(); ++l) w.columns.block<3, 1>(to, r.columns() + static_cast<Eigen::Index>(l)) = r.loads.block<3, 1>(from, loads[l]);
            }
            for (std::size_t f = 0; f < given.faces.size(); ++f)
                for (std::size_t i = 0; i < given.faces[f].vertices.size(); ++i) {
                    const auto& frame = given.faces[f].frame;
                    const std::int32_t v = given.faces[f].vertices[i];
                    w.columns.block(3 * v, r.firstColumn[f], 3, r.bases[f].columns()) =
                        frame.axes * r.bases[f].at(frame.toLocal(w.rest.row(v).transpose()), static_cast<int>(i));
                }
        }
        w.rest.rowwise() -= w.middle.transpose();
        w.weights.resize(layout.weights, static_cast<Eigen::Index>(keys_));
        for (std::size_t c = 0; c < motion_.clips.size(); ++c)
            for (std::size_t f = 0; f < motion_.clips[c].times.size(); ++f) {
                w.weights.col(static_cast<Eigen::Index>(first_[c] + f)) = weightsOf(e, {c, f});
                const Eigen::Map<const VectorXd> forces(weightsOf(e, {c, f}).data() + layout.weights, layout.forces);
                w.touched = w.touched || (forces.array() != 0.0).any();
            }
        w.warped = motion_.character.isWarped(index);
        w.whole = mesh >= 0 || w.touched || w.warped;
        if (!w.whole) {
            w.heldColumns.resize(3 * static_cast<Eigen::Index>(w.held.size()), w.columns.cols());
            for (std::size_t i = 0; i < w.held.size(); ++i) w.heldColumns.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = w.columns.middleRows<3>(3 * w.held[i]);
        }
        w.residuals.resize(3 * (w.whole ? w.rest.rows() : static_cast<Eigen::Index>(w.held.size())), static_cast<Eigen::Index>(sample_.size()));
    }

    /// Positions less columns times weights, in the axes of the element, of the shape that the character shows (that of `key`).
    [[nodiscard]] VectorXd residual(std::size_t e, const Work& w, const Key& key) const {
        const int index = static_cast<int>(e);
        const Eigen::Isometry3d frame = motion_.character.frame(index);
        const Points at = w.whole ? motion_.seenPositions(e, meshes_) : motion_.character.heldPositions(index);
        VectorXd out(3 * at.rows());
        const Vec3 shift = frame * w.middle;
        if (w.whole) {
            for (Eigen::Index v = 0; v < at.rows(); ++v)
                out.segment<3>(3 * v) = frame.linear().transpose() * (at.row(v).transpose() - shift) - w.rest.row(v).transpose();
            out.noalias() -= w.columns * weightsOf(e, key);
            // Morph targets of the file go out as they are; what the body turns and stretches of them beyond its frame is left.
            VectorXd added = VectorXd::Zero(out.size());
            motion_.addMorphs(e, shape(key).data(), added);
            out -= added;
        } else {
            for (Eigen::Index i = 0; i < at.rows(); ++i) {
                const std::int32_t v = w.held[static_cast<std::size_t>(i)];
                out.segment<3>(3 * i) = frame.linear().transpose() * (at.row(i).transpose() - shift) - w.rest.row(v).transpose();
            }
            out.noalias() -= w.heldColumns * weightsOf(e, key);
        }
        return out;
    }

    /// Fitted targets: left singular vectors of the residuals over the sample, until the residual is small.
    void fit(Work& w) const {
        ExportError left = errorOf(w.residuals);
        if (left.largest > kRounding) {
            const auto gram = eigenpairsOf(MatrixXd(w.residuals.transpose() * w.residuals));
            const double most = gram.values.tail<1>()[0];
            MatrixXd modes(w.residuals.rows(), std::min<Eigen::Index>(kMaxFitted, w.residuals.cols()));
            Eigen::Index count = 0;
            for (; count < modes.cols() && left.largest > (w.warped || w.touched ? kFitted : kRounding); ++count) {
                const Eigen::Index k = w.residuals.cols() - 1 - count;
                if (!(gram.values[k] > 1e-15 * most)) break;
                modes.col(count).noalias() = w.residuals * gram.vectors.col(k);
                modes.col(count).normalize();
                w.residuals -= modes.col(count) * (modes.col(count).transpose() * w.residuals);
                left = errorOf(w.residuals);
            }
            w.fitted = modes.leftCols(count);
            w.fittedWeights = MatrixXd::Zero(count, static_cast<Eigen::Index>(keys_));
        }
        w.residuals.resize(0, 0);
    }

    [[nodiscard]] ExportError errorOf(const MatrixXd& points) const {
        double largest = 0.0, squares = 0.0;
        for (Eigen::Index k = 0; k < points.cols(); ++k) measure(points.col(k), largest, squares);
        const double count = std::max(1.0, static_cast<double>(points.size()) / 3.0);
        return {std::sqrt(largest) / motion_.diagonal, std::sqrt(squares / count) / motion_.diagonal};
    }

    /// The elements of a group are under one mesh, or it is one element.
    void finish(std::span<const std::size_t> group, std::vector<Work>& all, std::vector<ElementMorphs>& out, MorphErrors& errors) const {
        std::vector<Draft> drafts;
        Eigen::Index columns = 0;
        for (const std::size_t e : group) columns += drafts.emplace_back(draftOf(e, all[e])).targets.cols();
        const Eigen::Index most = options_.targets > 0 ? options_.targets : group.size() > 1 ? kMaxOfMesh : kMaxTargets;
        if (columns > most) {
            reduce(most, drafts, errors);
            scale(group, drafts, all, out);
            for (const std::size_t e : group) out[e].shared = group.size() > 1;
            return;
        }
        for (std::size_t i = 0; i < group.size(); ++i) scale(group.subspan(i, 1), {&drafts[i], 1}, all, out);
    }

    [[nodiscard]] Draft draftOf(std::size_t e, Work& w) const {
        const Eigen::Index columns = w.columns.cols(), fitted = w.fitted.cols(), keys = static_cast<Eigen::Index>(keys_);
        Draft out{MatrixXd(w.columns.rows(), columns + fitted), MatrixXd(columns + fitted, keys), MatrixXd::Zero(columns + fitted, columns), {}};
        out.targets.leftCols(columns) = w.columns;
        w.columns.resize(0, 0);
        out.weights.topRows(columns) = w.weights;
        out.matrix.topLeftCorner(columns, columns).setIdentity();
        out.names = columnNames(scene_.character.elements[e], motion_.character.loadColumns(static_cast<int>(e)));
        if (fitted > 0) {
            out.weights.bottomRows(fitted) = w.fittedWeights;
            out.targets.rightCols(fitted).setZero();
            if (w.whole)
                out.targets.rightCols(fitted) = w.fitted;
            else
                for (std::size_t i = 0; i < w.held.size(); ++i)
                    out.targets.block(3 * w.held[i], columns, 3, fitted) = w.fitted.middleRows<3>(3 * static_cast<Eigen::Index>(i));
        }
        for (Eigen::Index i = 0; i < fitted; ++i) out.names.push_back("fitted " + std::to_string(i + 1));
        return out;
    }

    /// Scales targets so that weights stay within -1 ... 1, and drops those that move nothing. All elements of `group` have the same targets.
    void scale(std::span<const std::size_t> group, std::span<Draft> drafts, std::vector<Work>& all, std::vector<ElementMorphs>& out) const {
        const Eigen::Index targets = drafts[0].targets.cols(), keys = static_cast<Eigen::Index>(keys_);
        std::vector<Eigen::Index> used;
        VectorXd scale = VectorXd::Zero(targets), reach(targets);
        for (Eigen::Index c = 0; c < targets; ++c) {
            double largest = 0.0, squares = 0.0, driven = 0.0, size = 0.0;
            for (std::size_t i = 0; i < group.size(); ++i) {
                measure(drafts[i].targets.col(c), largest, squares);
                if (drafts[i].matrix.cols() > 0) driven = std::max(driven, drafts[i].matrix.row(c).cwiseAbs().maxCoeff());
                if (const Points& rest = all[group[i]].rest; rest.rows() > 0) size = std::max(size, 2.0 * rest.rowwise().norm().maxCoeff());
            }
            reach[c] = std::sqrt(largest);
            scale[c] = drafts[0].weights.row(c).cwiseAbs().maxCoeff();
            // Other poses of a live character may move a vertex by half the size of its element.
            if (live_ && reach[c] > 0.0 && driven > 0.0) scale[c] = std::max(scale[c], 0.5 * size / reach[c]);
            if (scale[c] * reach[c] > (live_ ? 0.0 : 1e-9 * motion_.diagonal)) used.push_back(c);
        }
        const auto count = static_cast<Eigen::Index>(used.size());
        for (std::size_t i = 0; i < group.size(); ++i) {
            ElementMorphs& to = out[group[i]];
            Draft& draft = drafts[i];
            to.targets.resize(draft.targets.rows(), count);
            to.matrix.resize(count, draft.matrix.cols());
            to.reach.resize(count);
            MatrixXd kept(count, keys);
            for (Eigen::Index k = 0; k < count; ++k) {
                const Eigen::Index c = used[static_cast<std::size_t>(k)];
                to.targets.col(k) = (scale[c] * draft.targets.col(c)).cast<float>();
                to.matrix.row(k) = draft.matrix.row(c) / scale[c];
                kept.row(k) = draft.weights.row(c) / scale[c];
                to.reach[k] = scale[c] * reach[c];
                to.names.push_back(draft.names[static_cast<std::size_t>(c)]);
            }
            draft = {};
            to.middle = all[group[i]].middle;
            to.rest = std::move(all[group[i]].rest);
            if (options_.split) splitSigns(to, kept);
            addTracks(group[i], kept, to);
        }
    }

    void addTracks(std::size_t e, const MatrixXd& weights, ElementMorphs& out) const {
        for (std::size_t c = 0; c < motion_.clips.size(); ++c) {
            const auto frames = static_cast<Eigen::Index>(motion_.clips[c].times.size());
            auto& track = out.tracks.emplace_back();
            track.times = motion_.clips[c].times;
            track.rotations.resize(4, frames);
            track.places.resize(3, frames);
            track.weights = weights.middleCols(static_cast<Eigen::Index>(first_[c]), frames);
            for (Eigen::Index f = 0; f < frames; ++f) {
                const double* numbers = shape({c, static_cast<std::size_t>(f)}).data() + motion_.layout.element(e);
                const Eigen::Map<const Eigen::Quaterniond> rotation(numbers);
                track.rotations.col(f) = rotation.coeffs();
                if (f > 0 && track.rotations.col(f).dot(track.rotations.col(f - 1)) < 0.0) track.rotations.col(f) *= -1.0;
                track.places.col(f) = rotation.toRotationMatrix() * out.middle + Eigen::Map<const Vec3>(numbers + 4);
            }
        }
    }

    /// The `most` combinations of the targets of all drafts that keep most of what the clips do, in the mean square of vertices.
    void reduce(Eigen::Index most, std::span<Draft> drafts, MorphErrors& errors) const {
        std::vector<Eigen::Index> first{0};
        Eigen::Index rows = 0, size = 0;
        for (const Draft& d : drafts) {
            first.push_back(first.back() + d.targets.cols());
            rows += d.targets.rows();
            size += d.targets.size();
        }
        const Eigen::Index all = first.back();
        // Targets of different elements move different vertices.
        MatrixXd products = MatrixXd::Zero(all, all), weights(all, static_cast<Eigen::Index>(keys_));
        for (std::size_t i = 0; i < drafts.size(); ++i) {
            const Eigen::Index count = drafts[i].targets.cols();
            products.block(first[i], first[i], count, count) = drafts[i].targets.transpose() * drafts[i].targets;
            weights.middleRows(first[i], count) = drafts[i].weights;
        }
        const auto metric = eigenpairsOf(products);
        const VectorXd root = metric.values.cwiseMax(0.0).cwiseSqrt();
        const double floor = 1e-9 * root.maxCoeff();
        const VectorXd inverse = root.unaryExpr([&](double r) { return r > floor ? 1.0 / r : 0.0; });
        const MatrixXd toEven = root.asDiagonal() * metric.vectors.transpose();
        const MatrixXd fromEven = metric.vectors * inverse.asDiagonal();
        const MatrixXd even = toEven * weights;
        MatrixXd spread = even * even.transpose();
        // A small multiple of the metric orders the directions in which the clips never move.
        const VectorXd unit = toEven.colwise().squaredNorm().transpose();
        spread += 1e-9 * std::max(spread.trace(), 1e-300) / std::max(unit.sum(), 1e-300) * (toEven * toEven.transpose());
        const auto principal = eigenpairsOf(spread);
        const Eigen::Index count = std::min(most, all);
        const MatrixXd axes = principal.vectors.rightCols(count).rowwise().reverse();
        const MatrixXd pick = fromEven * axes, weigh = axes.transpose() * toEven;

        const MatrixXd lost = weights - pick * (weigh * weights);
        double largest = 0.0, squares = 0.0;
        const auto keys = motion_.sample(Motion::affordable(size));
        for (const auto& key : keys)
            for (std::size_t i = 0; i < drafts.size(); ++i) {
                const VectorXd left = lost.col(static_cast<Eigen::Index>(first_[key.first] + key.second)).segment(first[i], drafts[i].targets.cols());
                measure(drafts[i].targets * left, largest, squares);
            }
        const double points = std::max(1.0, static_cast<double>(rows) / 3.0 * static_cast<double>(keys.size()));
        errors.dropped.largest = std::max(errors.dropped.largest, std::sqrt(largest) / motion_.diagonal);
        errors.dropped.rms = std::max(errors.dropped.rms, std::sqrt(squares / points) / motion_.diagonal);
        weights = (weigh * weights).eval();
        for (std::size_t i = 0; i < drafts.size(); ++i) {
            Draft& d = drafts[i];
            const Eigen::Index own = d.targets.cols();
            d.targets = (d.targets * pick.middleRows(first[i], own)).eval();
            d.matrix = (weigh.middleCols(first[i], own) * d.matrix).eval();
            d.weights = weights;
            d.names.clear();
            for (Eigen::Index k = 0; k < count; ++k) d.names.push_back("shape " + std::to_string(k + 1));
        }
    }

    static void splitSigns(ElementMorphs& out, MatrixXd& weights) {
        const Eigen::Index n = out.targets.cols();
        Eigen::MatrixXf targets(out.targets.rows(), 2 * n);
        MatrixXd both(2 * n, weights.cols()), matrix(2 * n, out.matrix.cols());
        VectorXd reach(2 * n);
        std::vector<std::string> names;
        for (Eigen::Index i = 0; i < n; ++i) {
            targets.col(2 * i) = out.targets.col(i);
            targets.col(2 * i + 1) = -out.targets.col(i);
            both.row(2 * i) = weights.row(i).cwiseMax(0.0);
            both.row(2 * i + 1) = (-weights.row(i)).cwiseMax(0.0);
            matrix.row(2 * i) = out.matrix.row(i);
            matrix.row(2 * i + 1) = -out.matrix.row(i);
            reach[2 * i] = reach[2 * i + 1] = out.reach[i];
            for (const char* sign : {" +", " -"}) names.push_back(out.names[static_cast<std::size_t>(i)] + sign);
        }
        out.targets = std::move(targets);
        out.matrix = std::move(matrix);
        out.reach = std::move(reach);
        out.names = std::move(names);
        weights = std::move(both);
    }

    Motion& motion_;
    const ExportScene& scene_;
    const ExportOptions& options_;
    bool live_;
    const Progress& progress_;
    std::vector<std::size_t> first_;  // key of each clip
    std::size_t keys_ = 0;
    std::vector<Key> sample_;
    std::vector<Points> meshes_;      // of the scene, as shown
};

}  // namespace

Result<std::vector<ElementMorphs>> buildMorphs(Motion& motion, const ExportScene& scene, const ExportOptions& options, bool live, MorphErrors& errors,
                                               const Progress& progress) {
    return Builder(motion, scene, options, live, progress).build(errors);
}

}  // namespace imomushi
