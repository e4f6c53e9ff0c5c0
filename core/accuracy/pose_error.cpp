// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/pose_error.h"
#include "core/base/try.h"

#include <chrono>

namespace imomushi {

Result<PoseErrors> FullSolutionKeeper::measure(const PoseErrorInput& input, const Progress& progress) {
    const std::scoped_lock working(work_);
    if (auto ok = solve(input.reference, progress.part(0.0, 0.97)); !ok) return tl::unexpected(ok.error());
    const auto start = std::chrono::steady_clock::now();
    IMOMUSHI_TRY(auto reference, solution_->in(input.reference.poses, progress.part(0.97, 1.0)));
    IMOMUSHI_TRY(auto character, Character::build(input.shown));
    character.update(input.reference.poses.front().pose);
    PoseErrors out;
    out.reference = std::move(reference);
    out.error = errorOf(character, out.reference, 0).error();
    out.field = errorField(character, out.reference, 0);
    for (std::size_t e = 0; e < input.shown.elements.size(); ++e) out.shown.push_back(character.positions(static_cast<int>(e)));
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    out.bytes = solution_->bytes();
    return out;
}

Result<Reference> FullSolutionKeeper::reference(const ReferenceInput& input, std::size_t bytes, const Progress& progress) {
    const std::scoped_lock working(work_);
    if (auto ok = solve(input, progress.part(0.0, 0.95)); !ok) return tl::unexpected(ok.error());
    auto out = solution_->in(input.poses, progress.part(0.95, 1.0));
    if (solution_->bytes() > bytes) {
        name({});
        solution_.reset();
    }
    return out;
}

bool FullSolutionKeeper::knows(const ContentKey& reference) const {
    const std::scoped_lock lock(mutex_);
    return key_ == reference && reference != ContentKey{};
}

// Limits of time may ask for another mesh than the one that is kept.
Result<void> FullSolutionKeeper::solve(const ReferenceInput& input, const Progress& progress) {
    if (progress.cancelled()) return fail(kCancelled, "The full solution was cancelled.");
    const ContentKey key = referenceKey(input);
    if (knows(key)) {
        const auto mesh = referenceMesh(input);
        if (mesh && referenceRank(solverMeshName({*mesh, 0})) <= referenceRank(solution_->mesh())) return {};
    }
    name({});
    solution_.reset();
    IMOMUSHI_TRY(auto solved, FullSolution::build(input, progress));
    solution_.emplace(std::move(solved));
    name(key);
    return {};
}

void FullSolutionKeeper::name(const ContentKey& key) {
    const std::scoped_lock lock(mutex_);
    key_ = key;
}

}  // namespace imomushi
