// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the meshes and scripts of the samples: imomushi_sample_meshes FOLDER [NAME...]
#include <cstdio>
#include <exception>
#include <string>
#include <utility>

#include "character.h"

int main(int argc, char** argv) {
    using namespace imomushi::samples;
    if (argc < 2) {
        std::fprintf(stderr, "usage: imomushi_sample_meshes FOLDER [caterpillar] [octopus] [figure]\n");
        return 2;
    }
    try {
        const std::pair<const char*, CharacterSpec (*)()> samples[] = {{"caterpillar", caterpillar}, {"octopus", octopus}, {"figure", figure}};
        for (const auto& [name, build] : samples) {
            bool wanted = argc == 2;
            for (int i = 2; i < argc; ++i) wanted = wanted || std::string(argv[i]) == name;
            if (wanted) make(build(), argv[1]);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
