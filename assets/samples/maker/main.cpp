// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the meshes of the samples, and the scripts of those in parts: imomushi_sample_meshes FOLDER [NAME...]
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "character.h"
#include "rigged.h"

int main(int argc, char** argv) {
    using namespace imomushi::samples;
    if (argc < 2) {
        std::fprintf(stderr, "usage: imomushi_sample_meshes FOLDER [caterpillar] [octopus] [figure] [dragon]\n");
        return 2;
    }
    try {
        const std::filesystem::path folder = argv[1];
        const std::pair<const char*, std::function<void()>> samples[] = {{"caterpillar", [&] { make(caterpillar(), folder); }},
                                                                         {"octopus", [&] { make(octopus(), folder); }},
                                                                         {"figure", [&] { make(figure(), folder); }},
                                                                         {"dragon", [&] { makeDragon(folder); }}};
        for (const auto& [name, build] : samples) {
            bool wanted = argc == 2;
            for (int i = 2; i < argc; ++i) wanted = wanted || std::string(argv[i]) == name;
            if (wanted) build();
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
