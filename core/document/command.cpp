// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/command.h"

#include <algorithm>
#include <cmath>

#include "core/document/command_support.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

bool isInteger(const Json& value) {
    if (value.is_number_unsigned()) return value.get<std::uint64_t>() <= static_cast<std::uint64_t>(kLargestInteger);
    if (value.is_number_integer()) {
        const auto number = value.get<std::int64_t>();
        return -kLargestInteger <= number && number <= kLargestInteger;
    }
    if (!value.is_number_float()) return false;
    const double number = value.get<double>();
    return std::abs(number) <= static_cast<double>(kLargestInteger) && number == std::floor(number);
}

bool hasType(const Json& value, CommandKey::Type type) {
    switch (type) {
        case CommandKey::Type::Text: return value.is_string() && isUtf8(value.get_ref<const std::string&>());
        case CommandKey::Type::Number: return value.is_number();
        case CommandKey::Type::Integer: return isInteger(value);
        case CommandKey::Type::Boolean: return value.is_boolean();
        case CommandKey::Type::Vector3: return vector3(value).has_value();
        case CommandKey::Type::Object: return value.is_object();
        case CommandKey::Type::Array: return value.is_array();
        case CommandKey::Type::Any: return true;
    }
    return false;
}

}  // namespace

bool allFinite(const Json& value) {
    if (value.is_number_float()) return std::isfinite(value.get<double>());
    if (value.is_structured())
        return std::all_of(value.begin(), value.end(), [](const Json& part) { return allFinite(part); });
    return true;
}

std::string_view typeText(CommandKey::Type type) {
    switch (type) {
        case CommandKey::Type::Text: return "a text";
        case CommandKey::Type::Number: return "a number";
        case CommandKey::Type::Integer: return "a whole number";
        case CommandKey::Type::Boolean: return "true or false";
        case CommandKey::Type::Vector3: return "three numbers [x,y,z], each within 1e9";
        case CommandKey::Type::Object: return "an object";
        case CommandKey::Type::Array: return "an array";
        case CommandKey::Type::Any: return "any value";
    }
    return "";
}

void CommandRegistry::add(Command command) { commands_.push_back(std::move(command)); }

void CommandRegistry::addChange(std::string name, std::string help, std::vector<CommandKey> keys, decltype(Command::change) change, decltype(Command::pose) pose) {
    add({std::move(name), std::move(help), std::move(keys), std::move(change), std::move(pose), {}});
}

void CommandRegistry::addAction(std::string name, std::string help, std::vector<CommandKey> keys, decltype(Command::run) run) {
    add({std::move(name), std::move(help), std::move(keys), {}, {}, std::move(run)});
}

const Command* CommandRegistry::find(std::string_view name) const {
    const auto found = std::find_if(commands_.begin(), commands_.end(), [&](const Command& c) { return c.name == name; });
    return found == commands_.end() ? nullptr : &*found;
}

Result<void> checkArguments(const Command& command, const Json& arguments) {
    if (!allFinite(arguments)) return fail("not-finite", "A number is not finite: NaN and infinity are refused.");
    for (const auto& item : arguments.items()) {
        if (item.key() == "do") continue;
        const auto key = std::find_if(command.keys.begin(), command.keys.end(),
                                      [&](const CommandKey& k) { return k.name == item.key(); });
        if (key == command.keys.end()) {
            std::string known;
            for (const CommandKey& k : command.keys) known += (known.empty() ? "" : ", ") + k.name;
            return fail("unknown-key", "\"" + command.name + "\" has no key \"" + item.key() + "\"; it has " +
                                           (known.empty() ? std::string("none") : known) + ".");
        }
        if (!hasType(item.value(), key->type))
            return fail("bad-type", "\"" + item.key() + "\" of \"" + command.name + "\" must be " +
                                        std::string(typeText(key->type)) + ".");
    }
    for (const CommandKey& key : command.keys)
        if (key.required && !arguments.contains(key.name))
            return fail("missing-key", "\"" + command.name + "\" needs the key \"" + key.name + "\": " + key.help);
    return {};
}

}  // namespace imomushi
