// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/source_calibration.h"

#include <algorithm>
#include <utility>

#include "core/base/try.h"
#include "core/base/utf8.h"
#include "core/document/input_mapping.h"

namespace imomushi {

namespace {

/// Rows of the document's table, or none.
const InputMappings& rowsOf(const Document& document) {
    static const InputMappings kNone;
    return document.mappings ? *document.mappings : kNone;
}

}  // namespace

void SourceCalibration::put(Pose pose) {
    const auto same = std::ranges::find(poses, pose.name, &Pose::name);
    if (same == poses.end()) poses.push_back(std::move(pose));
    else *same = std::move(pose);
}

const SourceCalibration* calibrationOf(const Document& document, std::string_view source) {
    for (const InputMapping& mapping : rowsOf(document))
        if (mapping.row.source == source) return mapping.calibration.get();
    return nullptr;
}

std::vector<std::string> calibratedSources(const Document& document) {
    std::vector<std::string> made;
    for (const InputMapping& mapping : rowsOf(document))
        if (mapping.calibration && std::ranges::find(made, mapping.row.source) == made.end()) made.push_back(mapping.row.source);
    return made;
}

void setCalibration(Document& document, std::string_view source, SourceCalibration calibration) {
    const SourceCalibration* known = calibrationOf(document, source);
    if (known ? *known == calibration : calibration.poses.empty()) return;
    const auto shared = calibration.poses.empty() ? nullptr : std::make_shared<const SourceCalibration>(std::move(calibration));
    InputMappings rows = rowsOf(document);
    bool any = false;
    for (InputMapping& mapping : rows)
        if (mapping.row.source == source) {
            mapping.calibration = shared;
            any = true;
        }
    if (any) document.mappings = std::make_shared<const InputMappings>(std::move(rows));
}

void renamePoseInCalibrations(Document& document, std::string_view from, std::string_view to) {
    for (const std::string& source : calibratedSources(document)) {
        SourceCalibration changed = *calibrationOf(document, source);
        for (SourceCalibration::Pose& pose : changed.poses)
            if (pose.name == from) pose.name = to;
        setCalibration(document, source, std::move(changed));
    }
}

std::vector<std::string> dropPoseFromCalibrations(Document& document, std::string_view pose) {
    std::vector<std::string> had;
    for (const std::string& source : calibratedSources(document)) {
        SourceCalibration changed = *calibrationOf(document, source);
        if (std::erase_if(changed.poses, [&](const SourceCalibration::Pose& p) { return p.name == pose; }) == 0) continue;
        had.push_back(source);
        setCalibration(document, source, std::move(changed));
    }
    return had;
}

Result<std::map<std::string, std::vector<double>>> saidFrom(const Json& values) {
    if (!values.is_object()) return fail("bad-type", "\"values\" must be an object: {\"channel\": [numbers], ...}.");
    if (values.size() > SourceCalibration::kMostChannels) return fail("bad-value", "\"values\" are of at most " + std::to_string(SourceCalibration::kMostChannels) + " channels.");
    std::map<std::string, std::vector<double>> made;
    for (const auto& [channel, numbers] : values.items()) {
        if (channel.empty() || !InputName::fits(channel) || !isUtf8(channel)) return fail("bad-value", "A channel of \"values\" must have 1 to " + std::to_string(InputName::kLongest) + " bytes.");
        const Json list = numbers.is_number() ? Json::array({numbers}) : numbers;
        if (!list.is_array() || list.empty() || list.size() > InputValue::kMost) return fail("bad-type", "The channel \"" + channel + "\" must have 1 to " + std::to_string(InputValue::kMost) + " numbers.");
        std::vector<double>& said = made[channel];
        for (const Json& number : list) {
            if (!number.is_number()) return fail("bad-type", "The channel \"" + channel + "\" must have numbers alone.");
            said.push_back(number.get<double>());
            if (!InputValue::isSound(said.back())) return fail("bad-value", "A number of the channel \"" + channel + "\" is too large: nothing that is measured says it.");
        }
    }
    return made;
}

Json calibrationsJson(const Document& document) {
    Json list = Json::array();
    for (const std::string& source : calibratedSources(document)) {
        Json poses = Json::array();
        for (const SourceCalibration::Pose& pose : calibrationOf(document, source)->poses) {
            poses.push_back({{"name", pose.name}, {"values", Json::object()}});
            for (const auto& [channel, numbers] : pose.said) poses.back()["values"][channel] = numbers;
        }
        list.push_back({{"source", source}, {"poses", std::move(poses)}});
    }
    return list;
}

Result<void> readCalibrations(Document& document, const Json& list) {
    const auto broken = [] { return fail("bad-calibration", "A calibration is broken."); };
    if (!list.is_array()) return broken();
    for (const Json& line : list) {
        if (!line.is_object() || !line.contains("source") || !line["source"].is_string() || !line.contains("poses") || !line["poses"].is_array()) return broken();
        SourceCalibration made;
        for (const Json& pose : line["poses"]) {
            if (!pose.is_object() || !pose.contains("name") || !pose["name"].is_string() || !pose.contains("values")) return broken();
            auto said = saidFrom(pose["values"]);
            if (!said || said->empty()) return broken();
            made.poses.push_back({pose["name"].get<std::string>(), std::move(*said)});
        }
        std::vector<std::string> names;
        for (const SourceCalibration::Pose& pose : made.poses) names.push_back(pose.name);
        std::ranges::sort(names);
        if (made.poses.empty() || made.poses.size() > SourceCalibration::kMostPoses || std::ranges::adjacent_find(names) != names.end()) return broken();
        setCalibration(document, line["source"].get_ref<const std::string&>(), std::move(made));
    }
    return {};
}

}  // namespace imomushi
