// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/response_format.h"

namespace imomushi {

Result<ResponseFormat> responseFormat(const std::string& name) {
    for (const auto format : {ResponseFormat::Float, ResponseFormat::Half, ResponseFormat::Int16})
        if (formatName(format) == name) return format;
    return fail("bad-value", "The format \"" + name + "\" does not exist: choose \"float\", \"half\" or \"int16\".");
}

std::string formatName(ResponseFormat format) {
    switch (format) {
        case ResponseFormat::Half: return "half";
        case ResponseFormat::Int16: return "int16";
        default: return "float";
    }
}

}  // namespace imomushi
