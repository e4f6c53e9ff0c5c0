// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <optional>
#include <string>
#include <vector>

#include "core/live/input_driver.h"
#include "core/mesh/render_model.h"
#include "tests/document/workbench.h"

namespace imomushi {

inline constexpr double kStep = 1.0 / 60.0;
inline const std::vector<std::string> kOsc = {"osc"};

/// A chain with a handle, and a man who can smile.
struct Puppet : Workbench {
    Puppet() {
        buildChain();
        good({{"do", "handle"}, {"element", "B"}, {"name", "tip"}, {"point", {0.5, 0.0, 4.5}}, {"radius", 0.4}});
        session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) {
            auto file = characterFile(request, progress);
            for (const char* name : {"smile", "frown"}) {
                MorphTarget target;
                target.name = name;
                target.vertices = {0};
                target.deltas.setConstant(1, 3, 0.01);
                file->renderModel.morphs.push_back(target);
            }
            return file;
        };
        good({{"do", "import-character"}, {"path", "ball"}, {"name", "man"}});
        REQUIRE(session.builtCharacter());
    }
    InputDriver driver() { return InputDriver(session.document(), session.plan(), kOsc); }
    void map(const std::string& channel, const std::string& target, const Json& more = Json::object()) {
        Json line{{"do", "map-input"}, {"source", "face"}, {"channel", channel}, {"target", target}};
        line.update(more);
        good(line);
    }
};

/// The last input of a kind in so many steps.
inline std::optional<LiveInput> lastOf(InputDriver& driver, LiveInput::Kind kind, int steps = 30) {
    std::optional<LiveInput> last;
    for (int i = 0; i < steps; ++i)
        for (const LiveInput& input : driver.step(kStep))
            if (input.kind == kind) last = input;
    return last;
}

}  // namespace imomushi
