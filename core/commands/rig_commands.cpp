// SPDX-License-Identifier: GPL-3.0-or-later
// Skeletons of files, and takes of their clips.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/commands/core_commands.h"
#include "core/commands/import_request.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/rig_follower.h"
#include "core/mesh/retarget.h"
#include "core/session/document_edit.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

constexpr double kMostFramesPerSecond = 1000.0;
constexpr double kMostFrames = 100'000.0;  // of a take: half an hour at 60 per second

Result<Json> importSkeleton(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto character, characterOf(document, text(arguments, "character")));
    IMOMUSHI_TRY(auto request, importRequestFrom(document, arguments));
    request.bonesSuffice = true;
    IMOMUSHI_TRY(auto imported, edit.services.importCharacter(request, progress));
    if (!imported.rig || imported.rig->bones.empty()) return fail("no-skeleton", "\"" + request.path.string() + "\" holds no bones: choose a file with a skeleton.");
    // Weights are for the vertices of its own mesh.
    if (!imported.renderModel.sameVertices(*character->model)) imported.rig->weights = {};
    const auto rig = std::make_shared<const Rig>(std::move(*imported.rig));
    exchangePart(document.characters, character->id, [&](CharacterSource& c) { c.rig = rig; });
    Json answer = rigJson(rig.get());
    answer["weights"] = !rig->weights.empty();
    answer["metres_per_unit"] = imported.metresPerUnit;
    answer["turned_z_up"] = imported.zUpConverted;
    answer["issues"] = Json::array();
    for (const MeshIssue& issue : imported.issues) answer["issues"].push_back(issueJson(issue));
    return answer;
}

/// The clips of another file for the skeleton of a character.
Result<Json> importClips(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto character, characterOf(document, text(arguments, "character")));
    if (!character->rig || character->rig->bones.empty())
        return fail("no-skeleton", "\"" + character->name + "\" has no skeleton that clips could move: import-skeleton brings one.");
    IMOMUSHI_TRY(auto request, importRequestFrom(document, arguments));
    request.bonesSuffice = true;
    IMOMUSHI_TRY(const auto imported, edit.services.importCharacter(request, progress.part(0.0, 0.6)));
    if (!imported.rig || imported.rig->clips.empty()) return fail("no-clip", "\"" + request.path.string() + "\" holds no animation: choose a file with one.");
    const Rig& source = *imported.rig;
    Rig rig = *character->rig;
    std::set<std::string> names;
    for (const RigClip& clip : rig.clips) names.insert(clip.name);
    Json clips = Json::array();
    const RigClip* few = nullptr;
    for (std::size_t c = 0; c < source.clips.size(); ++c) {
        if (progress.cancelled()) return fail(kCancelled, "The import was cancelled.");
        progress.report("clips", 0.6 + 0.4 * static_cast<double>(c) / static_cast<double>(source.clips.size()));
        RetargetedClip made = retarget(source, source.clips[c], rig);
        std::erase_if(made.clip.morphs, [&](const MorphTrack& track) { return character->model->morphIndex(track.target) < 0; });
        if (made.clip.tracks.empty() && made.clip.morphs.empty()) {
            few = &source.clips[c];
            continue;
        }
        std::string name = made.clip.name;
        for (int n = 2; !names.insert(name).second; ++n) name = made.clip.name + " " + std::to_string(n);
        made.clip.name = name;
        clips.push_back({{"name", name}, {"seconds", made.clip.seconds}, {"bones", made.followed.size()}, {"by_names", made.byNames}, {"feet", made.feet}, {"not_followed", made.lost}});
        rig.clips.push_back(std::move(made.clip));
    }
    if (clips.empty()) return fail("no-counterpart", "No bone of \"" + request.path.string() + "\" (clip \"" + few->name + "\") has a counterpart in \"" + character->name + "\", neither by its name nor as one of a human.");
    // With another clip there may be too many keys for a project.
    if (const std::string fault = checkRig(rig, static_cast<std::size_t>(character->model->mesh.body.vertices.rows())); !fault.empty())
        return fail("too-large", "The clips do not fit beside those that \"" + character->name + "\" has: " + fault + ".");
    const auto kept = std::make_shared<const Rig>(std::move(rig));
    exchangePart(document.characters, character->id, [&](CharacterSource& c) { c.rig = kept; });
    Json answer{{"clips", std::move(clips)}, {"issues", Json::array()}};
    for (const MeshIssue& issue : imported.issues) answer["issues"].push_back(issueJson(issue));
    return answer;
}

