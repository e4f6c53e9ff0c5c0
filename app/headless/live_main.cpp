// SPDX-License-Identifier: GPL-3.0-or-later
// The sub-commands "live" and "replay": their options as a script, which runs like any other.
#include <charconv>
#include <optional>
#include <sstream>

#include "app/headless/live_command.h"
#include "app/headless/runner.h"

namespace imomushi {

namespace {

constexpr const char* kLiveUsage =
    "Usage: imomushi live [OPTIONS] PROJECT.imomushi\n"
    "       imomushi replay [OPTIONS] RECORDING PROJECT.imomushi\n"
    "Performs a project by what devices and other programs say, without a display, until Ctrl+C; or does again what was recorded.\n"
    "  --osc [NAME=]PORT   listens to OSC; --vmc [NAME=]PORT to the VMC protocol; both as often as wanted\n"
    "  --pad [NAME=]DEVICE  hears a game controller, by its name or number; any: the first one\n"
    "  --midi [NAME=]DEVICE  the same of a MIDI device, by its name\n"
    "  --voice [NAME=]DEVICE  the same of a microphone, by its name\n"
    "                      (osc=9000, vmc=39539, pad=any and midi=any unless one is given)\n"
    "  --open              other machines may send, too\n"
    "  --seconds N         ends after this time\n"
    "  --record FILE       records what comes in, for replay\n"
    "  --send vmc=PORT     tells another program what is shown, by VMC or by OSC (osc=PORT); vmc=ADDRESS:PORT on another machine\n"
    "  --mappings FILE     adds the mappings of a file\n"
    "  --take NAME         records a take\n"
    "  --save FILE         saves the project afterwards, as FILE.imomushi\n"
    "The first nine are of live alone. Answers and exit status are those of \"imomushi run\", whose --help has the commands \"live\", \"replay\" and \"map-input\".\n";

constexpr int kOscPort = 9000, kVmcPort = 39539;

constexpr const char* kAnyDevice = "any";

Json deviceFrom(const std::string& protocol, const std::string& text) {
    const auto equals = text.find('=');
    const std::string name = equals == std::string::npos ? protocol : text.substr(0, equals), device = equals == std::string::npos ? text : text.substr(equals + 1);
    return {{"protocol", protocol}, {"name", name}, {"device", device == kAnyDevice ? "" : device}};
}

std::optional<int> portFrom(const std::string& text) {
    int number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    return read.ec == std::errc() && read.ptr == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::optional<Json> sourceFrom(const std::string& protocol, const std::string& text) {
    const auto equals = text.rfind('=');
    const std::string name = equals == std::string::npos ? protocol : text.substr(0, equals);
    const auto port = portFrom(equals == std::string::npos ? text : text.substr(equals + 1));
    if (!port || name.empty()) return std::nullopt;
    return Json{{"protocol", protocol}, {"port", *port}, {"name", name}};
}

std::optional<Json> receiverFrom(const std::string& text) {
    const auto equals = text.find('='), colon = text.rfind(':');
    if (equals == std::string::npos) return std::nullopt;
    const bool named = colon != std::string::npos && colon > equals;
    const auto port = portFrom(text.substr((named ? colon : equals) + 1));
    if (!port) return std::nullopt;
    Json made{{"protocol", text.substr(0, equals)}, {"port", *port}};
    if (named) made["host"] = text.substr(equals + 1, colon - equals - 1);
    return made;
}

}  // namespace

int liveMain(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& err) {
    const std::string& name = arguments.at(0);
    const bool isLive = name == "live";
    const auto refuse = [&](const std::string& why) {
        err << "imomushi " << name << ": " << why << "\n" << kLiveUsage;
        return 2;
    };
    Json perform{{"do", name}}, sources = Json::array();
    std::string mappings, take, save;
    std::vector<std::string> files;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        if (option == "--help" || option == "-h") {
            out << kLiveUsage;
            return 0;
        }
        if (isLive && option == "--open") {
            perform["open"] = true;
            continue;
        }
        if (option.size() < 2 || option[0] != '-') {
            files.push_back(option);
            continue;
        }
        const bool ofLive = option == "--osc" || option == "--vmc" || option == "--pad" || option == "--midi" || option == "--voice" || option == "--seconds" || option == "--record" || option == "--send";
        if (!(isLive && ofLive) && option != "--mappings" && option != "--take" && option != "--save") return refuse("there is no option " + option + ".");
        if (++i == arguments.size() || arguments[i].empty()) return refuse(option + " needs a value.");
        const std::string& value = arguments[i];
        if (option == "--osc" || option == "--vmc") {
            const auto source = sourceFrom(option.substr(2), value);
            if (!source) return refuse(option + " needs a port, or NAME=PORT.");
            sources.push_back(*source);
        } else if (option == "--pad" || option == "--midi" || option == "--voice") {
            sources.push_back(deviceFrom(option.substr(2), value));
        } else if (option == "--seconds") {
            double seconds = 0.0;
            const auto read = std::from_chars(value.data(), value.data() + value.size(), seconds);
            if (read.ec != std::errc() || read.ptr != value.data() + value.size()) return refuse("--seconds needs a number.");
            perform["seconds"] = seconds;
        } else if (option == "--send") {
            const auto receiver = receiverFrom(value);
            if (!receiver) return refuse("--send needs vmc=PORT, or vmc=ADDRESS:PORT.");
            perform["send"].push_back(*receiver);
        } else if (option == "--record") {
            perform["record"] = value;
        } else {
            (option == "--mappings" ? mappings : option == "--take" ? take : save) = value;
        }
    }
    if (files.size() != (isLive ? 1u : 2u)) return refuse(isLive ? "name one project." : "name a recording and a project.");
    if (isLive) {
        if (sources.empty()) sources = {*sourceFrom("osc", std::to_string(kOscPort)), *sourceFrom("vmc", std::to_string(kVmcPort)), deviceFrom("pad", kAnyDevice), deviceFrom("midi", kAnyDevice)};
        perform["sources"] = sources;
    } else {
        perform["path"] = files[0];
    }
    std::vector<Json> script;
    script.push_back({{"do", "open"}, {"path", files.back()}});
    if (!mappings.empty()) script.push_back({{"do", "load-mappings"}, {"path", mappings}});
    if (!take.empty()) script.push_back({{"do", "record"}, {"take", take}, {"action", "start"}});
    script.push_back(perform);
    if (!take.empty()) script.push_back({{"do", "record"}, {"take", take}, {"action", "stop"}});
    if (!save.empty()) script.push_back({{"do", "save"}, {"path", save}});
    std::stringstream lines;
    for (const Json& line : script) lines << line.dump(-1, ' ', false, Json::error_handler_t::replace) << "\n";
    return runMain({"-"}, lines, out, err);
}

}  // namespace imomushi
