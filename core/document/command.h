// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace imomushi {

class DocumentEdit;
class LiveCharacter;
class SessionAccess;
using Json = nlohmann::ordered_json;

/// One key of a command, for checking and for `imomushi run --help`.
struct CommandKey {
    std::string name;
    /// What a value must be: checked before the command runs. NaN and infinity are never accepted.
    enum class Type { Text, Number, Integer, Boolean, Vector3, Object, Array, Any } type = Type::Text;
    bool required = false;
    std::string help;  ///< one English sentence, with unit and range
};

/// A thing an artist can do: the same for studio, scripts, recovery and tests. Either `change` or `run` does it. `arguments` are the whole object, already
/// checked against `keys`. The answer is what the command adds to {"line","do","ok"}.
struct Command {
    std::string name;  ///< value of "do"
    std::string help;
    std::vector<CommandKey> keys;
    /// Changes the document, and reaches nothing else. Becomes one undo step and a line of the script.
    std::function<Result<Json>(DocumentEdit&, const Json& arguments, const Progress&)> change = {};
    /// After `change`, where there is one: brings the live character to the pose that was asked for and completes the answer of `change`.
    std::function<Result<Json>(LiveCharacter&, const Json& arguments, Json answer)> pose = {};
    /// Asks, or acts on the live character, responses, history and files.
    std::function<Result<Json>(SessionAccess&, const Json& arguments, const Progress&)> run = {};

    [[nodiscard]] bool changesDocument() const { return static_cast<bool>(change); }
};

/// All commands that exist in this program, by name.
class CommandRegistry {
public:
    void add(Command command);
    void addChange(std::string name, std::string help, std::vector<CommandKey> keys, decltype(Command::change) change, decltype(Command::pose) pose = {});
    void addAction(std::string name, std::string help, std::vector<CommandKey> keys, decltype(Command::run) run);
    [[nodiscard]] const Command* find(std::string_view name) const;
    [[nodiscard]] const std::vector<Command>& all() const { return commands_; }

private:
    std::vector<Command> commands_;
};

/// No number in it is NaN or infinite.
bool allFinite(const Json& value);

/// Checks the shape of a command: unknown, missing and mistyped keys, numbers that are not finite.
/// Errors: "unknown-key", "missing-key", "bad-type", "not-finite".
Result<void> checkArguments(const Command& command, const Json& arguments);

}  // namespace imomushi
