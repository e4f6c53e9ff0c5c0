// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/document_change.h"

#include <algorithm>

namespace imomushi {

namespace {

/// Parts of `before` that are different or absent in `after`, and null for those that `after` alone has.
template <class Map>
Map partsThatDiffer(const Map& before, const Map& after) {
    Map parts;
    for (const auto& [id, part] : before) {
        const auto now = after.find(id);
        if (now == after.end() || now->second != part) parts.emplace(id, part);
    }
    for (const auto& [id, part] : after)
        if (!before.contains(id)) parts.emplace(id, nullptr);
    return parts;
}

template <class Map>
void exchangeParts(Map& document, Map& change) {
    for (auto& [id, part] : change) {
        const auto found = document.find(id);
        typename Map::mapped_type was = found == document.end() ? nullptr : found->second;
        if (part)
            document.insert_or_assign(id, part);
        else if (found != document.end())
            document.erase(found);
        part = std::move(was);
    }
}

/// The same of values, absent ones without a value.
template <class Key, class Value>
std::map<Key, std::optional<Value>> valuesThatDiffer(const std::map<Key, Value>& before, const std::map<Key, Value>& after) {
    std::map<Key, std::optional<Value>> values;
    for (const auto& [key, value] : before) {
        const auto now = after.find(key);
        if (now == after.end() || !(now->second == value)) values.emplace(key, value);
    }
    for (const auto& [key, value] : after)
        if (!before.contains(key)) values.emplace(key, std::nullopt);
    return values;
}

template <class Key, class Value>
void exchangeValues(std::map<Key, Value>& document, std::map<Key, std::optional<Value>>& change) {
    for (auto& [key, value] : change) {
        const auto found = document.find(key);
        std::optional<Value> was;
        if (found != document.end()) was = found->second;
        if (value)
            document.insert_or_assign(key, *value);
        else if (found != document.end())
            document.erase(found);
        value = was;
    }
}

bool samePose(const Pose& a, const Pose& b) {
    if (a.points != b.points || a.roll != b.roll || a.frames.size() != b.frames.size()) return false;
    for (std::size_t i = 0; i < a.frames.size(); ++i)
        if (a.frames[i].coeffs() != b.frames[i].coeffs()) return false;
    return true;
}

bool sameFaces(const std::vector<JointFace>& a, const std::vector<JointFace>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const JointFace& p, const JointFace& q) {
        return p.name == q.name && p.frame.origin == q.frame.origin;
    });
}

}  // namespace

bool DocumentChange::empty() const { return !structure() && !posing(); }
bool DocumentChange::structure() const { return unknown || !elements.empty() || !joints.empty() || !bones.empty() || !characters.empty() || !takes.empty() || settings || effects || mappings || poses || cycles; }
bool DocumentChange::posing() const { return !goals.empty() || !handleGoals.empty() || !turns.empty() || !morphs.empty() || touches || pose; }

DocumentChange difference(const Document& before, const Document& after) {
    DocumentChange change;
    change.elements = partsThatDiffer(before.elements, after.elements);
    change.joints = partsThatDiffer(before.joints, after.joints);
    change.bones = partsThatDiffer(before.bones, after.bones);
    change.characters = partsThatDiffer(before.characters, after.characters);
    change.takes = partsThatDiffer(before.takes, after.takes);
    change.goals = valuesThatDiffer(before.goals, after.goals);
    change.handleGoals = valuesThatDiffer(before.handleGoals, after.handleGoals);
    change.turns = valuesThatDiffer(before.turns, after.turns);
    change.morphs = valuesThatDiffer(before.morphs, after.morphs);
    if (!(before.settings == after.settings)) change.settings = before.settings;
    if (!(before.effects == after.effects)) change.effects = before.effects;
    if (!(before.touches == after.touches)) change.touches = before.touches;
    if (before.mappings != after.mappings) change.mappings = before.mappings;
    if (before.poses != after.poses) change.poses = before.poses;
    if (before.cycles != after.cycles) change.cycles = before.cycles;
    if (!samePose(before.pose, after.pose)) change.pose = before.pose;
    return change;
}

bool differInPoseAtMost(const Document& before, const Document& after) {
    DocumentChange change = difference(before, after);
    change.pose.reset();
    return change.empty() && after.nextId == before.nextId;
}

void exchange(Document& document, DocumentChange& change) {
    exchangeParts(document.elements, change.elements);
    exchangeParts(document.joints, change.joints);
    exchangeParts(document.bones, change.bones);
    exchangeParts(document.characters, change.characters);
    exchangeParts(document.takes, change.takes);
    exchangeValues(document.goals, change.goals);
    exchangeValues(document.handleGoals, change.handleGoals);
    exchangeValues(document.turns, change.turns);
    exchangeValues(document.morphs, change.morphs);
    if (change.settings) std::swap(document.settings, *change.settings);
    if (change.effects) std::swap(document.effects, *change.effects);
    if (change.touches) std::swap(document.touches, *change.touches);
    if (change.mappings) std::swap(document.mappings, *change.mappings);
    if (change.poses) std::swap(document.poses, *change.poses);
    if (change.cycles) std::swap(document.cycles, *change.cycles);
    if (change.pose) std::swap(document.pose, *change.pose);
}

bool movesJointPoints(const DocumentChange& change, const Document& after) {
    if (!change.bones.empty() || !change.joints.empty()) return true;
    return std::any_of(change.elements.begin(), change.elements.end(), [&](const auto& part) {
        const auto now = after.elements.find(part.first);
        if (!part.second || now == after.elements.end()) return true;
        return part.second->mesh != now->second->mesh || !sameFaces(part.second->faces, now->second->faces);
    });
}

}  // namespace imomushi
