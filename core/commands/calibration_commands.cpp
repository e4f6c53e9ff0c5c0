// SPDX-License-Identifier: GPL-3.0-or-later
// Calibration of sources of live input: what they say while who performs stands as the character does.
#include <algorithm>

#include "core/commands/core_commands.h"
#include "core/commands/mapping_commands.h"
#include "core/document/command_support.h"
#include "core/document/input_mapping.h"
#include "core/document/kept_pose.h"
#include "core/document/source_calibration.h"
#include "core/live/calibrated_rows.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

std::string nameOf(const std::string& pose) { return pose.empty() ? "rest" : "\"" + pose + "\""; }

Json poseJson(const CalibratedRows::OfPose& pose) {
    Json line{{"pose", pose.pose.empty() ? Json() : Json(pose.pose)}, {"rows", pose.rows}};
    for (const auto& [kind, most] : {std::pair("degrees", pose.off.degrees), std::pair("mm", pose.off.mm), std::pair("percent", pose.off.percent)})
        if (most) line[kind] = *most;
    return line;
}

Json posesJson(const CalibratedRows& rows, const std::string& source) {
    Json list = Json::array();
    for (const CalibratedRows::OfPose& pose : rows.poses)
        if (pose.source == source) list.push_back(poseJson(pose));
    return list;
}

Result<void> checkMapped(const Document& document, const std::string& source) {
    if (document.mappings && std::ranges::any_of(*document.mappings, [&](const InputMapping& m) { return m.row.source == source; })) return {};
    return fail("source-not-mapped", "Nothing of the source \"" + source + "\" is mapped: map it by map-input or suggest-mappings first.");
}

Result<Json> calibrateSource(DocumentEdit& edit, const Json& arguments, const Progress&) {
    const std::string& source = text(arguments, "source");
    if (auto ok = checkMapped(edit.document, source); !ok) return tl::unexpected(ok.error());
    SourceCalibration::Pose pose;
    if (const Json* given = find(arguments, "pose")) {
        pose.name = given->get<std::string>();
        if (!keptPose(edit.document, pose.name)) return fail("no-such-pose", "There is no pose \"" + pose.name + "\": keep it by keep-pose first.");
    }
    IMOMUSHI_TRY(pose.said, saidFrom(arguments.at("values")));
    const SourceCalibration* known = calibrationOf(edit.document, source);
    SourceCalibration made = known ? *known : SourceCalibration();
    const std::string name = pose.name;
    made.put(std::move(pose));
    if (made.poses.size() > SourceCalibration::kMostPoses)
        return fail("too-many-calibrated", "The source \"" + source + "\" is calibrated in " + std::to_string(SourceCalibration::kMostPoses) + " poses already: clear one by clear-calibration first.");
    IMOMUSHI_TRY(const auto plan, edit.planned());
    setCalibration(edit.document, source, std::move(made));
    const CalibratedRows rows = calibratedRows(edit.document, *plan);
    const CalibratedRows::OfPose* of = rows.find(source, name);
    if (!of || of->rows == 0) return fail("nothing-measured", "None of these values belongs to a row of \"" + source + "\" that a pose could say something about: measure the channels that its rows name.");
    // Which of both is the wrong one nobody knows: that measured last is done again more easily.
    if (of->isAlike) return fail("measured-alike", "\"" + source + "\" says the same as in the pose " + nameOf(of->alike) + ", and the character stands otherwise there: take the pose " + nameOf(name) + " and measure again.");
    return Json{{"poses", posesJson(rows, source)}};
}

Result<Json> clearCalibration(DocumentEdit& edit, const Json& arguments, const Progress&) {
    const std::string& source = text(arguments, "source");
    const SourceCalibration* known = calibrationOf(edit.document, source);
    const auto missing = [&](const std::string& in) { return fail("not-calibrated", "The source \"" + source + "\" is not calibrated" + in + "; \"list\" shows those that are."); };
    if (!known) return missing("");
    SourceCalibration left;
    if (const Json* pose = find(arguments, "pose")) {
        left = *known;
        const std::string& name = pose->get_ref<const std::string&>();
        if (std::erase_if(left.poses, [&](const SourceCalibration::Pose& p) { return p.name == name; }) == 0) return missing(" in the pose " + nameOf(name));
    }
    const std::size_t cleared = known->poses.size() - left.poses.size(), poses = left.poses.size();
    setCalibration(edit.document, source, std::move(left));
    return Json{{"cleared", cleared}, {"poses", poses}};
}

}  // namespace

Json shownCalibrations(const Document& document) {
    Json list = Json::array();
    for (const std::string& source : calibratedSources(document)) {
        Json poses = Json::array();
        for (const SourceCalibration::Pose& pose : calibrationOf(document, source)->poses) poses.push_back({{"pose", pose.name.empty() ? Json() : Json(pose.name)}, {"channels", pose.said.size()}});
        list.push_back({{"source", source}, {"poses", std::move(poses)}});
    }
    return list;
}

void addCalibrationCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("calibrate-source",
                       "Calibrates a source of live input in a pose: when it says these values, the character is to be in that pose. From one pose turns and places are moved there, and who faces another way is turned; from two or three, turns get other axes and a gain, "
                       "places are scaled and turned about the vertical, and single numbers get a gain, with the least squares left. It counts for all rows of the source but triggers, those that toggle, cycles and effects, and goes with its last row. "
                       "\"poses\" in the answer: how far off each of them is at most, turns in degrees, places in mm, weights in percent of their range (\"pose\" null: rest).",
                       {{"source", Type::Text, true, "Who sends it, as its rows name it."},
                        {"pose", Type::Text, false, "The kept pose that who performs was in (rest). A source has up to three poses; the values of one that it has are replaced."},
                        {"values", Type::Object, true, "What it said then: {CHANNEL: [all its numbers], ...}."}},
                       calibrateSource);
    registry.addChange("clear-calibration", "Takes the calibration of a source away.",
                       {{"source", Type::Text, true, "Who sends it."}, {"pose", Type::Text, false, "In this kept pose alone, \"\" for rest (in all)."}}, clearCalibration);
}

}  // namespace imomushi