Result<Json> takeClip(SessionAccess& access, const Json& arguments, const Progress& progress) {
    const Document& document = access.document();
    if (access.live.recording()) return fail("already-recording", "The take \"" + access.live.recording()->take.name + "\" is being recorded: stop that first.");
    IMOMUSHI_TRY(const auto character, characterOf(document, text(arguments, "character")));
    const std::shared_ptr<const Rig> rig = character->rig;
    if (!rig || rig->clips.empty()) return fail("no-clip", "\"" + character->name + "\" has no clips: import a file with animations.");
    const std::string& clipName = text(arguments, "clip");
    const int index = rig->clipIndex(clipName);
    if (index < 0) {
        std::string known;
        for (const RigClip& clip : rig->clips) known += (known.empty() ? "\"" : ", \"") + clip.name + "\"";
        return fail("no-clip", "\"" + character->name + "\" has no clip \"" + clipName + "\"; it has " + known + ".");
    }
    const RigClip& clip = rig->clips[static_cast<std::size_t>(index)];
    const Json* given = find(arguments, "take");
    const std::string name = given ? given->get<std::string>() : clip.name;
    if (auto ok = checkNameText(name); !ok) return tl::unexpected(ok.error());
    if (document.takeNamed(name)) return fail("name-taken", "There is a take \"" + name + "\" already: choose another name, or remove that one first.");
    double fps = 60.0;
    if (auto ok = readNumber(arguments, "fps", 1.0, kMostFramesPerSecond, fps); !ok) return tl::unexpected(ok.error());
    const double frames = std::floor(clip.seconds * fps + 1e-6);
    if (frames > kMostFrames) return fail("bad-value", "The clip would be a take of more than 100,000 frames: choose fewer per second.");
    std::vector<double> times;
    for (int f = 0; f <= static_cast<int>(frames); ++f) times.push_back(f / fps);
    // The last key counts, wherever it is between frames.
    if (clip.seconds - times.back() > 1e-3 / fps) times.push_back(clip.seconds);

    if (auto alive = access.live.built(); !alive) return tl::unexpected(alive.error());
    const RigFollower follower(document, access.live.plan(), *character);
    const auto following = std::count_if(follower.follows().begin(), follower.follows().end(), [](int bone) { return bone >= 0; });
    // By their names, as the clip may have come with another file.
    std::vector<std::pair<MorphRef, const MorphTrack*>> weighed;
    for (const MorphTrack& track : clip.morphs)
        if (const int target = character->model->morphIndex(track.target); target >= 0) weighed.push_back({{character->id, target}, &track});
    if (following == 0 && weighed.empty()) return fail("no-bone", "\"" + character->name + "\" has no bones that a clip could move: add bones to it, or make it soft.");
    const auto frameAt = [&](double time) {
        LiveCharacter::PlayedFrame frame{follower.pose(clip, time), {}};
        for (const auto& [ref, track] : weighed) frame.morphs.emplace_back(ref, weightAt(*track, time));
        return frame;
    };
    IMOMUSHI_TRY(auto taken, access.live.playThrough(name, times, frameAt, progress));
    // The answer is made first: nothing may fail once the step is done.
    Json answer{{"take", taken.name},
                {"frames", taken.times.size()},
                {"seconds", taken.duration()},
                {"bytes", taken.bytes()},
                {"bones", following},
                {"morphs", weighed.size()},
                {"exact_joints", follower.exactPoints()},
                {"carried_joints", follower.carriedPoints()}};
    access.addTake(std::move(taken), arguments);
    return answer;
}

}  // namespace

Json rigJson(const Rig* rig) {
    Json bones = Json::array(), clips = Json::array();
    if (rig) {
        for (std::size_t b = 0; b < rig->bones.size(); ++b) {
            const RigBone& bone = rig->bones[b];
            bones.push_back({{"name", bone.name}, {"parent", bone.parent < 0 ? Json() : Json(rig->bones[static_cast<std::size_t>(bone.parent)].name)}, {"start", json(bone.head)}, {"end", json(bone.tail)}});
            for (const RigRole& role : rig->roles)
                if (role.bone == static_cast<std::int32_t>(b)) bones.back()["role"] = role.role;
        }
        for (const RigClip& clip : rig->clips) clips.push_back({{"name", clip.name}, {"seconds", clip.seconds}});
    }
    return Json{{"skeleton", std::move(bones)}, {"clips", std::move(clips)}};
}

void addRigCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("import-skeleton",
                       "Brings the bones and animation clips of a file (glTF, GLB, VRM, FBX, DAE), with or without a mesh, to a character, in place of those that it has. Nothing moves yet: propose "
                       "and make-soft make bones of them.",
                       {{"character", Type::Text, true, "The character."},
                        {"path", Type::Text, true, "The file."},
                        {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                        {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."}},
                       importSkeleton);
    registry.addChange("import-clips",
                       "Brings the animation clips of another file (glTF, GLB, VRM, FBX, DAE), of bones alone or with a mesh, to the skeleton of a character: bones follow those of the same name, else those "
                       "that are the same of a human, from one rest pose to the other. Planted feet stay. take-clip makes takes of them.",
                       {{"character", Type::Text, true, "The character."},
                        {"path", Type::Text, true, "The file."},
                        {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                        {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."}},
                       importClips);
    registry.addAction("take-clip",
                       "Makes a take of an animation clip that came with a character: its bones move as those of the file do, exactly where they start at a joint of the file, and "
                       "its morph targets have the clip's weights. Effects of the flesh have their part in it, bone dynamics have none. One step of the history.",
                       {{"character", Type::Text, true, "The character."},
                        {"clip", Type::Text, true, "One of its clips, as import-character and list answer them."},
                        {"take", Type::Text, false, "A name that no other take has (the clip's unless given)."},
                        {"fps", Type::Number, false, "Frames per second, 1 to 1000 (60)."}},
                       takeClip);
}

}  // namespace imomushi
