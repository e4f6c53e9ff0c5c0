// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/humanoid.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "core/mesh/avatar.h"

namespace imomushi {

namespace {

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool isDigit(char c) { return c >= '0' && c <= '9'; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }

/// Words of a name, in lower case: "mixamorig:LeftUpLeg" is left, up, leg; "upperArm.L" is upper, arm, l; "Spine01" is spine, 1.
std::vector<std::string> wordsOf(std::string_view name) {
    if (const std::size_t colon = name.find_last_of(":|"); colon != std::string_view::npos && colon + 1 < name.size()) name.remove_prefix(colon + 1);
    std::vector<std::string> words;
    bool fresh = true;
    char before = ' ';
    for (std::size_t i = 0; i < name.size(); ++i) {
        const char c = name[i];
        if (!isLetter(c) && !isDigit(c) && static_cast<unsigned char>(c) < 128) {
            fresh = true;
            before = c;
            continue;
        }
        const bool up = c >= 'A' && c <= 'Z', wasUp = before >= 'A' && before <= 'Z';
        const bool begins = fresh || isDigit(c) != isDigit(before) || (up && !wasUp) || (up && wasUp && i + 1 < name.size() && name[i + 1] >= 'a' && name[i + 1] <= 'z');
        if (begins) words.emplace_back();
        words.back() += lower(c);
        fresh = false;
        before = c;
    }
    for (std::string& word : words)
        if (isDigit(word[0])) word.erase(0, std::min(word.find_first_not_of('0'), word.size() - 1));
    return words;
}

enum class Side { None, Left, Right };

/// The name without prefix and side, its words as one: "uparm", "spine1".
struct Plain {
    Side side = Side::None;
    std::string base;
};

Plain plainOf(std::string_view name) {
    static const std::array<std::string_view, 12> kPrefixes = {"mixamorig", "bip", "bip01", "j", "def", "org", "mch", "rig", "armature", "b", "bone", "jnt"};
    std::vector<std::string> words = wordsOf(name);
    Plain plain;
    // Rigs call all their bones after themselves.
    while (words.size() > 1 && std::find(kPrefixes.begin(), kPrefixes.end(), words.front()) != kPrefixes.end()) {
        words.erase(words.begin());
        if (words.size() > 1 && isDigit(words.front()[0])) words.erase(words.begin());  // Bip01
    }
    for (std::size_t i = 0; i < words.size();) {
        const std::string& w = words[i];
        const Side side = w == "left" || w == "l" ? Side::Left : w == "right" || w == "r" ? Side::Right : Side::None;
        if (side == Side::None && !(w == "c" && words.size() > 1)) {
            ++i;
            continue;
        }
        if (side != Side::None && plain.side == Side::None) plain.side = side;
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (const std::string& w : words) plain.base += w;
    // "leftarm" in one word.
    for (const auto& [word, side] : {std::pair<std::string_view, Side>{"left", Side::Left}, {"right", Side::Right}})
        if (plain.side == Side::None && plain.base.size() > word.size() && plain.base.compare(0, word.size(), word) == 0) {
            plain.side = side;
            plain.base.erase(0, word.size());
        }
    return plain;
}

const std::map<std::string, const char*, std::less<>>& centralRoles() {
    static const std::map<std::string, const char*, std::less<>> roles = {{"hips", "hips"}, {"hip", "hips"}, {"pelvis", "hips"}, {"chest", "chest"}, {"upperchest", "upperChest"}, {"neck", "neck"},
                                                                          {"neck1", "neck"}, {"head", "head"}, {"jaw", "jaw"}};
    return roles;
}

/// Behind "left" or "right".
const std::map<std::string, const char*, std::less<>>& sideRoles() {
    static const std::map<std::string, const char*, std::less<>> roles = {
        {"shoulder", "Shoulder"}, {"clavicle", "Shoulder"}, {"collar", "Shoulder"}, {"upperarm", "UpperArm"}, {"uparm", "UpperArm"}, {"arm", "UpperArm"}, {"forearm", "LowerArm"}, {"lowerarm", "LowerArm"},
        {"elbow", "LowerArm"}, {"hand", "Hand"}, {"wrist", "Hand"}, {"upleg", "UpperLeg"}, {"upperleg", "UpperLeg"}, {"thigh", "UpperLeg"}, {"lowerleg", "LowerLeg"}, {"calf", "LowerLeg"}, {"shin", "LowerLeg"},
        {"knee", "LowerLeg"}, {"leg", "LowerLeg"}, {"foot", "Foot"}, {"ankle", "Foot"}, {"toebase", "Toes"}, {"toe", "Toes"}, {"toes", "Toes"}, {"ball", "Toes"}, {"eye", "Eye"}};
    return roles;
}

/// "middle2", "handmiddle2", "middleintermediate", "littledistal": "MiddleIntermediate". Empty: no finger.
std::string fingerRole(std::string base) {
    if (base.rfind("hand", 0) == 0) base.erase(0, 4);
    if (base.rfind("finger", 0) == 0) base.erase(0, 6);
    for (const auto& [word, finger] : {std::pair{"thumb", "Thumb"}, {"index", "Index"}, {"middle", "Middle"}, {"ring", "Ring"}, {"pinky", "Little"}, {"little", "Little"}}) {
        const std::string_view w = word;
        if (base.compare(0, w.size(), w) != 0) continue;
        const std::string part = base.substr(w.size());
        const bool thumb = w == "thumb";
        if (part == "1" || part == "metacarpal" || (!thumb && part == "proximal")) return std::string(finger) + (thumb ? "Metacarpal" : part == "metacarpal" ? "" : "Proximal");
        if (part == "2" || part == "intermediate" || part == "proximal") return std::string(finger) + (thumb ? "Proximal" : "Intermediate");
        if (part == "3" || part == "distal") return std::string(finger) + "Distal";
    }
    return {};
}

}  // namespace

std::string plainBoneName(std::string_view name) {
    const Plain plain = plainOf(name);
    return (plain.side == Side::Left ? "left " : plain.side == Side::Right ? "right " : "") + plain.base;
}

std::vector<RigRole> humanRoles(const Rig& rig) {
    if (!rig.roles.empty()) return rig.roles;
    std::map<std::string, int> found;
    std::vector<int> spine;  // in the order of the hierarchy
    bool lowerLegs = false;
    for (const RigBone& bone : rig.bones) {
        const std::string base = plainOf(bone.name).base;
        lowerLegs = lowerLegs || base == "lowerleg" || base == "calf" || base == "shin" || base == "knee";
    }
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        const Plain plain = plainOf(rig.bones[b].name);
        std::string role;
        if (plain.side == Side::None) {
            if (plain.base.rfind("spine", 0) == 0 && plain.base.size() <= 6) spine.push_back(static_cast<int>(b));
            if (const auto known = centralRoles().find(plain.base); known != centralRoles().end()) role = known->second;
        } else {
            const std::string side = plain.side == Side::Left ? "left" : "right";
            if (const auto known = sideRoles().find(plain.base); known != sideRoles().end())
                role = side + (plain.base == "leg" && lowerLegs ? "UpperLeg" : known->second);
            else if (const std::string finger = fingerRole(plain.base); !finger.empty())
                role = side + finger;
        }
        if (humanRole(role)) found.try_emplace(role, static_cast<int>(b));  // the first one: parents come before children
    }
    // Spines are chains of any length: the first is the spine, the next the chest, the last the upper chest, unless bones have these names.
    const auto give = [&](const char* role, std::size_t at) {
        if (at < spine.size()) found.try_emplace(role, spine[at]);
    };
    give("spine", 0);
    if (!found.contains("chest")) {
        give("chest", 1);
        if (spine.size() > 2) give("upperChest", spine.size() - 1);
    }
    std::vector<RigRole> roles;
    for (const HumanRole& role : kHumanRoles)
        if (const auto bone = found.find(std::string(role.name)); bone != found.end()) roles.push_back({std::string(role.name), bone->second});
    return roles;
}

}  // namespace imomushi
