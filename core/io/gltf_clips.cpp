// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/gltf_clips.h"

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/finite.h"
#include "core/io/reader_support.h"

namespace imomushi {

namespace {

using Json = GltfFileReader::Json;
using Path = RigTrack::Path;
using Interpolation = RigTrack::Interpolation;

/// The keys of a channel, of as many numbers each.
struct Keys {
    Interpolation interpolation = Interpolation::Linear;
    std::vector<double> times, values;
};

/// Keys at one time: the last one counts, as a player that looks for the next key sees it.
void dropRepeatedTimes(Keys& keys) {
    const std::size_t stride = keys.values.size() / keys.times.size();
    std::size_t kept = 0;
    for (std::size_t k = 0; k < keys.times.size(); ++k) {
        if (k + 1 < keys.times.size() && keys.times[k + 1] == keys.times[k]) continue;
        keys.times[kept] = keys.times[k];
        std::copy_n(keys.values.begin() + static_cast<std::ptrdiff_t>(k * stride), stride, keys.values.begin() + static_cast<std::ptrdiff_t>(kept * stride));
        ++kept;
    }
    keys.times.resize(kept);
    keys.values.resize(kept * stride);
}

/// `width`: of what the file calls a value, `perValue`: how many of these a key has.
Keys readKeys(GltfFileReader& file, const Json& samplers, const Json& channel, std::size_t width, std::size_t perValue) {
    const Json& sampler = samplers[file.index(GltfFileReader::member(channel, "sampler"), samplers.size(), "sampler")];
    const std::string how = GltfFileReader::text(GltfFileReader::member(sampler, "interpolation"));
    Keys keys;
    keys.interpolation = how == "STEP" ? Interpolation::Step : how == "CUBICSPLINE" ? Interpolation::Cubic : Interpolation::Linear;
    auto times = file.accessor(GltfFileReader::member(sampler, "input"), "times of an animation");
    auto values = file.accessor(GltfFileReader::member(sampler, "output"), "keys of an animation");
    const std::size_t perKey = perValue * (keys.interpolation == Interpolation::Cubic ? 3 : 1);
    if (times.width != 1 || values.width != width || times.count == 0 || values.count != perKey * times.count) file.refuse("has an animation with a wrong number of keys.");
    if (!allFinite(times.at) || !allFinite(values.at)) file.refuse("has an animation with a number that is not finite.");
    keys.times = std::move(times.at);
    keys.values = std::move(values.at);
    dropRepeatedTimes(keys);
    return keys;
}

/// All weights of a mesh are in one channel, or `one` of them is. A target that other meshes have too is weighed by the first.
void addWeights(GltfFileReader& file, const Json& samplers, const Json& channel, const std::vector<std::string>& all, std::optional<std::size_t> one, RigClip& clip) {
    if (one && *one >= all.size()) file.refuse("has an animation of a morph target that does not exist.");
    const std::vector<std::string> targets = one ? std::vector{all[*one]} : all;
    const Keys keys = readKeys(file, samplers, channel, 1, targets.size());
    const std::size_t perKey = keys.interpolation == Interpolation::Cubic ? 3 : 1;
    for (std::size_t t = 0; t < targets.size(); ++t) {
        if (targets[t].empty() || std::any_of(clip.morphs.begin(), clip.morphs.end(), [&](const MorphTrack& known) { return known.target == targets[t]; })) continue;
        MorphTrack& track = clip.morphs.emplace_back();
        track.target = targets[t];
        track.interpolation = keys.interpolation;
        track.times = keys.times;
        for (std::size_t k = 0; k < perKey * keys.times.size(); ++k) track.weights.push_back(keys.values[k * targets.size() + t]);
    }
}

/// What a channel moves.
struct Aim {
    std::vector<std::size_t> nodes;   ///< none: nothing that is known here
    std::string path;                 ///< "translation", "rotation", "scale", "weights"
    std::optional<std::size_t> one;   ///< weight of that target alone
};

/// The parts of "/nodes/3/weights".
std::vector<std::string> partsOf(const std::string& pointer) {
    std::vector<std::string> parts;
    std::istringstream in(pointer);
    for (std::string part; parts.size() < 8 && std::getline(in, part, '/');) parts.push_back(part);
    return parts;
}

std::optional<std::size_t> wholeNumber(const std::string& text) {
    if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    return static_cast<std::size_t>(std::stoul(text));
}

/// A channel aims at a node, or by KHR_animation_pointer at any number of the file.
Aim aimOf(const GltfFileReader& file, const Json& target, std::size_t nodes) {
    Aim aim{{}, GltfFileReader::text(GltfFileReader::member(target, "path")), {}};
    if (aim.path != "pointer") {
        if (const Json& node = GltfFileReader::member(target, "node"); !node.is_null()) aim.nodes = {file.index(node, nodes, "node")};
        return aim;
    }
    const auto parts = partsOf(GltfFileReader::text(GltfFileReader::member(GltfFileReader::member(GltfFileReader::member(target, "extensions"), "KHR_animation_pointer"), "pointer")));
    if (parts.size() < 4 || parts.size() > 5 || !parts[0].empty()) return aim;
    const auto index = wholeNumber(parts[2]);
    const bool weights = parts[3] == "weights";
    if (!index || (parts.size() == 5 && !weights)) return aim;
    if (parts.size() == 5 && !(aim.one = wholeNumber(parts[4]))) return aim;
    if (parts[1] == "nodes") {
        if (*index >= nodes) file.refuse("has an animation of node " + parts[2] + ", and there are " + std::to_string(nodes) + " (counted from 0).");
        aim.nodes = {*index};
    } else if (parts[1] == "meshes" && weights) {
        for (std::size_t n = 0; n < nodes; ++n)
            if (const Json& mesh = GltfFileReader::member(file.list("nodes")[n], "mesh"); !mesh.is_null() && file.number(mesh, "mesh") == *index) aim.nodes.push_back(n);
    }
    aim.path = parts[3];
    return aim;
}

}  // namespace

void readGltfClips(GltfFileReader& file, const std::vector<int>& rigNode, const std::map<std::size_t, std::vector<std::string>>& morphs, RigBuilder& rig, RawScene& scene) {
    static const std::map<std::string, Path> kPaths = {{"translation", Path::Translation}, {"rotation", Path::Rotation}, {"scale", Path::Scale}};
    std::size_t leftOut = 0;
    for (const Json& from : file.list("animations")) {
        RigClip clip;
        clip.name = cleanName(GltfFileReader::text(GltfFileReader::member(from, "name")), "clip");
        try {
            const Json& samplers = file.array(GltfFileReader::member(from, "samplers"));
            for (const Json& channel : file.array(GltfFileReader::member(from, "channels"))) {
                const Json& target = GltfFileReader::member(channel, "target");
                const Aim aim = aimOf(file, target, rigNode.size());
                const auto path = kPaths.find(aim.path);
                if (aim.nodes.empty() || (path == kPaths.end() && aim.path != "weights")) {  // what other extensions move
                    leftOut += GltfFileReader::text(GltfFileReader::member(target, "path")) == "pointer";
                    continue;
                }
                for (const std::size_t at : aim.nodes) {
                    if (path == kPaths.end()) {
                        if (const auto weighed = morphs.find(at); weighed != morphs.end()) addWeights(file, samplers, channel, weighed->second, aim.one, clip);
                        continue;
                    }
                    const int node = rigNode[at];
                    if (node < 0) continue;
                    Keys keys = readKeys(file, samplers, channel, path->second == Path::Rotation ? 4 : 3, 1);
                    clip.tracks.push_back({node, path->second, keys.interpolation, std::move(keys.times), std::move(keys.values)});
                }
            }
        } catch (const GltfFileReader::Refused& refused) {
            tell(scene, Severity::Warning, "clip", "The animation '" + clip.name + "' is damaged and was left out: " + refused.error.message, 1);
            continue;
        }
        rig.addClip(std::move(clip));
    }
    if (leftOut > 0) tell(scene, Severity::Info, "clip-pointers", "Clips also move lights, cameras or materials, which was left out.", leftOut, false);
}

}  // namespace imomushi
