// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/gltf_clips.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/finite.h"
#include "core/io/reader_support.h"

namespace imomushi {

namespace {

using Json = GltfFileReader::Json;
using Path = RigTrack::Path;
using Interpolation = RigTrack::Interpolation;

/// Keys at one time: the last one counts, as a player that looks for the next key sees it.
void dropRepeatedTimes(RigTrack& track) {
    const std::size_t stride = track.values.size() / track.times.size();
    std::size_t kept = 0;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
        if (k + 1 < track.times.size() && track.times[k + 1] == track.times[k]) continue;
        track.times[kept] = track.times[k];
        std::copy_n(track.values.begin() + static_cast<std::ptrdiff_t>(k * stride), stride, track.values.begin() + static_cast<std::ptrdiff_t>(kept * stride));
        ++kept;
    }
    track.times.resize(kept);
    track.values.resize(kept * stride);
}

RigTrack readTrack(GltfFileReader& file, const Json& samplers, const Json& channel, int node, Path path) {
    const Json& sampler = samplers[file.index(GltfFileReader::member(channel, "sampler"), samplers.size(), "sampler")];
    const std::string how = GltfFileReader::text(GltfFileReader::member(sampler, "interpolation"));
    RigTrack track;
    track.node = node;
    track.path = path;
    track.interpolation = how == "STEP" ? Interpolation::Step : how == "CUBICSPLINE" ? Interpolation::Cubic : Interpolation::Linear;
    auto times = file.accessor(GltfFileReader::member(sampler, "input"), "times of an animation");
    auto values = file.accessor(GltfFileReader::member(sampler, "output"), "keys of an animation");
    const std::size_t width = path == Path::Rotation ? 4 : 3, perKey = track.interpolation == Interpolation::Cubic ? 3 : 1;
    if (times.width != 1 || values.width != width || times.count == 0 || values.count != perKey * times.count) file.refuse("has an animation with a wrong number of keys.");
    if (!allFinite(times.at) || !allFinite(values.at)) file.refuse("has an animation with a number that is not finite.");
    track.times = std::move(times.at);
    track.values = std::move(values.at);
    dropRepeatedTimes(track);
    return track;
}

}  // namespace

void readGltfClips(GltfFileReader& file, const std::vector<int>& rigNode, RigBuilder& rig, RawScene& scene) {
    static const std::map<std::string, Path> kPaths = {{"translation", Path::Translation}, {"rotation", Path::Rotation}, {"scale", Path::Scale}};
    for (const Json& from : file.list("animations")) {
        RigClip clip;
        clip.name = cleanName(GltfFileReader::text(GltfFileReader::member(from, "name")), "clip");
        try {
            const Json& samplers = file.array(GltfFileReader::member(from, "samplers"));
            for (const Json& channel : file.array(GltfFileReader::member(from, "channels"))) {
                const Json& target = GltfFileReader::member(channel, "target");
                const auto path = kPaths.find(GltfFileReader::text(GltfFileReader::member(target, "path")));
                if (path == kPaths.end() || GltfFileReader::member(target, "node").is_null()) continue;  // morph targets, and what extensions move
                const int node = rigNode[file.index(GltfFileReader::member(target, "node"), rigNode.size(), "node")];
                if (node >= 0) clip.tracks.push_back(readTrack(file, samplers, channel, node, path->second));
            }
        } catch (const GltfFileReader::Refused& refused) {
            tell(scene, Severity::Warning, "clip", "The animation '" + clip.name + "' is damaged and was left out: " + refused.error.message, 1);
            continue;
        }
        rig.addClip(std::move(clip));
    }
}

}  // namespace imomushi
